#include "robocell/data/require_dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <system_error>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/folder_names.h"
#include "robocell/base/io_error.h"
#include "robocell/base/names.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/episode_state.h"
#include "robocell/data/episode_writer.h"
#include "robocell/data/model_store.h"
#include "robocell/data/quarantine.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

constexpr size_t kShown = 5;

bool IsOfDataset(const fs::path& folder, const std::string& name) {
  return name == kManifestFile || name == kQuarantineFolder || name == kModelsFolder ||
         IsReportFile(name) || IsTemporaryName(name) || IsEpisodeFolder(folder / name);
}

// Finds the dataset that the user may have meant: around the folder, or one below.
std::string NearestDataset(const fs::path& folder, const std::vector<std::string>& names) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  const fs::path around = (path.has_filename() ? path : path.parent_path()).parent_path();
  if (fs::exists(folder / kEpisodeFile))
    return fmt::format(". It is an episode of a dataset; give '{}'", around.string());
  if (fs::exists(around / kManifestFile))
    return fmt::format(". It is a part of a dataset; give '{}'", around.string());
  std::vector<std::string> below;
  for (const std::string& name : names) {
    if (fs::exists(folder / name / kManifestFile)) below.push_back((folder / name).string());
  }
  if (below.empty()) return "";
  if (below.size() == 1) return fmt::format(". Did you mean '{}'?", below.front());
  return fmt::format(". It holds {} datasets, give one of them: {}", below.size(),
                     ListNames(below, kShown));
}

}  // namespace

void RequireDataset(const fs::path& folder) {
  const std::vector<std::string> names = FolderNames(folder);
  if (std::any_of(names.begin(), names.end(),
                  [&](const std::string& name) { return IsOfDataset(folder, name); }))
    return;
  const std::string holds =
      names.empty() ? "it is empty" : fmt::format("it holds {}", ListNames(names, kShown));
  throw ArgumentError(
      fmt::format("'{}' is no dataset: it has neither a dataset.json nor episodes, {}{}",
                  folder.string(), holds, NearestDataset(folder, names)));
}

}  // namespace robocell
