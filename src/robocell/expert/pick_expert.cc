#include "robocell/expert/pick_expert.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"
#include "robocell/expert/any_arm.h"
#include "robocell/expert/drive_then.h"
#include "robocell/expert/pick_and_place_planner.h"
#include "robocell/expert/pick_planner.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/acting_arms.h"
#include "robocell/robot/unused_groups.h"
#include "robocell/robot/validate_config.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/spec/problems.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/grasp_candidates.h"
#include "robocell/task/grasp_motion.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/task/run_arms.h"
#include "robocell/task/work_stances.h"

namespace robocell::internal {
namespace {

// Turns an exception of a check into a problem of the robot.
template <class F>
void AsProblem(Problems& problems, const F& check) {
  try {
    check();
  } catch (const IoError&) {
    throw;  // an error of the disk, not of the spec
  } catch (const Error& error) {
    problems.Add(error.what());
  }
}

// Each episode puts the robot at another height, or beside another object, and the scripted expert
// knows no other starts. Robots that drive go there by themselves.
void ValidateBaseMoves(const RobotConfig& config, Problems& problems) {
  if (DrivesItself(config)) return;
  const auto why = [](BaseKind kind) {
    switch (kind) {
      case BaseKind::kFixed:
        return "a fixed base cannot be moved";
      case BaseKind::kPlanar:
        return "no actuators drive this planar base";
      case BaseKind::kFree:
        return "a free base falls from there";
      case BaseKind::kMocap:
      case BaseKind::kDriven:
        break;
    }
    return "";
  };
  const std::string no = why(config.base.kind);
  if (no.empty()) return;
  problems.AddAt(
      "base.kind",
      fmt::format(
          "pick tasks must move the base to reach the object, and {}. Set `base: {{kind: mocap}}`",
          no));
}

// Checks the needs of both planners: an arm, and a gripper that can be measured.
void RequirePickParts(const Robot& robot, const SimOptions& options, double timestep) {
  robot.arm();
  if (!GripperShape::Supports(robot.gripper())) {
    throw SpecError(
        "the scripted expert needs a gripper with fingers that actuators move, or suction cups; "
        "use "
        "your own expert for this one");
  }
  robot.gripper().inter_finger_dist_range();  // measured for the records, which may fail
  GripperShape::Of(robot.config(), options, timestep);
}

// Checks what can be known of a pick run before its first episode.
class PickRunValidator {
 public:
  PickRunValidator(const RunConfig& run, const Scene& scene, Robot& robot, Problems& problems,
                   Problems& doubts)
      : run_(run), scene_(scene), robot_(robot), problems_(problems), doubts_(doubts) {}

  void Run() {
    WarnOfUnusedGroups();
    {
      Problems::Scope scope(problems_, "robot");
      if (!ValidatePickRobot(robot_, run_.options, scene_.timestep(), problems_)) return;
    }
    const std::optional<PickRun> pick = PickRunOf(run_.task);
    if (!pick) return;
    if (!DrivesItself(robot_.config()))
      ValidateLift(pick->lift_height, BaseRangeOf(run_.start, {}), robot_, problems_);
    Problems::Scope scope(problems_, "task");
    AsProblem(problems_, [&] { ValidateGraspable(*pick); });
  }

 private:
  // Warns of further grippers of an arm.
  void WarnOfUnusedGroups() {
    if (ArmNames(robot_.config()).size() > 1) return;  // `arm` says which ones act
    const std::string unused = internal::DescribeUnusedGroups(robot_);
    if (unused.empty()) return;
    doubts_.AddAt("robot",
                  fmt::format("has several grippers, and pick tasks act with one: {}", unused));
  }

  // Warns of kinds of objects that the gripper cannot grasp; drawn sizes may differ.
  void ValidateGraspable(const PickRun& pick) {
    Scene scene = scene_;
    const auto shape = GripperShape::Of(robot_.config(), run_.options, scene.timestep());
    scene.Forward();
    const bool is_named = !pick.object.empty();
    std::vector<std::string> kinds = KindsToDraw(pick.objects);
    if (is_named) kinds = {pick.object};
    for (const std::string& kind : kinds) {
      const auto& objects = scene.compiled()->objects();
      const auto object = std::ranges::find(objects, kind, &ObjectRecord::name);
      if (object == objects.end()) continue;  // the task reports it
      const int body = FindId(scene.model(), mjOBJ_BODY, object->root_body);
      if (!FindGrasps(scene.model(), scene.data(), body, *shape, robot_.tcp_in_world()).empty())
        continue;
      doubts_.AddAt(
          is_named ? "task.object" : "task.objects",
          fmt::format("gripper '{}' cannot hold '{}' ({}): such starts are refused. {}, or "
                      "take a gripper that fits",
                      robot_.gripper().name(), kind,
                      SizesForGrasp(scene.model(), scene.data(), body, *shape),
                      is_named ? "Name another object" : "Leave the kind out of task.objects"));
    }
  }

  const RunConfig& run_;
  const Scene& scene_;
  Robot& robot_;
  Problems& problems_;
  Problems& doubts_;
};

template <class Planner>
class KindOfPicker final : public ExpertKind {
 public:
  std::shared_ptr<Expert> Make(const RunConfig& run, const EpisodeStart& start) const override {
    return WithDrive(run, start, [run, start] { return MakePicker(run, start); });
  }
  static std::shared_ptr<Expert> MakePicker(const RunConfig& run, const EpisodeStart& start) {
    const std::vector<std::string> arms = ArmsOfRun(run, start.scene);
    if (arms.size() == 1) return std::make_shared<Planner>(WithArm(run, arms.front()), start);
    std::vector<AnyArm::Candidate> candidates;
    for (const std::string& arm : arms)
      candidates.push_back({arm, std::make_shared<Planner>(WithArm(run, arm), start)});
    return std::make_shared<AnyArm>(std::move(candidates), start.target_object);
  }
  bool is_built_in() const override { return true; }
  void Validate(const RunConfig& run, const Scene& scene, Robot& /*robot*/, Problems& problems,
                Problems& doubts) const override {
    for (const std::string& arm : ArmsOfRun(run, scene)) {
      Robot acting = Robot::Of(scene, arm);
      const size_t before = problems.list().size() + doubts.list().size();
      PickRunValidator(run, scene, acting, problems, doubts).Run();
      if (problems.list().size() + doubts.list().size() > before) return;  // once is enough
    }
  }
  void ValidateRobot(const Robot& robot, Problems& problems) const override {
    ValidatePickRobot(robot, robot.scene().compiled()->spec().options, robot.scene().timestep(),
                      problems);
  }
};

// Formats a length rounded down to the millimetre, so that a field with the printed value is
// accepted.
std::string AtMost(double metres) {
  return fmt::format("{:.3f}", std::floor(1000 * metres) / 1000);
}

}  // namespace

std::shared_ptr<const ExpertKind> MakePickExpert() {
  return std::make_shared<KindOfPicker<PickPlanner>>();
}
std::shared_ptr<const ExpertKind> MakePickAndPlaceExpert() {
  return std::make_shared<KindOfPicker<PickAndPlacePlanner>>();
}

bool ValidatePickRobot(const Robot& robot, const SimOptions& options, double timestep,
                       Problems& problems) {
  const size_t before = problems.list().size();
  ValidateBaseMoves(robot.config(), problems);
  internal::ValidateTakesJointPositions(robot, problems);
  AsProblem(problems, [&] { RequirePickParts(robot, options, timestep); });
  return problems.list().size() == before;
}

void ValidateLift(double lift_height, const BaseRange& base, const Robot& robot,
                  Problems& problems) {
  // The offset from the bottom of the robot's pedestal, which is what is placed, to its base frame.
  const Eigen::Vector3d up = (robot.base().pose().inverse() * robot.base_in_world()).translation();
  const double high = base.height_offset + base.height_noise[1] + up.z();
  // The arm that stands highest has the least to lift, and the nearest one the farthest to reach.
  const double nearest = std::max(base.distance[0] - up.head<2>().norm(), 0.0);
  const double lift = GraspMotionsToLift(lift_height).lift;
  if (nearest >= robot.reach()) return;
  const double top = high + std::sqrt(robot.reach() * robot.reach() - nearest * nearest);
  if (lift <= top) return;
  problems.AddAt(
      "task.lift_height",
      fmt::format("{:g} m is more than the arm can lift: it reaches {:.2f} m from its base frame, "
                  "at most {:.2f} m above the object, and lifts {:.2f} m more than required; give "
                  "at most {}",
                  lift_height, robot.reach(), std::max(top, 0.0), lift - lift_height,
                  AtMost(std::max(top - (lift - lift_height), 0.0))));
}

}  // namespace robocell::internal
