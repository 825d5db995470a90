#include "robocell/task/navigate_kind.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "robocell/spec/robot_config.h"
#include "robocell/task/base_stances.h"
#include "robocell/task/door_swings.h"
#include "robocell/task/navigate_task.h"
#include "robocell/task/work_stances.h"

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
        "this task drives a base that moves in a plane, by joints x, y and yaw or on wheels. Set "
        "`base: {kind: planar}`, or take one of the built-in robots `rc7_mobile` and `cart`");
    return;
  }
  if (DrivesItself(robot)) return;
  problems.AddAt(
      "move_groups",
      "has no group of kind `base` with the actuators that drive the planar base: `base: "
      "{kind: base, actuators: [drive_x, drive_y, drive_yaw]}`, or `base: {kind: base, "
      "joints: [left_wheel, right_wheel], actuators: [left_motor, right_motor]}`");
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
  const std::vector<Pose> bases =
      DrawOnFloor(known->free_floor, robot.base().pose().translation().z(), kFloorDraws, rng);
  if (bases.empty()) return std::nullopt;
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
