// The kinds of experts: scripted policies by their names. A task names the kind that demonstrates it
// (TaskKind::expert); one's own are registered like tasks:
//
//   RegisterExpert("stack", std::make_shared<StackExpertKind>());
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robocell/spec/problems.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/task.h"

namespace robocell {

class ExpertKind {
 public:
  virtual ~ExpertKind() = default;
  // An expert for one episode.
  virtual std::shared_ptr<Expert> Make(const RunConfig& run, const EpisodeStart& start) const = 0;
  // Source files that define it, for kinds that users write: a dataset remembers what they held.
  virtual std::vector<std::string> CodeFiles() const { return {}; }
  // Whether robocell brings it: what goes wrong in its experts is no failure of a user's code.
  virtual bool is_built_in() const { return false; }
  // What it needs of the run's robot, at the paths of the run's fields: in `scene` stands the robot
  // with one of each object that the run may use (TaskKind::Contents). What works and may not be
  // meant goes to the warnings.
  virtual void Validate(const RunConfig& /*run*/, const Scene& /*scene*/, Robot& /*robot*/,
                        Problems& /*problems*/, std::vector<std::string>& /*warnings*/) const {}
};

// Makes a kind known on all threads, from now on. ArgumentError for a name that is taken, unless
// `replace` allows it.
void RegisterExpert(const std::string& kind, std::shared_ptr<const ExpertKind> expert,
                    bool replace = false);
// All kinds, in alphabetical order.
std::vector<std::string> ExpertKinds();
// NotFoundError lists the kinds.
std::shared_ptr<const ExpertKind> FindExpertKind(const std::string& kind);
// The kind that acts in a run: the one that it names, else its task's. SpecError for a task that names none.
std::shared_ptr<const ExpertKind> ExpertKindOf(const RunConfig& run);

}  // namespace robocell
