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
#include "robocell/task/handle_motion.h"

namespace robocell::internal {
namespace {

constexpr double kFacingNoise = 0.25;     // rad
constexpr double kFromRobot = 0.45;       // m, of furniture on the floor
constexpr double kFloorStep = 0.04;       // m by which each try is farther away, without a robot
constexpr double kReachStep = 0.004;      // ... with one
constexpr double kSideways = 0.1;         // m, largest offset along the edge, if that is free
constexpr double kToEdge = 0.03;          // m from its front to the edge of the support
constexpr double kOver = 0.0005;          // m above the support
constexpr double kInFront = 0.12;         // m of free space
constexpr double kMostOffFront = 0.6;     // rad between the front and the robot
constexpr double kStandClearance = 0.01;  // m
constexpr int kStandTries = 24;
constexpr int kPlaceTries = 40;  // of each support, and of the floor

// What is known of a model.
struct Measured {
  bool moves = false;  // has hinges or slides
  Eigen::Vector3d lower = Eigen::Vector3d::Zero(),
                  upper = Eigen::Vector3d::Zero();  // as it is built
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
  Eigen::AlignedBox3d box;
  for (int g = 0; g < m->ngeom; ++g) {
    if (!IsCollisionGeom(m, g)) continue;
    Eigen::Vector3d low, high;
    for (int axis = 0; axis < 3; ++axis) {
      const Interval extent = GeomExtent(m, scene.data(), g, Eigen::Vector3d::Unit(axis));
      low[axis] = extent.lower, high[axis] = extent.upper;
    }
    if (low.allFinite() && high.allFinite()) box.extend(low).extend(high);
  }
  if (!box.isEmpty()) measured.lower = box.min(), measured.upper = box.max();
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

// Returns a pose turned about the vertical through a point.
Pose TurnedAbout(const Eigen::Vector3d& middle, const Pose& pose, double yaw) {
  const Pose turn = Pose::FromRpy({0, 0, 0}, {0, 0, yaw});
  return Pose(middle) * turn * Pose(-middle) * pose;
}

}  // namespace

bool IsFurniture(const std::string& kind) {
  const std::vector<std::string> plain = ObjectKinds();
  if (std::ranges::find(plain, kind) != plain.end()) return false;
  return Measure(kind).moves;
}

SceneObject PutFurniture(const SceneSpec& spec, const SceneAnnotations& annotations,
                         const std::string& name, const std::string& kind, Rng& rng) {
  SceneObject object{.name = name, .mjcf_path = kind, .pos = Vec3{}, .fixed = true};
  const Measured size = Measure(kind);
  FreePlace place(spec, object);
  const double width = size.upper.y() - size.lower.y(), depth = size.upper.x() - size.lower.x();
  const auto at = [&](const Pose& pose) {
    object.pos = ToVec3(pose.translation());
    object.quat = pose.quaternion();
    return object;
  };
  for (const SupportFace& support : annotations.supports) {
    const Support& face = support.face;
    const bool across = face.half_y < face.half_x;  // its front is over the longer edge
    const double edge = std::max(face.half_x, face.half_y);
    const double half = std::min(face.half_x, face.half_y);
    if (2 * edge < width || 2 * half < depth) continue;
    const double forward = std::max(0.0, half - size.upper.x() - kToEdge);
    for (int i = 0; i < kPlaceTries; ++i) {
      const double room = edge - width / 2;
      const double most = i < kPlaceTries / 4 ? std::min(kSideways, room) : room;
      const double sideways = rng.Uniform(-most, most);
      const double noise = rng.Uniform(-kFacingNoise, kFacingNoise);
      const double yaw = (across ? kPi / 2 : 0) + (rng.Uniform() < 0.5 ? kPi : 0);
      const Pose front = Pose::FromRpy({0, 0, kOver}, {0, 0, yaw});
      const Pose pose =
          face.frame_to_world * front * Pose::FromRpy({forward, sideways, 0}, {0, 0, noise});
      if (place.Has(pose)) return at(pose);
    }
  }
  Pose robot;
  if (!spec.robots.empty()) robot = RobotInWorld(spec, spec.robots[0]);
  const Eigen::Vector3d ahead = robot.rotation().col(0);
  for (int i = 0; i < kPlaceTries; ++i) {
    const double spread = i * kPi / kPlaceTries;
    const double noise = rng.Uniform(-kFacingNoise, kFacingNoise);
    const double away = spec.robots.empty() ? kFloorStep * i : kFromRobot + kReachStep * i;
    const double yaw = std::atan2(ahead.y(), ahead.x()) + rng.Uniform(-spread, spread);
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

std::optional<Refusal> StandInFront(Scene& scene, const Robot& robot, int body,
                                    const JointOpening& opening, Rng& rng) {
  const std::optional<Eigen::Vector3d> front = FrontOf(scene, opening);
  if (!front) return std::nullopt;
  const Eigen::Vector3d middle(scene.data()->xpos + 3 * body);
  const Pose base = robot.base().pose();
  const Eigen::Vector3d from = base.translation() - middle;
  const double turn = std::atan2(front->y(), front->x()) - std::atan2(from.y(), from.x());
  std::optional<Refusal> refusal;
  for (int i = 0; i < kStandTries; ++i) {
    const double aside = rng.Uniform(-kMostOffFront, kMostOffFront);
    robot.base().SetPose(TurnedAbout(middle, base, turn + aside));
    scene.Forward();
    refusal = ValidateBaseClearance(scene, robot, kStandClearance);
    if (!refusal) return std::nullopt;
  }
  return refusal;
}

}  // namespace robocell::internal
