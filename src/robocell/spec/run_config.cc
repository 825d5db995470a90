#include "robocell/spec/run_config.h"

#include "robocell/spec/validate.h"

namespace robocell {

void RunConfig::Validate(Problems& problems) const {
  task.rules()->ValidateRun(*this, problems);
  ValidateNotEmpty(run, "run", "the run's name", problems);
  ValidateNotEmpty(output, "output", "the folder the dataset goes to", problems);
  if (augment && !expert.empty())
    problems.AddAt("augment", "replaces the expert: leave out `expert`, or `augment`");
  if (robot.config == RobotConfig{}) {
    problems.AddAt("robot", "is required: a robot file, or the robot's fields");
  } else {
    Problems::Scope scope(problems, "robot");
    ValidateFields(robot.config, problems);
  }
}

}  // namespace robocell
