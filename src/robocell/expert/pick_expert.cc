#include "robocell/expert/pick_expert.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/expert/pick_and_place_planner.h"
#include "robocell/expert/pick_planner.h"
#include "robocell/expert/validate_reach.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/unused_groups.h"
#include "robocell/robot/validate_config.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/spec/pick_task_config.h"
#include "robocell/spec/problems.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/grasp_candidates.h"

namespace robocell {
namespace {

// What a check throws becomes a problem of the robot.
template <class F>
void AsProblem(Problems& problems, const F& check) {
  try {
    check();
  } catch (const IoError&) {
    throw;  // of the disk, not of the spec
  } catch (const Error& error) {
    problems.Add(error.what());
  }
}

// Each episode puts the robot at another height; the scripted expert knows no other starts.
void ValidateBaseMoves(const RobotConfig& config, Problems& problems) {
  const auto why = [](BaseKind kind) {
    switch (kind) {
      case BaseKind::kFixed:
        return "a fixed base cannot be moved";
      case BaseKind::kPlanar:
        return "a planar base moves in its plane only";
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
  problems.AddAt("base.kind", fmt::format("pick tasks put the robot where the object is in "
                                          "reach, at heights of their own, and {}; give it "
                                          "`base: {{kind: mocap}}`",
                                          no));
}

// Both planners: an arm, and a gripper that can be measured.
void RequirePickParts(const Robot& robot, const SimOptions& options, double timestep) {
  robot.arm();
  if (!GripperShape::Supports(robot.gripper())) {
    throw SpecError(
        "the scripted expert needs a gripper with two fingers that actuators move; bring an "
        "expert of your own for this one");
  }
  robot.gripper().inter_finger_dist_range();  // measured for the records, which may fail
  GripperShape::Of(robot.config(), options, timestep);
}

// What can be said of a pick run before its first episode.
class PickRunValidator {
 public:
  PickRunValidator(const RunConfig& run, const Scene& scene, Robot& robot, Problems& problems,
                   std::vector<std::string>& warnings)
      : run_(run), scene_(scene), robot_(robot), problems_(problems), warnings_(warnings) {}

  void Run() {
    WarnOfUnusedGroups();
    {
      Problems::Scope scope(problems_, "robot");
      if (!ValidatePickRobot(robot_, run_.options, scene_.timestep(), problems_)) return;
    }
    const std::optional<PickRun> pick = PickRunOf(run_.task);
    if (!pick) return;
    ValidateReach(*pick, BaseRangeOf(run_.start, {}), robot_, problems_);
    Problems::Scope scope(problems_, "task");
    AsProblem(problems_, [&] { ValidateGraspable(pick->objects); });
  }

 private:
  // The expert acts with one arm.
  void WarnOfUnusedGroups() {
    const std::string unused = TellUnusedGroups(robot_);
    if (unused.empty()) return;
    Problems doubt(run_.locations);
    doubt.AddAt("robot", fmt::format("has several arms or grippers, and pick tasks act with one of "
                                     "each, the first arm of `move_groups` and its gripper: {}",
                                     unused));
    warnings_.push_back(LinesOf(doubt).front());
  }

  // Kinds of objects that the gripper cannot take; sizes that are drawn may differ.
  void ValidateGraspable(const NameList& objects) {
    Scene scene = scene_;
    const auto shape = GripperShape::Of(robot_.config(), run_.options, scene.timestep());
    scene.Forward();
    for (const std::string& kind : objects.empty() ? ObjectKinds() : objects.names) {
      const ObjectRecord& object = scene.compiled()->object(kind);
      const int body = FindId(scene.model(), mjOBJ_BODY, object.root_body);
      if (!FindGrasps(scene.model(), scene.data(), body, *shape, robot_.tcp_in_world()).empty())
        continue;
      Problems doubt(run_.locations);
      doubt.AddAt("task.objects",
                  fmt::format("gripper '{}' cannot hold '{}' ({}): such starts are refused. Leave "
                              "the kind out of task.objects, or take a gripper that fits",
                              robot_.gripper().name(), kind,
                              SizesForGrasp(scene.model(), scene.data(), body, *shape)));
      warnings_.push_back(LinesOf(doubt).front());
    }
  }

  const RunConfig& run_;
  const Scene& scene_;
  Robot& robot_;
  Problems& problems_;
  std::vector<std::string>& warnings_;
};

template <class Planner>
class KindOfPicker final : public ExpertKind {
 public:
  std::shared_ptr<Expert> Make(const RunConfig& run, const EpisodeStart& start) const override {
    return std::make_shared<Planner>(run, start);
  }
  void Validate(const RunConfig& run, const Scene& scene, Robot& robot, Problems& problems,
                std::vector<std::string>& warnings) const override {
    PickRunValidator(run, scene, robot, problems, warnings).Run();
  }
};

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
  ValidateTakesJointPositions(robot, problems);
  AsProblem(problems, [&] { RequirePickParts(robot, options, timestep); });
  return problems.list().size() == before;
}

std::vector<std::string> WhyNoPicks(const Robot& robot) {
  Problems problems(robot.config().locations);
  ValidatePickRobot(robot, robot.scene().compiled()->spec().options, robot.scene().timestep(),
                    problems);
  return LinesOf(problems);
}

}  // namespace robocell
