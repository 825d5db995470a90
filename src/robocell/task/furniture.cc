#include "robocell/task/furniture.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "robocell/base/units.h"
#include "robocell/mujoco/names.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/handle_motion.h"

namespace robocell::internal {
namespace {

constexpr double kFacingNoise = 0.25;     // rad
constexpr double kFromRobot = 0.45;       // m, of furniture on the floor
constexpr double kSideways = 0.1;         // m, largest offset along the edge
constexpr double kDepthShare = 0.6;       // of the radius of furniture, which is wider than deep
constexpr double kToEdge = 0.03;          // m from its front to the edge of the support
constexpr double kOver = 0.0005;          // m above the support
constexpr double kMostOffFront = 0.6;     // rad between the front and the robot
constexpr double kStandClearance = 0.01;  // m
constexpr int kStandTries = 24;

// Returns a free pose at random around an axis.
Pose TurnedAbout(const Eigen::Vector3d& middle, const Pose& pose, double yaw) {
  const Pose turn = Pose::FromRpy({0, 0, 0}, {0, 0, yaw});
  return Pose(middle) * turn * Pose(-middle) * pose;
}

}  // namespace

bool IsFurniture(const std::string& kind) {
  const std::vector<std::string> plain = ObjectKinds();
  if (std::ranges::find(plain, kind) != plain.end()) return false;
  static std::mutex mutex;
  static std::map<std::string, bool> known;
  const std::lock_guard lock(mutex);
  if (const auto found = known.find(kind); found != known.end()) return found->second;
  SceneSpec spec{
      .name = "model " + kind, .timestep = 0.002, .add_floor = false, .add_skybox = false};
  spec.objects.push_back({.name = "object", .mjcf_path = kind, .pos = Vec3{}, .fixed = true});
  const Scene scene = Scene::Build(spec);
  bool moves = false;
  for (int j = 0; j < scene.model()->njnt; ++j) {
    const int type = scene.model()->jnt_type[j];
    moves = moves || type == mjJNT_HINGE || type == mjJNT_SLIDE;
  }
  return known[kind] = moves;
}

SceneObject PutFurniture(const SceneSpec& spec, const SceneAnnotations& annotations,
                         const std::string& name, const std::string& kind, Rng& rng) {
  SceneObject object{.name = name, .mjcf_path = kind, .pos = Vec3{}, .fixed = true};
  ObjectSizes sizes;
  const double radius = sizes.Of({.name = name, .mjcf_path = kind}).radius;
  const double noise = rng.Uniform(-kFacingNoise, kFacingNoise);
  const double sideways = rng.Uniform(-kSideways, kSideways);
  const bool opposite = rng.Uniform() < 0.5;
  const auto fits = [&](const SupportFace& support) {
    return std::max(support.face.half_x, support.face.half_y) > radius &&
           std::min(support.face.half_x, support.face.half_y) > radius / 1.5;
  };
  const auto support = std::ranges::find_if(annotations.supports, fits);
  Pose pose;
  if (support != annotations.supports.end()) {
    const Support& face = support->face;
    const bool across = face.half_y < face.half_x;  // its front is over the longer edge
    const double yaw = (across ? kPi / 2 : 0) + (opposite ? kPi : 0);
    const double forward =
        std::max(0.0, std::min(face.half_x, face.half_y) - kDepthShare * radius - kToEdge);
    const Pose front = Pose::FromRpy({0, 0, kOver}, {0, 0, yaw});
    pose = face.frame_to_world * front * Pose::FromRpy({forward, sideways, 0}, {0, 0, noise});
  } else if (!spec.robots.empty()) {
    const Vec3& at = spec.robots[0].pos;
    const double yaw = std::atan2(-at[1], -at[0]) * (std::hypot(at[0], at[1]) > kFromRobot);
    pose = Pose::FromRpy(
        {at[0] + kFromRobot * std::cos(yaw), at[1] + kFromRobot * std::sin(yaw), kOver},
        {0, 0, yaw + kPi});
  } else {
    pose = Pose::FromRpy({0, 0, kOver}, {0, 0, noise});
  }
  object.pos = ToVec3(pose.translation());
  object.quat = pose.quaternion();
  return object;
}

std::optional<Refusal> StandInFront(Scene& scene, const Robot& robot, const std::string& object,
                                    const JointOpening& opening, Rng& rng) {
  const std::optional<Eigen::Vector3d> front = FrontOf(scene, opening);
  if (!front) return std::nullopt;
  const int body = object.empty() ? opening.body_id()
                                  : FindId(scene.model(), mjOBJ_BODY,
                                           scene.compiled()->object(object).root_body);
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
