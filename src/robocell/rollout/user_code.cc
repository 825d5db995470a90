#include "robocell/rollout/user_code.h"

#include <algorithm>

#include "robocell/base/hash.h"
#include "robocell/features/chosen_features.h"
#include "robocell/features/own_features.h"
#include "robocell/task/task_kind.h"

namespace robocell::internal {

void UserCode::Add(const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    if (std::ranges::find(files_, std::filesystem::path(file)) == files_.end())
      files_.emplace_back(file);
  }
}

std::vector<std::string> UserCode::Unknown(const std::set<std::string>& hashes) const {
  std::vector<std::string> unknown;
  for (const std::filesystem::path& file : files_) {
    if (!hashes.contains(Sha256File(file))) unknown.push_back(file.string());
  }
  return unknown;
}

UserCode CodeOf(const EnvConfig& config) {
  UserCode code;
  if (config.task) code.AddKind(*FindTaskKind(config.task->kind()));
  code.Add(CodeOfFeatures(internal::OwnAmong(config.features.names)));
  return code;
}

}  // namespace robocell::internal
