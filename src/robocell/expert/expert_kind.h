// The kinds of experts: scripted policies by name. A task names the kind that demonstrates it
// (TaskKind::expert), else it is the one of the task's own name; custom kinds are registered like tasks:
//
//   RegisterExpert("stack", std::make_shared<ExpertKindOf<Stacker>>());
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robocell/expert/expert.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/task_sampler.h"

namespace robocell {

class ExpertKind {
 public:
  virtual ~ExpertKind() = default;
  // Returns an expert for one episode.
  virtual std::shared_ptr<Expert> Make(const RunConfig& run, const EpisodeStart& start) const = 0;
  // Returns the source files that define a custom kind; a dataset stores their contents.
  virtual std::vector<std::string> CodeFiles() const { return {}; }
  // Returns true for a built-in kind, whose errors are not failures of a user's code.
  virtual bool is_built_in() const { return false; }
  // Checks what the expert needs of the run's robot and reports problems at the paths of the run's
  // fields: `scene` holds the robot and one of each object that the run may use
  // (TaskKind::Contents). Settings that are valid but probably unintended become `doubts`.
  virtual void Validate(const RunConfig& /*run*/, const Scene& /*scene*/, Robot& /*robot*/,
                        Problems& /*problems*/, Problems& /*doubts*/) const {}
  // Checks what of this can be known of a robot without a run, one that passed ValidateRobot.
  // Reports problems at the fields of the robot.
  virtual void ValidateRobot(const Robot& /*robot*/, Problems& /*problems*/) const {}
};

// A kind that makes its experts as T(const RunConfig&, const EpisodeStart&).
template <class T>
class ExpertKindOf : public ExpertKind {
 public:
  std::shared_ptr<Expert> Make(const RunConfig& run, const EpisodeStart& start) const override {
    return std::make_shared<T>(run, start);
  }
};

// Registers a kind for all threads. Throws ArgumentError for a name that is taken, unless `replace`
// allows it.
void RegisterExpert(const std::string& kind, std::shared_ptr<const ExpertKind> expert,
                    bool replace = false);
// Returns all kinds in alphabetical order.
std::vector<std::string> ExpertKinds();
// Returns the kind. Throws NotFoundError that lists the kinds.
std::shared_ptr<const ExpertKind> FindExpertKind(const std::string& kind);
// Returns why the expert of a kind cannot use a robot, as texts; empty if it can as far as is known
// without a run. Throws the errors of FindExpertKind.
std::vector<std::string> WhyNot(const Robot& robot, const std::string& kind);
// Returns the name of the kind that acts in a run: the one that the run names, else the one that its
// task names, else the one of the task's own name. "" if there is none.
std::string NameOfExpert(const RunConfig& run);
// Returns that kind. Throws SpecError if there is none, and the errors of FindExpertKind.
std::shared_ptr<const ExpertKind> ExpertKindFor(const RunConfig& run);

}  // namespace robocell
