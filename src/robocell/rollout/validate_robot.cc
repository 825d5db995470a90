#include "robocell/rollout/validate_robot.h"

#include <fmt/format.h>

#include "robocell/base/error.h"
#include "robocell/features/cell_features.h"
#include "robocell/robot/validate_config.h"
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
void RequireRecordable(const Robot& robot) {
  EpisodeSchema schema;
  const OutcomeColumns outcome(schema, robot.scene(), {}, {});
  const FeatureColumns columns(schema, CellFeatures(robot.scene(), {robot}).schema());
}

}  // namespace

bool ValidateRobot(const Robot& robot, Problems& problems) {
  const size_t before = problems.list().size();
  // Records ask the controllers, and would say the same of them again.
  if (ValidateControllers(robot, problems)) AsProblem(problems, [&] { RequireRecordable(robot); });
  AsProblem(problems, [&] { ValidateConfig(robot, problems); });
  return problems.list().size() == before;
}

}  // namespace robocell
