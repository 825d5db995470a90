#include "robocell/motion/collision_model.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "robocell/base/error.h"
#include "robocell/motion/cover_cache.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/scratch_robot.h"

namespace robocell::internal {
namespace {

using Eigen::Vector3d;
using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

// Spheres count as so much larger than they are, m for each metre of the scene's extent: more than
// what floats lose. Inner spheres count twice as much, so that what is below them never reaches out.
constexpr double kRounding = 1e-5;
// The share of their inflation by which bold spheres shrink among the robot's own parts.
constexpr float kBoldShrink = 0.7f;
constexpr int kObstaclePlanes = 104;

void Put(const Vector3d& v, float* out) {
  for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(v[i]);
}
SphereTable::Ball BallOf(const Vector3d& centre, double radius) {
  return {static_cast<float>(centre.x()), static_cast<float>(centre.y()),
          static_cast<float>(centre.z()), static_cast<float>(radius)};
}
Vector3d CentreOf(const SphereTable::Ball& ball) { return {ball.x, ball.y, ball.z}; }

Transform PoseOfGeom(const mjData* d, int geom) {
  return {Eigen::Map<const RowMajor>(d->geom_xmat + 9 * geom),
          Eigen::Map<const Vector3d>(d->geom_xpos + 3 * geom)};
}
Transform PoseInBody(const mjModel* m, int geom) {
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rotation;
  mju_quat2Mat(rotation.data(), m->geom_quat + 4 * geom);
  return {rotation, Eigen::Map<const Vector3d>(m->geom_pos + 3 * geom)};
}

}  // namespace

struct CollisionModel::State {
  // The bodies of a geom, with covers if it moves; made once for each size.
  struct Shapes {
    Vector3d size = Vector3d::Constant(-1);
    bool moves = false;
    std::vector<ConvexShape> shapes;
    std::vector<std::shared_ptr<const SphereCover>> covers;
  };

  State(const Robot& r, std::span<const int> moving, const CollisionOptions& o)
      : robot(r),
        compiled(r.scene().compiled()),
        joints(moving.begin(), moving.end()),
        options(o),
        data(MakeData(r.scene().model())) {}

  void Update();
  void ReadNames();
  void FindPresent();
  void MakeTable();
  void AddLinks();
  const Shapes& ShapesOf(int geom, bool moves);
  void AddTree(int link, int geom);
  void AddObstacle(int geom);
  void AddPairs(int link);
  void AddNear(int link);
  void BoundLink(int link);
  void AllowOwnTouches();
  bool IsAllowed(int a, int b) const;
  bool StandsOn(int moving, int other) const;
  bool MayMeet(int moving, int other) const {
    return MayCollide(model(), moving, other) && !IsAllowed(moving, other) &&
           !StandsOn(moving, other);
  }
  const mjModel* model() const { return compiled->model(); }
  std::string place() const { return "motion of robot '" + robot.name() + "'"; }
  DemandOfSpheres Demand(SphereJudge judge, double more) const {
    return {.clearance = static_cast<float>(options.clearance + more),
            .own_clearance = judge == SphereJudge::kBold ? 0 : static_cast<float>(more),
            .shrunk = judge == SphereJudge::kBold ? kBoldShrink : 0.0f};
  }
  double Limit(bool own, double more) const { return own ? more : options.clearance + more; }
  void PlaceGeoms(std::span<const double> q);
  double EngineDistance(const SpherePair& pair, double horizon);

  Robot robot;
  std::shared_ptr<CompiledScene> compiled;
  std::vector<int> joints;
  CollisionOptions options;
  DataPtr data;
  std::optional<MovingLinks> links;
  std::vector<double> present;
  std::vector<char> counts, own;                       // per geom
  std::vector<int> base_joints;                        // ids
  std::vector<std::pair<int, int>> allowed, attached;  // bodies
  std::vector<std::pair<int, int>> always_touching;    // geoms, the smaller id first, sorted
  std::vector<std::vector<int>> geoms_of;              // per link
  std::vector<Transform> geom_in_link;                 // per geom
  std::vector<Transform> poses;                        // per link
  std::vector<Shapes> shapes_of;                       // per geom
  SphereTable table;
  SphereScratch scratch;
  std::vector<SpherePair> pairs;
  Counts done;
};

void CollisionModel::State::ReadNames() {
  const mjModel* m = model();
  const auto id = [&](const std::string& name) {
    return name.empty() ? 0 : RequireId(m, mjOBJ_BODY, name, place());
  };
  allowed.clear();
  attached.clear();
  for (const auto& [a, b] : options.allowed) allowed.emplace_back(id(a), id(b));
  for (const auto& [body, to] : options.attached) attached.emplace_back(id(body), id(to));
  base_joints.clear();
  for (const std::string& group : robot.group_names()) {
    if (robot.group(group).kind() != MoveGroupKind::kBase) continue;
    for (const std::string& name : robot.group(group).joint_names())
      base_joints.push_back(RequireId(m, mjOBJ_JOINT, name, place()));
  }
  own.assign(m->ngeom, 0);
  counts.assign(m->ngeom, 0);
  for (const int g : robot.geom_ids()) own[g] = 1;
  for (int g = 0; g < m->ngeom; ++g) counts[g] = !own[g] && IsCollisionGeom(m, g);
  for (const int g : robot.collision_geom_ids()) counts[g] = IsCollisionGeom(m, g);
  for (const auto& [body, to] : attached) {
    for (int g = 0; g < m->ngeom; ++g) {
      if (IsInSubtree(m, m->geom_bodyid[g], body)) own[g] = 1;
    }
  }
}

bool CollisionModel::State::IsAllowed(int a, int b) const {
  const std::pair<int, int> geoms = std::minmax(a, b);
  if (std::ranges::binary_search(always_touching, geoms)) return true;
  const mjModel* m = model();
  const int first = m->geom_bodyid[a], second = m->geom_bodyid[b];
  return std::ranges::any_of(allowed, [&](const std::pair<int, int>& pair) {
    const auto is_pair = [&](int x, int y) {
      return IsInSubtree(m, x, pair.first) && IsInSubtree(m, y, pair.second);
    };
    return is_pair(first, second) || is_pair(second, first);
  });
}

// A base that moves on the floor touches it: planes count only for what the arms move, as when the
// base is placed (clearance.h).
bool CollisionModel::State::StandsOn(int moving, int other) const {
  const mjModel* m = model();
  if (m->geom_type[other] != mjGEOM_PLANE) return false;
  int link = links->link_of(m->geom_bodyid[moving]);
  for (; link != 0; link = links->links()[link].parent) {
    const int joint = links->dofs()[links->links()[link].dof].joint;
    if (std::ranges::find(base_joints, joint) == base_joints.end()) return false;
  }
  return true;
}

void CollisionModel::State::FindPresent() {
  const mjModel* m = model();
  const mjData* from = robot.scene().data();
  mju_copy(data->qpos, from->qpos, m->nq);
  mju_copy(data->mocap_pos, from->mocap_pos, 3 * m->nmocap);
  mju_copy(data->mocap_quat, from->mocap_quat, 4 * m->nmocap);
  mjData* d = data.get();
  Guarded("planning a motion: poses", d, [&] { mj_kinematics(m, d); });
  links.emplace(m, d, joints, place());
  present.clear();
  for (const int joint : joints) present.push_back(d->qpos[m->jnt_qposadr[joint]]);
  for (const auto& [body, to] : attached) links->Attach(m, d, body, links->link_of(to));
  poses.resize(links->links().size());
  geoms_of.assign(links->links().size(), {});
  geom_in_link.resize(m->ngeom);
  shapes_of.resize(m->ngeom);
  for (int g = 0; g < m->ngeom; ++g) {
    const int body = m->geom_bodyid[g], link = links->link_of(body);
    if (!counts[g]) continue;
    geoms_of[link].push_back(g);
    geom_in_link[g] = links->in_link(body) * PoseInBody(m, g);
  }
}

const CollisionModel::State::Shapes& CollisionModel::State::ShapesOf(int geom, bool moves) {
  Shapes& known = shapes_of[geom];
  const Vector3d size(model()->geom_size + 3 * geom);
  if (known.size == size && known.moves == moves) return known;
  known = {.size = size, .moves = moves};
  if (moves) {
    known.shapes = ConvexShapesOf(model(), geom);
  } else {
    known.shapes = ConvexShapesOf(model(), geom, kObstaclePlanes);
  }
  for (const ConvexShape& shape : known.shapes) {
    if (moves && shape.kind == ConvexShape::Kind::kHalfSpace) {
      throw ArgumentError(fmt::format("{}: {} is a plane and moves; a box can move", place(),
                                      robocell::Describe(model(), mjOBJ_GEOM, geom)));
    }
    if (moves) known.covers.push_back(CachedCover(shape));
  }
  return known;
}

void CollisionModel::State::AddTree(int link, int geom) {
  const Transform& pose = geom_in_link[geom];
  for (const std::shared_ptr<const SphereCover>& cover : ShapesOf(geom, true).covers) {
    SphereTable::Tree tree{.link = link,
                           .shrink = static_cast<float>(cover->inflation),
                           .geom = geom,
                           .own = own[geom] != 0};
    tree.nodes.first = static_cast<int>(table.nodes.size());
    for (const SphereCover::Node& node : cover->nodes)
      table.nodes.push_back(
          {BallOf(pose * node.centre, node.radius), node.next + tree.nodes.first});
    tree.nodes.last = static_cast<int>(table.nodes.size());
    table.trees.push_back(tree);
  }
}

void CollisionModel::State::AddObstacle(int geom) {
  const mjModel* m = model();
  const Transform pose = PoseOfGeom(data.get(), geom);
  for (const ConvexShape& shape : ShapesOf(geom, false).shapes) {
    SphereTable::Obstacle o{.geom = geom, .own = own[geom] != 0};
    const double* size = m->geom_size + 3 * geom;
    Put(pose.translation, o.centre);
    for (int k = 0; k < 3; ++k) Put(pose.rotation.col(k), o.axes + 3 * k);
    for (int k = 0; k < 3; ++k) o.size[k] = static_cast<float>(size[k]);
    switch (m->geom_type[geom]) {
      case mjGEOM_SPHERE:
        o.shape = SphereTable::Shape::kBall;
        break;
      case mjGEOM_CAPSULE:
        o.shape = SphereTable::Shape::kCapsule;
        break;
      case mjGEOM_CYLINDER:
        o.shape = SphereTable::Shape::kCylinder;
        break;
      case mjGEOM_PLANE:
        o.shape = SphereTable::Shape::kHalfSpace;
        break;
      case mjGEOM_MESH:
      case mjGEOM_ELLIPSOID:
        o.shape = SphereTable::Shape::kPolytope;
        break;
      default:
        o.shape = SphereTable::Shape::kBox;
        Put(pose * shape.box.center(), o.centre);
        Put(shape.box.sizes() / 2, o.size);
    }
    if (o.shape != SphereTable::Shape::kHalfSpace)
      o.ball = BallOf(pose * shape.box.center(), shape.box.sizes().norm() / 2);
    o.planes.first = o.planes.last = static_cast<int>(table.planes.size());
    if (o.shape == SphereTable::Shape::kHalfSpace || o.shape == SphereTable::Shape::kPolytope) {
      for (const HalfSpace& plane : shape.planes) {
        const Vector3d normal = pose.rotation * plane.normal;
        table.planes.push_back({});
        Put(normal, table.planes.back().normal);
        table.planes.back().offset =
            static_cast<float>(plane.offset + normal.dot(pose.translation));
      }
      o.planes.last = static_cast<int>(table.planes.size());
    }
    table.obstacles.push_back(o);
  }
}

void CollisionModel::State::AddLinks() {
  for (size_t l = 0; l < links->links().size(); ++l) {
    const MovingLinks::Link& from = links->links()[l];
    SphereTable::Link link{.parent = from.parent,
                           .slide = from.slide,
                           .follows = from.of_dof != JointPolynomial{},
                           .dof = from.dof,
                           .reference = from.reference,
                           .from = from.of_dof.from};
    std::ranges::copy(from.of_dof.c, link.polynomial);
    for (int k = 0; k < 3; ++k) {
      for (int c = 0; c < 3; ++c)
        link.rotation[3 * k + c] = static_cast<float>(from.fixed.rotation(k, c));
    }
    Put(from.fixed.translation, link.translation);
    link.trees.first = static_cast<int>(table.trees.size());
    if (l > 0) {
      for (const int g : geoms_of[l]) AddTree(static_cast<int>(l), g);
    }
    link.trees.last = static_cast<int>(table.trees.size());
    table.links.push_back(link);
  }
}

// Puts a ball around all trees of a link.
void CollisionModel::State::BoundLink(int l) {
  SphereTable::Link& link = table.links[l];
  if (link.trees.first == link.trees.last) return;
  Eigen::AlignedBox3d box;
  const auto each = [&](const auto& visit) {
    for (int t = link.trees.first; t < link.trees.last; ++t) {
      const SphereTable::Tree& tree = table.trees[t];
      for (int n = tree.nodes.first; n < tree.nodes.last; ++n) {
        if (table.nodes[n].next == n + 1) visit(table.nodes[n].ball);
      }
    }
  };
  each([&](const SphereTable::Ball& b) {
    box.extend(CentreOf(b) + Vector3d::Constant(b.radius));
    box.extend(CentreOf(b) - Vector3d::Constant(b.radius));
  });
  const Vector3d centre = box.center();
  double radius = 0;
  each([&](const SphereTable::Ball& b) {
    radius = std::max(radius, (CentreOf(b) - centre).norm() + b.radius);
  });
  link.ball = BallOf(centre, radius);
}

void CollisionModel::State::AddPairs(int l) {
  SphereTable::Link& link = table.links[l];
  link.pairs.first = static_cast<int>(table.link_pairs.size());
  for (int other = 1; other < l; ++other) {
    SphereTable::LinkPair pair{.other = other};
    pair.trees.first = static_cast<int>(table.tree_pairs.size());
    const SphereTable::Range& theirs = table.links[other].trees;
    for (int a = link.trees.first; a < link.trees.last; ++a) {
      for (int b = theirs.first; b < theirs.last; ++b) {
        const SphereTable::Tree &x = table.trees[a], &y = table.trees[b];
        if (MayMeet(x.geom, y.geom)) table.tree_pairs.push_back({a, b, x.own && y.own});
      }
    }
    pair.trees.last = static_cast<int>(table.tree_pairs.size());
    if (pair.trees.last > pair.trees.first) table.link_pairs.push_back(pair);
  }
  link.pairs.last = static_cast<int>(table.link_pairs.size());
}

// Lists the obstacles within reach: links turn about a joint that stays.
void CollisionModel::State::AddNear(int l) {
  SphereTable::Link& link = table.links[l];
  link.near.first = link.near.last = static_cast<int>(table.near.size());
  if (link.trees.first == link.trees.last) return;
  double reach = link.ball.radius + CentreOf(link.ball).norm() + options.clearance + 0.1;
  int root = l;
  for (int up = l; up != 0; up = links->links()[up].parent) {
    const MovingLinks::Link& at = links->links()[up];
    const MovingLinks::Dof& dof = links->dofs()[at.dof];
    if (at.slide) {
      reach += at.of_dof == JointPolynomial{} ? std::max(std::abs(dof.upper - at.reference),
                                                         std::abs(dof.lower - at.reference))
                                              : std::numeric_limits<double>::infinity();
    }
    if (at.parent != 0) reach += at.fixed.translation.norm();
    root = up;
  }
  const Vector3d anchor = links->links()[root].fixed.translation;
  for (int o = 0; o < static_cast<int>(table.obstacles.size()); ++o) {
    const SphereTable::Obstacle& obstacle = table.obstacles[o];
    const bool is_plane = obstacle.shape == SphereTable::Shape::kHalfSpace;
    if (!is_plane && (CentreOf(obstacle.ball) - anchor).norm() > reach + obstacle.ball.radius)
      continue;
    const auto may_touch = [&](int t) {
      return !table.ignored[static_cast<size_t>(t) * table.obstacles.size() + o];
    };
    bool any = false;
    for (int t = link.trees.first; t < link.trees.last; ++t) any = any || may_touch(t);
    if (any) table.near.push_back(o);
  }
  link.near.last = static_cast<int>(table.near.size());
}

void CollisionModel::State::MakeTable() {
  table = {};
  table.dofs = links->n_dofs();
  AddLinks();
  for (const int g : geoms_of[0]) AddObstacle(g);
  table.ignored.assign(table.trees.size() * table.obstacles.size(), 0);
  double extent = 1;
  for (size_t t = 0; t < table.trees.size(); ++t) {
    for (size_t o = 0; o < table.obstacles.size(); ++o) {
      table.ignored[t * table.obstacles.size() + o] =
          !MayMeet(table.trees[t].geom, table.obstacles[o].geom);
    }
  }
  const int n = static_cast<int>(table.links.size());
  for (int l = 1; l < n; ++l) {
    BoundLink(l);
    AddPairs(l);
    AddNear(l);
    extent += table.links[l].ball.radius + links->links()[l].fixed.translation.norm();
  }
  for (const MovingLinks::Dof& dof : links->dofs()) {
    if (dof.slide && dof.limited) extent += std::max(std::abs(dof.lower), std::abs(dof.upper));
  }
  const auto rounding = static_cast<float>(kRounding * extent);
  for (size_t k = 0; k < table.nodes.size(); ++k) {
    const bool is_leaf = table.nodes[k].next == static_cast<int>(k) + 1;
    table.nodes[k].ball.radius += is_leaf ? rounding : 2 * rounding;
  }
  for (SphereTable::Link& link : table.links) {
    if (link.ball.radius >= 0) link.ball.radius += 3 * rounding;
  }
  scratch.Fit(table);
}

// Own parts that overlap in the present posture: the model is like that.
void CollisionModel::State::AllowOwnTouches() {
  always_touching.clear();
  std::vector<SpherePair> near;
  FindSpherePairs(table, Demand(SphereJudge::kCautious, 0), present, 1, &scratch, &near);
  PlaceGeoms(present);
  for (const SpherePair& pair : near) {
    if (pair.own && EngineDistance(pair, 0) < 0)
      always_touching.emplace_back(std::minmax(pair.geom, pair.other));
  }
  if (always_touching.empty()) return;
  std::ranges::sort(always_touching);
  MakeTable();
}

void CollisionModel::State::Update() {
  if (robot.scene().compiled() != compiled) {
    throw Error(
        fmt::format("scene '{}': objects were added or removed since the robot's "
                    "surroundings were looked at; make the planner again",
                    robot.scene().name()));
  }
  ReadNames();
  FindPresent();
  always_touching.clear();
  MakeTable();
  AllowOwnTouches();
}

void CollisionModel::State::PlaceGeoms(std::span<const double> q) {
  links->Place(q, poses);
  for (size_t l = 1; l < poses.size(); ++l) {
    for (const int g : geoms_of[l]) {
      const Transform pose = poses[l] * geom_in_link[g];
      Eigen::Map<RowMajor>(data->geom_xmat + 9 * g) = pose.rotation;
      Eigen::Map<Vector3d>(data->geom_xpos + 3 * g) = pose.translation;
    }
  }
}

double CollisionModel::State::EngineDistance(const SpherePair& pair, double horizon) {
  ++done.distances;
  const mjModel* m = model();
  mjData* d = data.get();
  // With a horizon of 0 the engine does not tell how near separate geoms are, but that they are.
  const double within = std::max(horizon, 1e-6);
  return Guarded("planning a motion: distance of two geoms", d,
                 [&] { return mj_geomDistance(m, d, pair.geom, pair.other, within, nullptr); });
}

CollisionModel::CollisionModel(const Robot& robot, std::span<const int> joints,
                               const CollisionOptions& options)
    : state_(std::make_unique<State>(robot, joints, options)) {
  Update();
}
CollisionModel::~CollisionModel() = default;

void CollisionModel::Update() { state_->Update(); }

const Robot& CollisionModel::robot() const { return state_->robot; }
const mjModel* CollisionModel::model() const { return state_->model(); }
const MovingLinks& CollisionModel::links() const { return *state_->links; }
const std::vector<double>& CollisionModel::present() const { return state_->present; }
const SphereTable& CollisionModel::spheres() const { return state_->table; }
const CollisionModel::Counts& CollisionModel::counts() const { return state_->done; }

uint32_t CollisionModel::MayHit(std::span<const double> rows, int count, SphereJudge judge,
                                bool any, double more) {
  State& s = *state_;
  s.done.configurations += count;
  return FindSphereHits(s.table, s.Demand(judge, more), rows, count, any, &s.scratch);
}

uint32_t CollisionModel::Hit(std::span<const double> rows, int count, bool any, double more) {
  State& s = *state_;
  s.done.configurations += count;
  FindSpherePairs(s.table, s.Demand(SphereJudge::kCautious, more), rows, count, &s.scratch,
                  &s.pairs);
  uint32_t doubtful = 0, hits = 0;
  for (const SpherePair& pair : s.pairs) doubtful |= pair.lanes;
  for (int k = 0; k < count; ++k) {
    if ((doubtful >> k & 1) == 0) continue;
    s.PlaceGeoms(rows.subspan(static_cast<size_t>(k) * s.table.dofs, s.table.dofs));
    for (const SpherePair& pair : s.pairs) {
      const double least = s.Limit(pair.own, more);
      if ((pair.lanes >> k & 1) == 0 || s.EngineDistance(pair, least) >= least) continue;
      hits |= 1u << k;
      break;
    }
    if (any && hits) break;
  }
  return hits;
}

std::optional<GeomContact> CollisionModel::FindContact(std::span<const double> q) {
  State& s = *state_;
  ++s.done.configurations;
  FindSpherePairs(s.table, s.Demand(SphereJudge::kCautious, 0), q, 1, &s.scratch, &s.pairs);
  if (s.pairs.empty()) return std::nullopt;
  s.PlaceGeoms(q);
  std::optional<GeomContact> worst;
  double most = 0;
  for (const SpherePair& pair : s.pairs) {
    const double least = s.Limit(pair.own, 0), distance = s.EngineDistance(pair, least);
    if (distance - least >= most) continue;
    most = distance - least;
    worst = {pair.geom, pair.other, distance};
  }
  return worst;
}

double CollisionModel::Distance(std::span<const double> q, double horizon) {
  State& s = *state_;
  const double more = std::max(0.0, horizon - s.options.clearance);
  FindSpherePairs(s.table, s.Demand(SphereJudge::kCautious, std::max(more, horizon)), q, 1,
                  &s.scratch, &s.pairs);
  double nearest = horizon;
  if (!s.pairs.empty()) s.PlaceGeoms(q);
  for (const SpherePair& pair : s.pairs)
    nearest = std::min(nearest, s.EngineDistance(pair, nearest));
  return nearest;
}

std::string CollisionModel::Describe(const GeomContact& contact) const {
  const mjModel* m = state_->model();
  const auto name = [&](int geom) {
    return robocell::Describe(m, mjOBJ_BODY, m->geom_bodyid[geom]);
  };
  return fmt::format("{} and {}", name(contact.geom), name(contact.other));
}

}  // namespace robocell::internal
