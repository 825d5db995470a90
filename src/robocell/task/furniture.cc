#include "robocell/task/furniture.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <utility>
#include <vector>
#include <Eigen/Geometry>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/base/units.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/place_overlap.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/base_stances.h"
#include "robocell/task/door_swings.h"
#include "robocell/task/handle_motion.h"

namespace robocell::internal {
namespace {

constexpr double kFacingNoise = 0.25;  // rad
constexpr double kFromRobot = 0.45;    // m, of furniture on the floor
constexpr double kFloorStep = 0.04;    // m by which each try is farther away, without a robot
constexpr double kReachStep = 0.004;   // ... with one
constexpr double kSideways = 0.1;      // m, largest offset along the edge, if that is free
constexpr double kToEdge =
    0.002;  // m from its front to the edge of the support: handles are over it
constexpr double kOver = 0.0005;          // m above the support
constexpr double kInFront = 0.12;         // m of free space
constexpr double kMostOffFront = 0.6;     // rad between the front and the robot, at first
constexpr double kStandClearance = 0.01;  // m
// A base is tried at 60 places, which are farther and farther from where it would stand at best, and
// a few of them are checked with the whole motion.
constexpr int kStandTries = 60, kStandChecks = 6;
constexpr double kNearer = 0.2, kFarther = 0.45;  // m, of the last of them
// The way of the hand is between these shares of the robot's reach.
constexpr double kNearestShare = 0.25, kFarthestShare = 0.9;
constexpr double kStandShare = 0.6;  // of the reach, from a handle that the base was far from
constexpr int kPlaceTries = 40;      // of each support, and of the floor
constexpr int kFacingTries = 400;    // of each support, for furniture that looks to a robot
constexpr Vec2 kFrontOfRobot = {0.3, 0.5};  // m from a robot to the front of furniture, at first

// What is known of a model.
struct Measured {
  bool moves = false;            // has hinges or slides
  Eigen::AlignedBox3d standing;  // around what its joints do not move, as it is built
};

Measured Measure(const std::string& kind) {
  static std::mutex mutex;
  static std::map<std::string, Measured> known;
  const std::lock_guard lock(mutex);
  if (const auto found = known.find(kind); found != known.end()) return found->second;
  SceneSpec spec{
      .name = "model " + kind, .timestep = 0.002, .add_floor = false, .add_skybox = false};
  spec.objects.push_back({.name = "object", .mjcf_path = kind, .pos = Vec3{}, .fixed = true});
  const Scene scene = Scene::Build(spec);
  scene.SyncPoses();
  const mjModel* m = scene.model();
  Measured measured;
  for (int j = 0; j < m->njnt; ++j) {
    const int type = m->jnt_type[j];
    measured.moves = measured.moves || type == mjJNT_HINGE || type == mjJNT_SLIDE;
  }
  for (int g = 0; g < m->ngeom; ++g) {
    if (!IsCollisionGeom(m, g) || m->body_weldid[m->geom_bodyid[g]] != 0) continue;
    Eigen::Vector3d low, high;
    for (int axis = 0; axis < 3; ++axis) {
      const Interval extent = GeomExtent(m, scene.data(), g, Eigen::Vector3d::Unit(axis));
      low[axis] = extent.lower, high[axis] = extent.upper;
    }
    if (low.allFinite() && high.allFinite()) measured.standing.extend(low).extend(high);
  }
  if (measured.standing.isEmpty()) measured.standing.extend(Eigen::Vector3d::Zero());
  return known[kind] = measured;
}

// What is in place in a spec, and a piece of furniture that is to come to it.
class FreePlace {
 public:
  FreePlace(const SceneSpec& spec, const SceneObject& object)
      : scene_(Scene::Build(WithIt(spec, object))),
        overlap_(
            (scene_.SyncPoses(), scene_),
            FindId(scene_.model(), mjOBJ_BODY, scene_.compiled()->object(object.name).root_body)) {}

  // Tests it over its support, so that the support does not count as beside it.
  bool Has(const Pose& pose) {
    constexpr double kRaised = kBesideFurniture + 0.005;
    for (const double forward : {0.0, kInFront}) {
      const Pose raised =
          Pose(Eigen::Vector3d(0, 0, kRaised)) * pose * Pose(Eigen::Vector3d(forward, 0, 0));
      if (!overlap_.IsFree(raised, kBesideFurniture)) return false;
    }
    return true;
  }

 private:
  // Only what has a place already; robots come later and make room for themselves.
  static SceneSpec WithIt(SceneSpec spec, SceneObject object) {
    const bool has_robots = !spec.robots.empty();
    spec.robots.clear();
    spec.cameras.clear();
    std::vector<SceneObject> placed;
    for (const SceneObject& each : spec.objects) {
      const AttachKind to = each.attach_to.kind;
      const bool on_robot = has_robots && to != AttachKind::kWorld && to != AttachKind::kRoot &&
                            to != AttachKind::kSharedBase;
      const bool comes_later = !each.has_pose() && !each.fixed.value_or(!each.shape.has_value());
      if (!on_robot && !comes_later && !each.parked.value_or(false)) placed.push_back(each);
    }
    spec.objects.clear();
    for (SceneObject& each : placed) spec.objects.push_back(std::move(each));
    object.fixed = false;  // what stands fixed does not collide with what stands fixed
    spec.objects.push_back(std::move(object));
    return spec;
  }

  Scene scene_;
  PlaceOverlap overlap_;
};

// Returns the base of a robot that stands in the world, in the root frame or in the shared base
// frame; else the root frame.
Pose RobotInWorld(const SceneSpec& spec, const RobotSpec& robot) {
  const Pose root = spec.root_frame_to_world;
  switch (robot.attach_to.kind) {
    case AttachKind::kWorld:
      return robot.pose();
    case AttachKind::kRoot:
      return root * robot.pose();
    case AttachKind::kSharedBase:
      return root * spec.shared_base_frame_to_root_frame * robot.pose();
    default:
      return root;
  }
}

// Returns the height of the free floor next to a point, 0 without one.
double FloorUnder(const SceneAnnotations& annotations, const Eigen::Vector3d& point) {
  double nearest = std::numeric_limits<double>::infinity(), height = 0;
  for (const FloorArea& area : annotations.free_floor) {
    const Eigen::Vector3d middle = area.frame_to_world.translation();
    const double distance = (middle - point).norm();
    if (distance < nearest) nearest = distance, height = middle.z();
  }
  return height;
}

// Returns true if the four lower corners of furniture are over a support, with `margin` to its edge.
bool StandsOn(const Support& face, const Pose& in_face, const Eigen::AlignedBox3d& box,
              double margin) {
  for (const double x : {box.min().x(), box.max().x()}) {
    for (const double y : {box.min().y(), box.max().y()}) {
      const Eigen::Vector3d corner = in_face * Eigen::Vector3d(x, y, 0);
      if (std::abs(corner.x()) > face.half_x - margin ||
          std::abs(corner.y()) > face.half_y - margin)
        return false;
    }
  }
  return true;
}

double YawOf(const Eigen::Vector3d& direction) { return std::atan2(direction.y(), direction.x()); }

}  // namespace

bool IsFurniture(const std::string& kind) {
  const std::vector<std::string> plain = ObjectKinds();
  if (std::ranges::find(plain, kind) != plain.end()) return false;
  return Measure(kind).moves;
}

SceneObject PutFurniture(const SceneSpec& spec, const SceneAnnotations& annotations,
                         const std::string& name, const std::string& kind, Rng& rng) {
  SceneObject object{.name = name, .mjcf_path = kind, .pos = Vec3{}, .fixed = true};
  const Eigen::AlignedBox3d size = Measure(kind).standing;
  FreePlace place(spec, object);
  const double width = size.sizes().y(), depth = size.sizes().x(), front = size.max().x();
  const auto at = [&](const Pose& pose) {
    object.pos = ToVec3(pose.translation());
    object.quat = pose.quaternion();
    return object;
  };
  std::optional<Pose> facing;  // the robot that the furniture looks to
  if (!spec.robots.empty()) facing = RobotInWorld(spec, spec.robots[0]);
  for (const SupportFace& support : annotations.supports) {
    const Support& face = support.face;
    for (int i = 0; i < kFacingTries && facing; ++i) {
      const Eigen::Vector3d on(rng.Uniform(-face.half_x, face.half_x),
                               rng.Uniform(-face.half_y, face.half_y), kOver);
      const Eigen::Vector3d robot = face.frame_to_world.inverse() * facing->translation();
      const double yaw = YawOf(robot - on) + rng.Uniform(-kFacingNoise, kFacingNoise);
      const Pose in_face = Pose::FromRpy(on, {0, 0, yaw});
      const double away = (robot - in_face * Eigen::Vector3d(front, 0, 0)).head<2>().norm();
      const double wider = static_cast<double>(i) / kFacingTries;
      if (away < kFrontOfRobot[0] * (1 - 0.3 * wider) || away > kFrontOfRobot[1] * (1 + wider) ||
          !StandsOn(face, in_face, size, kToEdge * (1 - wider)))
        continue;
      const Pose pose = face.frame_to_world * in_face;
      if (place.Has(pose)) return at(pose);
    }
    const bool across = face.half_y < face.half_x;  // its front is over the longer edge
    const double edge = std::max(face.half_x, face.half_y);
    const double half = std::min(face.half_x, face.half_y);
    if (2 * edge < width || 2 * half < depth) continue;
    const double forward = std::max(0.0, half - front - kToEdge);
    for (int i = 0; i < kPlaceTries; ++i) {
      const double room = edge - width / 2;
      const double most = i < kPlaceTries / 4 ? std::min(kSideways, room) : room;
      const double sideways = rng.Uniform(-most, most);
      const double noise = rng.Uniform(-kFacingNoise, kFacingNoise);
      const double yaw = (across ? kPi / 2 : 0) + (rng.Uniform() < 0.5 ? kPi : 0);
      const Pose over = Pose::FromRpy({0, 0, kOver}, {0, 0, yaw});
      const Pose pose =
          face.frame_to_world * over * Pose::FromRpy({forward, sideways, 0}, {0, 0, noise});
      if (place.Has(pose)) return at(pose);
    }
  }
  const Pose robot = facing.value_or(Pose());
  const Eigen::Vector3d ahead = robot.rotation().col(0);
  for (int i = 0; i < kPlaceTries; ++i) {
    const double spread = i * kPi / kPlaceTries;
    const double noise = rng.Uniform(-kFacingNoise, kFacingNoise);
    const double away =
        facing ? std::max(kFromRobot, front + kFrontOfRobot[0]) + kReachStep * i : kFloorStep * i;
    const double yaw = YawOf(ahead) + rng.Uniform(-spread, spread);
    const Eigen::Vector3d on_floor(robot.translation().x() + away * std::cos(yaw),
                                   robot.translation().y() + away * std::sin(yaw),
                                   FloorUnder(annotations, robot.translation()) + kOver);
    const Pose pose = Pose::FromRpy(on_floor, {0, 0, yaw + kPi + noise});
    if (place.Has(pose)) return at(pose);
  }
  throw ArgumentError(fmt::format(
      "object '{}': no free place for {} ({:.2f} m wide, {:.2f} m deep) on {} or on the floor in "
      "front of the robot. Leave objects out, use a larger support, or name an object of the scene",
      name, kind, width, depth,
      Counted(static_cast<int64_t>(annotations.supports.size()), "support")));
}

std::optional<Refusal> StandInFront(Scene& scene, const Robot& robot, int root,
                                    const JointOpening& opening, double share,
                                    const StanceCheck& check, Rng& rng) {
  const std::vector<Eigen::Vector3d> way = WayOfHandle(scene, opening, share);
  if (way.empty()) return check();
  const Eigen::Vector3d hand = way[way.size() / 2];
  const Pose base = robot.base().pose();
  const double reach = robot.reach();
  Eigen::Vector3d middle(scene.data()->xpos + 3 * root);
  double distance = (base.translation() - middle).head<2>().norm();
  // A door of a house is far from the root of the house, or the robot was put beside something else:
  // nothing on the circle around the root is near to the handle.
  const bool is_elsewhere =
      std::abs(distance - (hand - middle).head<2>().norm()) > kFarthestShare * reach;
  if (is_elsewhere) middle = hand, distance = kStandShare * reach;
  const Eigen::Vector3d from = base.translation() - middle;
  const std::optional<Eigen::Vector3d> front = FrontOf(scene, opening);
  const double first = front ? YawOf(*front) : YawOf(from);
  // What the robot looks to, and how far it looks past that.
  const double facing = is_elsewhere ? 0 : YawOf(base.rotation().col(0)) - YawOf(-from);
  const auto is_in_reach = [&] {
    const Eigen::Vector3d shoulder = robot.base_in_world().translation();
    return std::ranges::all_of(way, [&](const Eigen::Vector3d& point) {
      const Eigen::Vector3d to = point - shoulder;
      return to.head<2>().norm() >= kNearestShare * reach && to.norm() <= kFarthestShare * reach;
    });
  };
  std::optional<Refusal> refusal;
  int checks = 0;
  for (int i = 0; i < kStandTries && checks < kStandChecks; ++i) {
    const double wider = static_cast<double>(i) / kStandTries;
    const double aside = std::lerp(front || i > 0 ? kMostOffFront : 0, kPi, wider * wider);
    const double yaw = first + rng.Uniform(-aside, aside);
    const double away = distance + wider * rng.Uniform(-kNearer, kFarther);
    if (away <= 0) continue;
    Eigen::Vector3d at = middle + away * Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0);
    at.z() = base.translation().z();
    const double turn = YawOf(hand - at) + facing - YawOf(base.rotation().col(0));
    PutBase(robot, Pose(at) * Pose::FromRpy({0, 0, 0}, {0, 0, turn}) *
                       Pose(Eigen::Vector3d::Zero(), base.quaternion()));
    scene.Forward();
    if (!is_in_reach()) {
      if (!refusal)
        refusal = Refusal{Refusal::kNoReachableBasePose,
                          "the way of the handle is out of reach, or too near to the base"};
      continue;
    }
    if (auto blocked = ValidateBaseClearance(scene, robot, kStandClearance)) {
      if (checks == 0) refusal = std::move(blocked);
      continue;
    }
    if (auto blocked = ValidateMovedJoint(scene, robot, opening, share, kStandClearance)) {
      if (checks == 0) refusal = std::move(blocked);
      continue;
    }
    ++checks;
    refusal = check();
    if (!refusal || refusal->holds_everywhere) return refusal;
  }
  return refusal;
}

}  // namespace robocell::internal
