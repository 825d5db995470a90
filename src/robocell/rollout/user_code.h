// UserCode: the files that define a user's own tasks, features and other kinds: sources and
// plugins. Datasets store their hashes, and nothing is repeated with other code.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "robocell/base/plugin.h"
#include "robocell/spec/env_config.h"

namespace robocell::internal {

class UserCode {
 public:
  void Add(const std::vector<std::string>& files);
  // Adds a kind's files, and the plugin that registered it.
  template <class Kind>
  void AddKind(const Kind& kind) {
    Add(kind.CodeFiles());
    const std::string plugin = PluginOf(kind);
    if (!plugin.empty()) Add({plugin});
  }
  // Returns each file once, in the order of adding.
  const std::vector<std::filesystem::path>& files() const { return files_; }
  // Returns the files whose content has none of these SHA-256 hashes.
  std::vector<std::string> Unknown(const std::set<std::string>& hashes) const;

 private:
  std::vector<std::filesystem::path> files_;
};

// Returns the code of an environment's task and of the features that it observes.
UserCode CodeOf(const EnvConfig& config);

}  // namespace robocell::internal
