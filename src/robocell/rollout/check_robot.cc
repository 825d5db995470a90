#include "robocell/rollout/check_robot.h"

#include <fmt/format.h>

#include "robocell/base/error.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/robot/check_config.h"
#include "robocell/rollout/episode_columns.h"
#include "robocell/rollout/sensor_columns.h"
#include "robocell/spec/problem_lines.h"

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
void CheckBaseMoves(const RobotConfig& config, Problems& problems) {
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

// Names of joints and sensors become paths in steps.h5: not every name can.
void CheckRecordable(const Robot& robot) {
  EpisodeSchema schema;
  const SceneColumns columns(schema, robot.scene(), {}, {});
  const SensorColumns sensors(schema, robot.scene());
  const RobotColumns of_robot(schema, robot);
}

// PickPlanner: an arm, and a gripper that can be measured.
void CheckPickParts(const Robot& robot, const SimOptions& options, double timestep) {
  robot.arm();
  if (!GripperShape::Supports(robot.gripper())) {
    throw SpecError(
        "the scripted expert needs a gripper with two fingers that actuators move; bring an "
        "expert of your own for this one");
  }
  robot.gripper().inter_finger_dist_range();  // measured for the records, which may fail
  GripperShape::Of(robot.config(), options, timestep);
}

}  // namespace

bool CheckRobot(const Robot& robot, Problems& problems) {
  const size_t before = problems.list().size();
  // Records ask the controllers, and would say the same of them again.
  if (CheckHaveControllers(robot, problems)) AsProblem(problems, [&] { CheckRecordable(robot); });
  AsProblem(problems, [&] { CheckConfig(robot, problems); });
  return problems.list().size() == before;
}

bool CheckScriptedExpert(const Robot& robot, const SimOptions& options, double timestep,
                         Problems& problems) {
  const size_t before = problems.list().size();
  CheckBaseMoves(robot.config(), problems);
  CheckTakesJointPositions(robot, problems);
  AsProblem(problems, [&] { CheckPickParts(robot, options, timestep); });
  return problems.list().size() == before;
}

std::vector<std::string> WhyNoPicks(const Robot& robot) {
  Problems problems(robot.config().locations);
  CheckScriptedExpert(robot, robot.scene().compiled()->spec().options, robot.scene().timestep(),
                      problems);
  return LinesOf(problems);
}

}  // namespace robocell
