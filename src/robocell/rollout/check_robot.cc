#include "robocell/rollout/check_robot.h"

#include <fmt/format.h>

#include "robocell/base/error.h"
#include "robocell/features/cell_features.h"
#include "robocell/robot/check_config.h"
#include "robocell/rollout/episode_columns.h"

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

// Names of joints and sensors become paths in steps.h5: not every name can.
void CheckRecordable(const Robot& robot) {
  EpisodeSchema schema;
  const OutcomeColumns outcome(schema, robot.scene(), {}, {});
  const FeatureColumns columns(schema, CellFeatures(robot.scene(), {robot}).schema());
}

}  // namespace

bool CheckRobot(const Robot& robot, Problems& problems) {
  const size_t before = problems.list().size();
  // Records ask the controllers, and would say the same of them again.
  if (CheckHaveControllers(robot, problems)) AsProblem(problems, [&] { CheckRecordable(robot); });
  AsProblem(problems, [&] { CheckConfig(robot, problems); });
  return problems.list().size() == before;
}

}  // namespace robocell
