#include "robocell/scenes/start_inspector.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <Eigen/Geometry>

#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/settle.h"

namespace robocell::internal {
namespace {

using Eigen::Vector3d;

constexpr int kMostLayers = 16;       // geoms without collision that a ray passes
constexpr double kNearEnough = 0.02;  // metres between what hangs and what may hold it
constexpr double kInTheFloor = 0.01;  // metres
constexpr double kAbove = 0.5e-3;     // metres above its support, from which an object drops
constexpr double kStep = 0.01;        // allowed unevenness under an object, metres
constexpr double kInset = 0.1;        // of an object's width, for most have rounded edges

std::string BodyText(const mjModel* m, int body) {
  return body == 0 ? "the world" : ElementName(m, mjOBJ_BODY, body);
}

// Returns a geom's name for the world, which has many: the floor; else its body's name.
std::string OtherText(const mjModel* m, int geom) {
  const int body = m->geom_bodyid[geom];
  const std::string name = ElementName(m, mjOBJ_GEOM, geom);
  return body == 0 && !name.empty() ? name : BodyText(m, body);
}

// Returns the object that a body is a part of; "" if it is none.
std::string ObjectWith(const Scene& scene, int body) {
  const mjModel* m = scene.model();
  for (const ObjectRecord& object : scene.compiled()->objects()) {
    const int root = FindId(m, mjOBJ_BODY, object.root_body);
    if (root > 0 && internal::IsInSubtree(m, body, root)) return object.name;
  }
  return "";
}

std::string Millimetres(double metres) { return fmt::format("{:.0f} mm", 1000 * metres); }

Vector3d Down(const mjModel* m) {
  const Vector3d gravity(m->opt.gravity);
  return gravity.norm() > 0 ? Vector3d(gravity.normalized()) : Vector3d(0, 0, 0);
}

// Returns the distance down from a point to the first geom that collides; -1 if there is none. Sets
// the geom.
double RayDown(const mjModel* m, const mjData* d, Vector3d from, const Vector3d& down, int without,
               int* geom) {
  double distance = 0;
  for (int layer = 0; layer < kMostLayers; ++layer) {
    const double hit = internal::Guarded("looking for what is below", [&] {
      return mj_ray(m, d, from.data(), down.data(), nullptr, 1, without, geom, nullptr);
    });
    if (hit < 0) return -1;
    distance += hit;
    if (internal::IsCollisionGeom(m, *geom) &&
        !internal::IsInSubtree(m, m->geom_bodyid[*geom], without))
      return distance;
    constexpr double kOn = 1e-4;  // m, past what was hit
    from += (hit + kOn) * down;
    distance += kOn;
  }
  return distance;
}

std::vector<int> CollidingGeoms(const mjModel* m, int root) {
  std::vector<int> geoms;
  for (int g = 0; g < m->ngeom; ++g) {
    if (internal::IsCollisionGeom(m, g) && internal::IsInSubtree(m, m->geom_bodyid[g], root))
      geoms.push_back(g);
  }
  return geoms;
}

int RootBody(const Scene& scene, const std::string& object) {
  return RequireId(scene.model(), mjOBJ_BODY, scene.compiled()->object(object).root_body,
                   "scene '" + scene.name() + "'");
}

// Returns less than `horizon` if something else is so near.
double NearestOther(const Scene& scene, int root, double horizon) {
  const mjModel* m = scene.model();
  mjData* d = scene.data();
  double nearest = horizon;
  for (int a = 0; a < m->ngeom; ++a) {
    if (!internal::IsInSubtree(m, m->geom_bodyid[a], root)) continue;
    for (int b = 0; b < m->ngeom && nearest == horizon; ++b) {
      if (internal::IsInSubtree(m, m->geom_bodyid[b], root)) continue;
      const bool bounded = m->geom_rbound[a] > 0 && m->geom_rbound[b] > 0;
      if (bounded && mju_dist3(d->geom_xpos + 3 * a, d->geom_xpos + 3 * b) >
                         m->geom_rbound[a] + m->geom_rbound[b] + horizon)
        continue;
      nearest = internal::Guarded("distance of an object to its surroundings", d,
                                  [&] { return mj_geomDistance(m, d, a, b, horizon, nullptr); });
    }
  }
  return nearest;
}

bool HasGeoms(const mjModel* m, int root) {
  for (int g = 0; g < m->ngeom; ++g) {
    if (internal::IsInSubtree(m, m->geom_bodyid[g], root)) return true;
  }
  return false;
}

}  // namespace

StartInspector::StartInspector(Scene scene, std::vector<std::string> objects)
    : scene_(std::move(scene)), names_(std::move(objects)) {
  Bind();
}

void StartInspector::Bind() {
  if (generation_ == scene_.generation()) return;
  const mjModel* m = scene_.model();
  objects_.clear();
  object_of_.assign(m->nbody, -1);
  for (const std::string& name : names_) {
    const int body = RootBody(scene_, name);
    for (int b = 0; b < m->nbody; ++b) {
      if (internal::IsInSubtree(m, b, body)) object_of_[b] = static_cast<int>(objects_.size());
    }
    objects_.push_back({name, body, CollidingGeoms(m, body), internal::kMostSettling});
  }
  MarkRobots();
  accepted_.clear();
  generation_ = scene_.generation();
}

// A gripper, and everything else that hangs on a robot, belongs to the robot.
void StartInspector::MarkRobots() {
  const mjModel* m = scene_.model();
  robots_.clear();
  robot_of_.assign(m->nbody, -1);
  hand_of_.assign(m->nbody, -1);
  for (const RobotRecord& robot : scene_.compiled()->robots()) MarkHand(robot);
  std::vector<std::pair<int, std::string>> bases;
  for (const RobotRecord& robot : scene_.compiled()->robots())
    bases.emplace_back(FindId(m, mjOBJ_BODY, robot.base_body), robot.name);
  for (const auto& robot : bases) {
    const int base = robot.first;  // no structured binding: lambdas of clang 14 cannot capture it
    const bool mounted = base >= 0 && std::ranges::any_of(bases, [&](const auto& other) {
                           return other.first > 0 && other.first != base &&
                                  internal::IsInSubtree(m, base, other.first);
                         });
    if (base < 0 || mounted) continue;
    for (int b = 0; b < m->nbody; ++b) {
      if (internal::IsInSubtree(m, b, base)) robot_of_[b] = static_cast<int>(robots_.size());
    }
    robots_.push_back(robot.second);
  }
}

// The fingers of a hand may touch, and be inside of, what carries them and each other.
void StartInspector::MarkHand(const RobotRecord& robot) {
  const mjModel* m = scene_.model();
  for (const auto& [name, group] : robot.config.move_groups.entries()) {
    if (group->kind != MoveGroupKind::kGripper) continue;
    int hand = -1;
    for (const std::string& joint : group->joints) {
      const int id = FindId(m, mjOBJ_JOINT, robot.prefix + joint);
      if (id < 0) continue;
      const int carrier = m->body_parentid[m->jnt_bodyid[id]];
      hand = hand < 0 ? carrier : internal::CommonAncestor(m, hand, carrier);
    }
    for (int b = 0; hand > 0 && b < m->nbody; ++b) {
      if (internal::IsInSubtree(m, b, hand)) hand_of_[b] = hand;
    }
  }
}

bool StartInspector::AreParts(const Pair& bodies) const {
  const auto& [a, b] = bodies;
  if (robot_of_[a] < 0 || robot_of_[a] != robot_of_[b]) return false;
  if (hand_of_[a] >= 0 && hand_of_[a] == hand_of_[b]) return false;
  return !internal::AreNeighbours(scene_.model(), a, b);
}

std::vector<std::string> StartInspector::RobotsInsideThemselves() {
  Bind();
  const mjModel* m = scene_.model();
  const mjData* d = scene_.data();
  std::vector<int> deepest(robots_.size(), -1);
  for (int c = 0; c < d->ncon; ++c) {
    const mjContact& contact = d->contact[c];
    const int a = contact.geom[0], b = contact.geom[1];
    if (contact.exclude != 0 || a < 0 || b < 0 || contact.dist > -kInside) continue;
    if (!AreParts({m->geom_bodyid[a], m->geom_bodyid[b]})) continue;
    int& known = deepest[robot_of_[m->geom_bodyid[a]]];
    if (known < 0 || contact.dist < d->contact[known].dist) known = c;
  }
  std::vector<std::string> out;
  for (size_t i = 0; i < robots_.size(); ++i) {
    if (deepest[i] < 0) continue;
    const mjContact& contact = d->contact[deepest[i]];
    out.push_back(fmt::format("robot '{}' is inside itself: '{}' is {} deep in '{}'", robots_[i],
                              BodyText(m, m->geom_bodyid[contact.geom[0]]),
                              Millimetres(-contact.dist),
                              BodyText(m, m->geom_bodyid[contact.geom[1]])));
  }
  return out;
}

std::string StartInspector::RobotText(int body) const {
  return fmt::format("robot '{}' ({})", robots_[robot_of_[body]], BodyText(scene_.model(), body));
}

// Returns the bodies if one belongs to a robot and the other neither to the same robot nor to an
// object that has to lie still, and they penetrate too deep.
std::optional<StartInspector::Pair> StartInspector::RobotPair(int contact) const {
  const mjContact& c = scene_.data()->contact[contact];
  if (c.exclude != 0 || c.geom[0] < 0 || c.geom[1] < 0 || c.dist > -kInside) return std::nullopt;
  const mjModel* m = scene_.model();
  Pair bodies(m->geom_bodyid[c.geom[0]], m->geom_bodyid[c.geom[1]]);
  if (robot_of_[bodies.first] == robot_of_[bodies.second]) return std::nullopt;
  if (robot_of_[bodies.first] < 0) std::swap(bodies.first, bodies.second);
  if (object_of_[bodies.second] >= 0) return std::nullopt;
  return bodies;
}

std::vector<StartInspector::Pair> StartInspector::RobotPairs() {
  Bind();
  std::vector<Pair> pairs;
  for (int c = 0; c < scene_.data()->ncon; ++c) {
    if (const auto pair = RobotPair(c)) pairs.push_back(*pair);
  }
  return pairs;
}

std::vector<RobotOverlap> StartInspector::RobotsInside() {
  Bind();
  const mjModel* m = scene_.model();
  const mjData* d = scene_.data();
  const auto robots = [&](const Pair& pair) {
    return std::minmax({robot_of_[pair.first], robot_of_[pair.second]});
  };
  // A pair of bodies begins with either of the two robots.
  const auto same_robots = [&](const Pair& a, const Pair& b) {
    return robot_of_[a.second] >= 0 && robot_of_[b.second] >= 0 && robots(a) == robots(b);
  };
  std::vector<std::pair<Pair, int>> deepest;
  for (int c = 0; c < d->ncon; ++c) {
    const auto pair = RobotPair(c);
    if (!pair) continue;
    const auto known = std::ranges::find_if(deepest, [&](const auto& entry) {
      return entry.first == *pair || same_robots(entry.first, *pair);
    });
    if (known == deepest.end()) {
      deepest.emplace_back(*pair, c);
    } else if (d->contact[c].dist < d->contact[known->second].dist) {
      *known = {*pair, c};
    }
  }
  std::vector<RobotOverlap> out;
  for (const auto& [bodies, c] : deepest) {
    const mjContact& contact = d->contact[c];
    const bool first = m->geom_bodyid[contact.geom[0]] == bodies.first;
    const bool is_robot = robot_of_[bodies.second] >= 0;
    out.push_back(
        {robots_[robot_of_[bodies.first]],
         fmt::format(
             "{} is {} inside {}", RobotText(bodies.first), Millimetres(-contact.dist),
             is_robot ? RobotText(bodies.second) : OtherText(m, contact.geom[first ? 1 : 0])),
         is_robot ? "" : ObjectWith(scene_, bodies.second)});
  }
  return out;
}

std::string StartInspector::TouchOf(int contact) const {
  const mjModel* m = scene_.model();
  const mjContact& c = scene_.data()->contact[contact];
  if (c.exclude != 0 || c.geom[0] < 0 || c.geom[1] < 0 || c.dist >= 0) return "";
  int own = c.geom[0], other = c.geom[1];
  if (object_of_[m->geom_bodyid[own]] < 0) std::swap(own, other);
  const int object = object_of_[m->geom_bodyid[own]], other_body = m->geom_bodyid[other];
  if (object >= 0 && object != object_of_[other_body]) {
    if (robot_of_[other_body] >= 0)
      return fmt::format("'{}' touches {}", objects_[object].name, RobotText(other_body));
    if (c.dist < -kInside)
      return fmt::format("'{}' is {} inside {}", objects_[object].name, Millimetres(-c.dist),
                         OtherText(m, other));
  }
  const auto pair = RobotPair(contact);
  if (!pair || std::ranges::find(accepted_, *pair) != accepted_.end()) return "";
  const int hit = robot_of_[m->geom_bodyid[c.geom[0]]] < 0 ? c.geom[0] : c.geom[1];
  return fmt::format("{} is {} inside {}", RobotText(pair->first), Millimetres(-c.dist),
                     robot_of_[pair->second] < 0 ? OtherText(m, hit) : RobotText(pair->second));
}

// Looks down from the centre of mass: an object without a support under it tips over the edge.
StartInspector::Gap StartInspector::GapUnder(const Object& object) const {
  const mjModel* m = scene_.model();
  const mjData* d = scene_.data();
  const Vector3d down = Down(m);
  if (down.isZero() || object.geoms.empty()) return {0, -1};
  const Vector3d middle(d->subtree_com + 3 * object.body);
  int geom = -1;
  const double below = RayDown(m, d, middle, down, object.body, &geom);
  if (below < 0) return {std::numeric_limits<double>::infinity(), -1};
  double lowest = -std::numeric_limits<double>::infinity();
  for (const int g : object.geoms)
    lowest = std::max(lowest, internal::GeomExtent(m, d, g, down).upper);
  return {down.dot(middle) + below - lowest, geom};
}

// Returns true if nothing is under the object's edge, at one of four places around it.
bool StartInspector::ReachesOver(const Object& object) const {
  const mjModel* m = scene_.model();
  const mjData* d = scene_.data();
  const Vector3d down = Down(m);
  if (down.isZero() || object.geoms.empty()) return false;
  const Vector3d middle(d->subtree_com + 3 * object.body);
  int geom = -1;
  const double below = RayDown(m, d, middle, down, object.body, &geom);
  const Vector3d along = down.unitOrthogonal(), across = down.cross(along);
  for (const Vector3d& axis : {along, across}) {
    double lower = std::numeric_limits<double>::infinity(), upper = -lower;
    for (const int g : object.geoms) {
      const Interval extent = internal::GeomExtent(m, d, g, axis);
      lower = std::min(lower, extent.lower);
      upper = std::max(upper, extent.upper);
    }
    const double inset = kInset * (upper - lower);
    for (const double to : {lower + inset, upper - inset}) {
      const Vector3d from = middle + (to - axis.dot(middle)) * axis;
      const double there = RayDown(m, d, from, down, object.body, &geom);
      if (there < 0 || there > below + kStep) return true;
    }
  }
  return false;
}

std::string StartInspector::FallOf(const Object& object) const {
  const auto [height, geom] = GapUnder(object);
  if (std::isinf(height)) return fmt::format("nothing is under '{}'", object.name);
  if (height > object.most_gap)
    return fmt::format("'{}' is {:.2f} m above {}", object.name, height,
                       OtherText(scene_.model(), geom));
  const int body = geom < 0 ? 0 : scene_.model()->geom_bodyid[geom];
  if (robot_of_[body] >= 0) return fmt::format("'{}' is above {}", object.name, RobotText(body));
  if (object.may_reach_over || !ReachesOver(object)) return "";
  return fmt::format("'{}' reaches over the edge of {}", object.name,
                     OtherText(scene_.model(), geom));
}

void StartInspector::Accept() {
  accepted_ = RobotPairs();
  lowering_.clear();
  for (Object& object : objects_) {
    const double height = GapUnder(object).height;
    if (!std::isfinite(height)) continue;
    object.most_gap = internal::kMostSettling + std::max(0.0, height);
    object.may_reach_over = ReachesOver(object);
    if (height < kAbove || height > internal::kMostSettling) continue;
    lowering_.emplace_back(ElementName(scene_.model(), mjOBJ_BODY, object.body),
                           height * Down(scene_.model()));
  }
}

BodyPoses StartInspector::Lowered(BodyPoses starts) const {
  for (auto& [body, pose] : starts) {
    for (const auto& [lowered, by] : lowering_) {
      if (lowered == body) pose = Pose(pose.translation() + by, pose.quaternion());
    }
  }
  return starts;
}

std::string StartInspector::WhyNot() {
  Bind();
  for (int c = 0; c < scene_.data()->ncon; ++c) {
    if (std::string touch = TouchOf(c); !touch.empty()) return touch;
  }
  if (!needs_support_) return "";
  for (const Object& object : objects_) {
    if (std::string fall = FallOf(object); !fall.empty()) return fall;
  }
  return "";
}

std::vector<std::string> HangingObjects(const Scene& scene,
                                        const std::vector<std::string>& objects) {
  scene.SyncPoses();
  const mjModel* m = scene.model();
  std::vector<std::string> out;
  for (const std::string& name : objects) {
    const int root = RootBody(scene, name);
    if (scene.compiled()->object(name).free_joint || m->body_jntnum[root] > 0) continue;
    if (!HasGeoms(m, root) || NearestOther(scene, root, kNearEnough) < kNearEnough) continue;
    const bool mocap = m->body_mocapid[root] >= 0;
    out.push_back(
        fmt::format("object '{}' hangs in the air: its {}, so that it stays where it is "
                    "put. {} to let it fall, or {} true if it should hang there",
                    name, mocap ? "root is a mocap body" : "model has no joint",
                    mocap ? "Delete `mocap` in its model" : "Set fixed: false",
                    mocap ? "set fixed:" : "fixed:"));
  }
  return out;
}

std::vector<RobotOverlap> RobotsInTheFloor(const Scene& scene) {
  scene.SyncPoses();
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  std::vector<RobotOverlap> out;
  for (const RobotRecord& robot : scene.compiled()->robots()) {
    const int base = FindId(m, mjOBJ_BODY, robot.base_body);
    double deepest = kInTheFloor;
    int part = -1, floor = -1;
    for (int plane = 0; plane < m->ngeom; ++plane) {
      if (m->geom_type[plane] != mjGEOM_PLANE || !internal::IsCollisionGeom(m, plane)) continue;
      const Vector3d up(d->geom_xmat[9 * plane + 2], d->geom_xmat[9 * plane + 5],
                        d->geom_xmat[9 * plane + 8]);
      const double level = up.dot(Vector3d(d->geom_xpos + 3 * plane));
      for (int g = 0; base >= 0 && g < m->ngeom; ++g) {
        const int body = m->geom_bodyid[g];
        if (!internal::IsInSubtree(m, body, base) || m->body_weldid[body] != 0 ||
            !internal::IsCollisionGeom(m, g))
          continue;
        const double depth = level - internal::GeomExtent(m, d, g, up).lower;
        if (depth <= deepest) continue;
        deepest = depth;
        part = g;
        floor = plane;
      }
    }
    if (part < 0) continue;
    out.push_back({robot.name, fmt::format("robot '{}' ({}) stands {} deep in {}", robot.name,
                                           BodyText(m, m->geom_bodyid[part]), Millimetres(deepest),
                                           OtherText(m, floor))});
  }
  return out;
}

namespace {

// Returns how deep the lowest point of a free object is in the plane that its centre is below; 0
// for none.
double DepthInFloor(const Scene& scene, const std::string& name, int* floor) {
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  const int root = RootBody(scene, name);
  const Vector3d middle(d->subtree_com + 3 * root);
  double deepest = 0;
  for (int plane = 0; plane < m->ngeom; ++plane) {
    if (m->geom_type[plane] != mjGEOM_PLANE || !internal::IsCollisionGeom(m, plane)) continue;
    const Vector3d up(d->geom_xmat[9 * plane + 2], d->geom_xmat[9 * plane + 5],
                      d->geom_xmat[9 * plane + 8]);
    const double level = up.dot(Vector3d(d->geom_xpos + 3 * plane));
    if (up.dot(middle) >= level) continue;
    for (int g = 0; g < m->ngeom; ++g) {
      if (!internal::IsInSubtree(m, m->geom_bodyid[g], root) || !internal::IsCollisionGeom(m, g))
        continue;
      const double depth = level - internal::GeomExtent(m, d, g, up).lower;
      if (depth <= deepest) continue;
      deepest = depth;
      *floor = plane;
    }
  }
  return deepest;
}

}  // namespace

std::vector<std::string> ObjectsInTheFloor(const Scene& scene) {
  scene.SyncPoses();
  std::vector<std::string> out;
  for (const std::string& name : scene.object_names()) {
    int floor = -1;
    if (!scene.compiled()->object(name).free_joint) continue;
    const double depth = DepthInFloor(scene, name, &floor);
    if (floor < 0) continue;
    out.push_back(fmt::format("object '{}' is {} inside {}", name, Millimetres(depth),
                              OtherText(scene.model(), floor)));
  }
  return out;
}

std::vector<std::string> ObjectsInside(const Scene& scene) {
  scene.SyncPoses();
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  std::vector<int> object_of(m->nbody, -1), robot(m->nbody, 0), deepest;
  std::vector<double> depths;
  const std::vector<std::string> names = scene.object_names();
  for (size_t i = 0; i < names.size(); ++i) {
    const int root = RootBody(scene, names[i]);
    int floor = -1;
    const bool counts =
        scene.compiled()->object(names[i]).free_joint && DepthInFloor(scene, names[i], &floor) == 0;
    for (int b = 0; b < m->nbody && counts; ++b) {
      if (internal::IsInSubtree(m, b, root)) object_of[b] = static_cast<int>(i);
    }
  }
  for (const RobotRecord& record : scene.compiled()->robots()) {
    const int base = FindId(m, mjOBJ_BODY, record.base_body);
    for (int b = 0; b < m->nbody && base >= 0; ++b)
      robot[b] += internal::IsInSubtree(m, b, base) ? 1 : 0;
  }
  deepest.assign(names.size(), -1);
  depths.assign(names.size(), StartInspector::kInside);
  for (int c = 0; c < d->ncon; ++c) {
    const mjContact& contact = d->contact[c];
    if (contact.exclude != 0 || contact.geom[0] < 0 || contact.geom[1] < 0) continue;
    int own = m->geom_bodyid[contact.geom[0]], other = m->geom_bodyid[contact.geom[1]];
    if (object_of[own] < 0) std::swap(own, other);
    const int object = object_of[own];
    if (object < 0 || object == object_of[other] || robot[other] > 0) continue;
    if (-contact.dist <= depths[object]) continue;
    depths[object] = -contact.dist;
    deepest[object] = contact.geom[own == m->geom_bodyid[contact.geom[0]] ? 1 : 0];
  }
  std::vector<std::string> out;
  for (size_t i = 0; i < names.size(); ++i) {
    if (deepest[i] < 0) continue;
    out.push_back(fmt::format("object '{}' is {} inside {}", names[i], Millimetres(depths[i]),
                              OtherText(m, deepest[i])));
  }
  return out;
}

std::vector<std::string> ObjectsInMillimetres(const Scene& scene) {
  const mjModel* m = scene.model();
  std::vector<std::string> out;
  for (const std::string& name : scene.object_names()) {
    const int root = RootBody(scene, name);
    const bool free = scene.compiled()->object(name).free_joint.has_value();
    int largest = -1;
    for (int g = 0; g < m->ngeom; ++g) {
      if (!internal::IsInSubtree(m, m->geom_bodyid[g], root) || m->geom_type[g] == mjGEOM_PLANE)
        continue;
      const mjtNum* half = m->geom_aabb + 6 * g + 3;  // half sizes of a box around it
      const double thickest = std::max({half[0], half[1], half[2]});
      const double thinnest = std::min({half[0], half[1], half[2]});
      if (2 * (free ? thickest : thinnest) <= kLargestObject) continue;
      if (largest < 0 || m->geom_rbound[g] > m->geom_rbound[largest]) largest = g;
    }
    if (largest < 0) continue;
    const mjtNum* half = m->geom_aabb + 6 * largest + 3;
    const double size = 2 * std::max({half[0], half[1], half[2]});
    out.push_back(TooLargeText(name, size, m->geom_type[largest] == mjGEOM_MESH));
  }
  return out;
}

std::vector<std::string> ObjectsOverNothing(const Scene& scene) {
  scene.SyncPoses();
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  const Vector3d down = Down(m);
  std::vector<std::string> out;
  if (down.isZero()) return out;
  for (const std::string& name : scene.object_names()) {
    const ObjectRecord& object = scene.compiled()->object(name);
    const int root = RootBody(scene, name);
    int geom = -1;
    int floor = -1;
    if (!object.free_joint || m->body_gravcomp[root] >= 1) continue;
    if (DepthInFloor(scene, name, &floor) > 0) continue;
    if (RayDown(m, d, Vector3d(d->subtree_com + 3 * root), down, root, &geom) < 0)
      out.push_back(name);
  }
  return out;
}

}  // namespace robocell::internal
