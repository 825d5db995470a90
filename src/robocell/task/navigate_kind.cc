#include "robocell/task/navigate_kind.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "robocell/base/units.h"
#include "robocell/spec/robot_config.h"
#include "robocell/task/base_stances.h"
#include "robocell/task/door_swings.h"
#include "robocell/task/navigate_task.h"

namespace robocell::internal {
namespace {

constexpr int kFloorDraws = 64;  // places of a base, of which one is taken

class NavigateKind final : public TaskKindOf<NavigateTaskConfig, NavigateTask> {
 public:
  bool is_built_in() const override { return true; }
  std::shared_ptr<TaskSampler> MakeSampler(const RunConfig& run) const override {
    return std::make_shared<FloorStartSampler>(run);
  }
  void ValidateRun(const RunConfig& run, Problems& problems) const override {
    const Problems::Scope scope(problems, "robot");
    ValidateDrivenPlanarBase(run.robot.config, problems);
  }
  std::vector<StartContents> PossibleContents(const RunConfig& /*run*/, int /*scene*/,
                                              const SceneSpec& /*base*/,
                                              const Task::KnownScene& /*known*/) const override {
    return {StartContents()};
  }
};

}  // namespace

void ValidateDrivenPlanarBase(const RobotConfig& robot, Problems& problems) {
  if (robot.base.kind != BaseKind::kPlanar) {
    problems.AddAt(
        "base.kind",
        "this task drives a base that moves in a plane, by joints x, y and yaw and their "
        "actuators. Set `base: {kind: planar}`, or take the built-in robot `rc7_mobile`");
    return;
  }
  const auto drives = [](const auto& entry) {
    return entry.second->kind == MoveGroupKind::kBase && !entry.second->actuators.empty();
  };
  if (std::ranges::any_of(robot.move_groups.entries(), drives)) return;
  problems.AddAt("move_groups",
                 "has no group of kind `base` with the actuators that drive the planar base: "
                 "`base: {kind: base, actuators: [drive_x, drive_y, drive_yaw]}`");
}

SampleResult FloorStartSampler::Sample(const SampleRequest& request, Rng& rng) {
  scene_ = request.scene;
  return StartSampler::Sample(request, rng);
}

std::optional<Pose> FloorStartSampler::ProposeBasePose(const Robot& robot,
                                                       const Support& /*support*/,
                                                       const Pose& /*target*/,
                                                       const BasePlacement& /*placement*/,
                                                       Rng& rng) {
  const std::shared_ptr<const SceneAnnotations> known = AnnotationsOf(scene_);
  double floor = 0;  // square metres
  for (const FloorArea& area : known->free_floor) floor += area.half_x * area.half_y;
  if (floor <= 0) return std::nullopt;
  const double height = robot.base().pose().translation().z();
  std::vector<Pose> bases;
  for (int draw = 0; draw < kFloorDraws; ++draw) {
    double at = rng.Uniform(0, floor);
    size_t chosen = 0;
    while (chosen + 1 < known->free_floor.size() &&
           at > known->free_floor[chosen].half_x * known->free_floor[chosen].half_y) {
      at -= known->free_floor[chosen].half_x * known->free_floor[chosen].half_y;
      ++chosen;
    }
    const FloorArea& area = known->free_floor[chosen];
    const double x = rng.Uniform(-area.half_x, area.half_x);
    const double y = rng.Uniform(-area.half_y, area.half_y);
    const Eigen::Vector3d on = area.frame_to_world * Eigen::Vector3d(x, y, 0);
    bases.push_back(Pose::FromRpy({on.x(), on.y(), height}, {0, 0, rng.Uniform(-kPi, kPi)}));
  }
  const Scene scene = robot.scene();
  scene.SyncPoses();
  const std::vector<Articulation> doors =
      run().start.base_blocks_doors ? std::vector<Articulation>() : DoorsOf(*known, scene);
  const double clearance = std::max(run().start.base_clearance, kWayClearance);
  const std::vector<bool> free = BaseStances(robot, clearance, doors).AreFree(bases);
  for (size_t i = 0; i < bases.size(); ++i)
    if (free[i]) return bases[i];
  return std::nullopt;
}

std::shared_ptr<const TaskKind> MakeNavigateKind() { return std::make_shared<NavigateKind>(); }

}  // namespace robocell::internal
