#include "robocell/spec/run_config.h"

#include <fmt/format.h>

#include "robocell/spec/validate.h"

namespace robocell {

namespace {

// Rejects options of a pick task that only environments have.
class PickValidator {
 public:
  explicit PickValidator(Problems& problems) : problems_(problems) {}

  template <class T>
  void Validate(const T& task) {
    const T plain;
    const Problems::Scope scope(problems_, "task");
    RequireUnset("object", task.object == plain.object);
    RequireUnset("spread", task.spread == plain.spread);
    RequireUnset("rotate", task.rotate == plain.rotate);
    if constexpr (requires { task.goal_object; }) {
      const char* goals = "what they are put on among the kinds in `goals`";
      RequireUnset("goal", task.goal == plain.goal, goals);
      RequireUnset("goal_object", task.goal_object == plain.goal_object, goals);
      RequireUnset("goal_spread", task.goal_spread == plain.goal_spread, goals);
    }
  }

 private:
  void RequireUnset(const char* field, bool is_default,
                    const char* chosen = "its objects among the kinds in `objects`") {
    if (is_default) return;
    problems_.AddAt(field, fmt::format("belongs to environments, whose objects have ids and "
                                       "places; a run chooses {}: leave it out",
                                       chosen));
  }

  Problems& problems_;
};

}  // namespace

void RunConfig::Validate(Problems& problems) const {
  PickValidator validator(problems);
  if (const auto* pick = task.If<PickTaskConfig>()) validator.Validate(*pick);
  if (const auto* place = task.If<PickAndPlaceTaskConfig>()) validator.Validate(*place);
  ValidateNotEmpty(run, "run", "the run's name", problems);
  ValidateNotEmpty(output, "output", "the folder the dataset goes to", problems);
  if (robot.config == RobotConfig{}) {
    problems.AddAt("robot", "is required: a robot file, or the robot's fields");
  } else {
    Problems::Scope scope(problems, "robot");
    ValidateFields(robot.config, problems);
  }
}

}  // namespace robocell
