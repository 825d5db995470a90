// Private to rollout: reports the kinds of a user's own that the configuration of a dataset names
// and that nobody registered. A dataset imports no module, so the message says where to name it.
#pragma once

#include <string>
#include <vector>

namespace robocell::internal {

// Returns a line for each kind of task, source of scenes and feature that a configuration names and
// that is not registered; `yaml` is what ToYaml wrote of a RunConfig or an EnvConfig. Empty for
// other texts.
std::vector<std::string> UnregisteredKinds(const std::string& yaml);

// Returns what to do about a kind that nobody registered; `noun` as in "A task of your own ...".
std::string WhereToNameIt(const std::string& noun);

}  // namespace robocell::internal
