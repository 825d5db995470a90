#include "robocell/data/dataset_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/io_error.h"
#include "robocell/base/packed_index.h"
#include "robocell/base/paths.h"
#include "robocell/base/real_file.h"
#include "robocell/base/suggestions.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/episode_state.h"
#include "robocell/data/episode_writer.h"
#include "robocell/data/model_store.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

constexpr size_t kShown = 5;  // names in a message

bool Is(const fs::path& path, std::initializer_list<fs::file_type> types) {
  std::error_code ignored;
  const fs::file_type type = fs::symlink_status(path, ignored).type();
  for (const fs::file_type each : types) {
    if (type == each) return true;
  }
  return false;
}

bool IsOfDataset(const fs::path& folder, const std::string& name) {
  return name == kManifestFile || name == internal::kPackedFile || name == kQuarantineFolder ||
         name == kModelsFolder || IsReportFile(name) || IsTemporaryName(name) ||
         internal::IsEpisodeFolder(folder / name);
}

// Finds the dataset that the user probably meant: around the folder, or one below.
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

std::vector<ForeignEntry> NotOwn(const fs::path& dataset) {
  std::vector<ForeignEntry> found;
  const auto add = [&](const fs::path& path) {
    found.push_back({path.lexically_relative(dataset).generic_string(), internal::WhatIsAt(path)});
  };
  for (const std::string_view name : {kModelsFolder, kQuarantineFolder, kLogsFolder}) {
    const fs::path folder = dataset / name;
    if (!Is(folder, {fs::file_type::directory, fs::file_type::not_found})) add(folder);
  }
  if (!Is(dataset / kLogsFolder, {fs::file_type::directory})) return found;
  std::error_code error;  // other processes create and remove logs
  for (fs::recursive_directory_iterator it(dataset / kLogsFolder, error), end; !error && it != end;
       it.increment(error)) {
    if (!Is(it->path(),
            {fs::file_type::regular, fs::file_type::directory, fs::file_type::not_found}))
      add(it->path());
  }
  return found;
}

void RequireOwnFolders(const fs::path& dataset) {
  for (const ForeignEntry& entry : NotOwn(dataset)) {
    throw IoError(
        fmt::format("cannot use '{}': it is {}, so writes would leave the dataset. Remove it, or "
                    "replace it with its target",
                    (dataset / entry.name).string(), entry.what));
  }
}

void RequireDataset(const fs::path& folder) {
  const std::vector<std::string> names = FolderNames(folder);
  if (std::any_of(names.begin(), names.end(),
                  [&](const std::string& name) { return IsOfDataset(folder, name); }))
    return;
  const std::string holds =
      names.empty() ? "it is empty" : fmt::format("it holds {}", ListNames(names, kShown));
  throw ArgumentError(
      fmt::format("'{}' is not a dataset: it has neither a dataset.json nor episodes, {}{}",
                  folder.string(), holds, NearestDataset(folder, names)));
}

std::string Quarantine(const fs::path& dataset, const std::string& name) {
  const fs::path folder = dataset / kQuarantineFolder;
  std::error_code error;
  internal::RequireRealFolder(folder);
  fs::create_directory(folder, error);
  if (error) ThrowIoError("create", folder, error.value());
  const std::string own = fs::path(name).filename().string();
  std::string target = own;
  for (int i = 1; fs::exists(fs::symlink_status(folder / target)); ++i)
    target = fmt::format("{}.{}", own, i);
  fs::rename(dataset / name, folder / target, error);
  if (error) ThrowIoError("move aside", dataset / name, error.value());
  FsyncDirectory(folder);
  FsyncDirectory((dataset / name).parent_path());
  return target;
}

}  // namespace robocell
