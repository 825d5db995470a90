#include "robocell/task/two_arm_tasks.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <Eigen/Core>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/spec/validate.h"
#include "robocell/spec/yaml.h"
#include "robocell/spec/yaml_reader.h"
#include "robocell/spec/yaml_writer.h"
#include "robocell/task/colours.h"
#include "robocell/task/drawn_objects.h"
#include "robocell/task/reachable_grasps.h"
#include "robocell/task/two_arm_motion.h"

namespace robocell::internal {
namespace {

constexpr const char* kCarryRegion = "region";
// Half sizes, m: a few, because the process remembers the grasps of each (remembered_grasps.h).
constexpr double kBarHalf = 0.1;
constexpr std::array kBarHalfWidths = {0.012, 0.015, 0.018};
constexpr std::array kCaseHalfLengths = {0.15, 0.17};
constexpr std::array kCaseHalfWidths = {0.024, 0.03};
const Vec3 kParked = {10, 0, 0};       // where the region waits until it is drawn
constexpr double kMostYaw = 0.25;      // rad from facing the robot
constexpr int kCarryRegionDraws = 16;  // places of the region that are tried
constexpr double kCarriedLift = 0.05;  // m that the arms must be able to lift the object

// Returns one of the kinds that the task names.
std::string DrawKind(const NameList& objects, bool once, const StartTurn& turn, Rng& rng) {
  const std::vector<std::string> kinds = KindsToDraw(objects);
  return once ? kinds[rng.UniformInt(kinds.size())] : turn.Choose(kinds);
}

// Returns the kind of an added object by its model or shape.
std::string KindOfAdded(const Scene& scene, const std::string& name) {
  for (const SceneObject& object : scene.spec().objects) {
    if (object.name != name) continue;
    return object.shape ? std::string(ToString(*object.shape))
                        : std::filesystem::path(object.mjcf_path).stem().string();
  }
  return name;
}

// Returns the height of the lowest point of a body.
double BottomOf(const Scene& scene, int body) {
  return BodyExtent(scene.model(), scene.data(), body, Eigen::Vector3d::UnitZ()).lower;
}

}  // namespace

HandoverTask::HandoverTask(const HandoverTaskConfig& fields)
    : RelationTask(fields.hold_seconds), task_(fields) {
  RequireValid(task_, fmt::format("task '{}'", fields.kKind));
}

void HandoverTask::AddObjects(SceneSpec& spec, Rng& rng) {
  if (!task_.objects.empty()) {
    Add(spec, kTarget, DrawKind(task_.objects, is_prepared_once(), turn(), rng), rng);
    return;
  }
  const double half = kBarHalfWidths[rng.UniformInt(kBarHalfWidths.size())];
  spec.objects.push_back({.name = kTarget,
                          .shape = Shape::kBox,
                          .size = Vec3{kBarHalf, half, half},
                          .rgba = kNamedColours[rng.UniformInt(kNamedColours.size())].rgba,
                          .mass = 0.1,
                          .friction = Vec3{1, 0.02, 0.001},
                          .condim = Condim::kTorsional});
  Name(kTarget, "bar");
}

void HandoverTask::Found(const Scene& scene, const TaskSetting& /*setting*/) {
  scene.compiled()->object(kTarget);
  Name(kTarget, task_.objects.empty() ? "bar" : KindOfAdded(scene, kTarget));
}

std::vector<std::string> HandoverTask::StatedGoal() const {
  return {fmt::format("{} handed_over", kTarget)};
}

CarryTask::CarryTask(const CarryTaskConfig& fields) : RelationTask(0.3), task_(fields) {
  RequireValid(task_, fmt::format("task '{}'", fields.kKind));
  if (task_.distance[0] > task_.distance[1]) {
    throw SpecError(
        fmt::format("task 'carry': distance: the smallest, {:g} m, is more than the largest, "
                    "{:g} m",
                    task_.distance[0], task_.distance[1]));
  }
}

void CarryTask::AddObjects(SceneSpec& spec, Rng& rng) {
  if (task_.objects.empty()) {
    spec.objects.push_back(
        {.name = kTarget,
         .shape = Shape::kBox,
         .size = Vec3{kCaseHalfLengths[rng.UniformInt(kCaseHalfLengths.size())],
                      kCaseHalfWidths[rng.UniformInt(kCaseHalfWidths.size())], 0.03},
         .rgba = kNamedColours[rng.UniformInt(kNamedColours.size())].rgba,
         .mass = 0.4,
         .friction = Vec3{1, 0.02, 0.001},
         .condim = Condim::kTorsional});
    Name(kTarget, "case");
  } else {
    Add(spec, kTarget, DrawKind(task_.objects, is_prepared_once(), turn(), rng), rng);
  }
  spec.objects.push_back({.name = kCarryRegion, .mjcf_path = "region", .pos = kParked});
  Name(kCarryRegion, kCarryRegion);
}

void CarryTask::Found(const Scene& scene, const TaskSetting& /*setting*/) {
  for (const char* name : {kTarget, kCarryRegion}) scene.compiled()->object(name);
  Name(kTarget, task_.objects.empty() ? "case" : KindOfAdded(scene, kTarget));
  Name(kCarryRegion, kCarryRegion);
}

std::vector<std::string> CarryTask::StatedGoal() const {
  return {fmt::format("{} carried {} {}", kTarget, kCarryRegion, task_.most_tilt)};
}

std::string CarryTask::WordFor(const std::string& name) const {
  return name == kCarryRegion ? "marked region" : "";
}

// The object lies across the robot's view, so that each arm has an end of it; the region is beside it
// on what it lies on.
std::optional<Refusal> CarryTask::Draw(Scene& scene, Rng& rng) {
  const ObjectRecord& target = scene.compiled()->object(kTarget);
  const mjModel* m = scene.model();
  const int body = FindId(m, mjOBJ_BODY, target.root_body);
  Pose at = scene.body_pose(target.root_body);
  Eigen::Vector3d from = scene.root_frame_to_world().translation();
  if (!robots().empty()) from = robots().front().base_in_world().translation();
  const Eigen::Vector2d out = (at.translation() - from).head<2>();
  const double facing = std::atan2(out.y(), out.x());
  double longest = 0, along = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d direction = at.rotation().col(axis);
    if (std::abs(direction.z()) > 0.7) continue;
    const Interval extent = BodyExtent(m, scene.data(), body, direction);
    if (extent.upper - extent.lower <= longest) continue;
    longest = extent.upper - extent.lower;
    along = std::atan2(direction.y(), direction.x());
  }
  const double turn = facing + kPi / 2 + rng.Uniform(-kMostYaw, kMostYaw) - along;
  at = Pose(at.translation()) * Pose::FromRpy({0, 0, 0}, {0, 0, turn}) *
       Pose(Eigen::Vector3d::Zero(), at.quaternion());
  scene.SetBodyPose(target.root_body, at);
  scene.Forward();
  const double low = BottomOf(scene, body);
  std::vector<int> others;
  for (int geom = 0; geom < m->ngeom; ++geom) {
    if (IsCollisionGeom(m, geom) && !IsInSubtree(m, m->geom_bodyid[geom], body))
      others.push_back(geom);
  }
  // What carries the object has to carry all of it there too.
  const auto is_carried = [&](const Eigen::Vector3d& middle) {
    for (const double share : {-0.9, 0.0, 0.9}) {
      const double angle = turn + along;
      const Eigen::Vector3d above =
          middle + share * longest / 2 * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
      const RayHit hit = CastRay(m, scene.data(), others, {above.x(), above.y(), low + 0.02},
                                 -Eigen::Vector3d::UnitZ());
      if (!(hit.distance > 0.01 && hit.distance < 0.03)) return false;
    }
    return true;
  };
  for (int draw = 0; draw < kCarryRegionDraws; ++draw) {
    const double angle = rng.Uniform(-kPi, kPi);
    const double distance = rng.Uniform(task_.distance[0], task_.distance[1]);
    const Eigen::Vector3d middle =
        at.translation() + distance * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
    if (!is_carried(middle)) continue;
    scene.SetBodyPose(scene.compiled()->object(kCarryRegion).root_body,
                      Pose(Eigen::Vector3d(middle.x(), middle.y(), low + 0.001)));
    return std::nullopt;
  }
  return Refusal{.reason = "no free place for the region",
                 .detail = "around the object its support ends, or something is in the way"};
}

// Both arms must reach an end of the object, with a grasp that they reach over the region, too.
std::optional<Refusal> CarryTask::CheckStart(const Scene& scene) {
  if (robots().size() < 2) return std::nullopt;  // binding the goal has found two arms
  const std::string& body = scene.compiled()->object(kTarget).root_body;
  const int id = FindId(scene.model(), mjOBJ_BODY, body);
  const Pose object = scene.body_pose(body);
  const Eigen::Vector3d com(scene.data()->subtree_com + 3 * id);
  Eigen::Vector3d shift =
      scene.body_pose(scene.compiled()->object(kCarryRegion).root_body).translation() - com;
  shift.z() = 0;
  std::vector<Robot> nearest = robots();
  std::ranges::stable_sort(nearest, {}, [&](const Robot& arm) {
    return (arm.tcp_in_world().translation() - com).norm();
  });
  const std::array<Robot, 2> arms = {nearest[0], nearest[1]};
  const std::vector<PairGrasp> pairs = PairGrasps(scene, arms, body);
  if (pairs.empty())
    return Refusal{.reason = "no grasp for two hands",
                   .detail = "the object has no two ends that the grippers can hold from above",
                   .holds_everywhere = true};
  for (size_t arm = 0; arm < 2; ++arm) {
    GraspSet set{.robot = arms[arm].name(), .body = body, .grasps = {}};
    std::set<size_t> known;
    for (const PairGrasp& pair : pairs)
      if (known.insert(pair.number[arm]).second) set.grasps.push_back(pair.of[arm]);
    const ReachReport reach = FindReachableGrasps(
        arms[arm], set, {.most = static_cast<int>(set.grasps.size()), .lift = kCarriedLift});
    if (reach.found.empty())
      return Refusal{.reason = Refusal::kNoReachableBasePose,
                     .detail = "grasps: " + reach.Reasons()};
    const Pose world_in_base = arms[arm].base_in_world().inverse();
    const bool reaches_region = std::ranges::any_of(reach.found, [&](const ReachableGrasp& found) {
      const Pose there = Pose(object.translation() + shift, object.quaternion());
      return arms[arm]
          .Ik(world_in_base * there * found.grasp.tcp_in_body, {.seed = found.way.back()})
          .success;
    });
    if (!reaches_region)
      return Refusal{.reason = "the region is out of reach",
                     .detail = fmt::format("none of {} grasps at one end of the object is in reach "
                                           "there",
                                           reach.found.size())};
  }
  return std::nullopt;
}

}  // namespace robocell::internal

namespace robocell {

// The registry reads and writes the fields by name; these are for single structs.
template <>
std::string ToYaml(const HandoverTaskConfig& fields) {
  return internal::yaml::TextOf(fields);
}
template <>
HandoverTaskConfig FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<HandoverTaskConfig>(text);
}
template <>
std::string ToYaml(const CarryTaskConfig& fields) {
  return internal::yaml::TextOf(fields);
}
template <>
CarryTaskConfig FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<CarryTaskConfig>(text);
}

}  // namespace robocell
