#include "robocell/data/leftovers.h"

#include <algorithm>
#include <system_error>

#include "robocell/base/error.h"
#include "robocell/base/io_error.h"
#include "robocell/base/temporary_name.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/file_lock.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

bool IsFolder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(fs::symlink_status(path, error));
}

void AddUnfinished(const fs::path& folder, const std::string& prefix,
                   std::vector<std::string>& names) {
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (TemporaryName::Parse(name)) names.push_back(prefix + name);
  }
  if (error) ThrowIoError("list", folder, error.value());
}

bool IsOf(const DeadWriter& writer, const std::string& name) {
  const auto parsed = TemporaryName::Parse(fs::path(name).filename().string());
  return parsed->process == writer.process && parsed->name.starts_with(writer.episode);
}

// False when somebody is writing it, or it cannot be removed.
bool Remove(const fs::path& leftover) {
  std::error_code error;
  if (!IsFolder(leftover)) return fs::remove(leftover, error);
  try {
    const auto lock = FileLock::Try(leftover, LockKind::kExclusive);
    if (!lock) return false;
    fs::remove_all(leftover, error);
  } catch (const IoError&) {  // it went away by itself
  }
  return !fs::exists(leftover, error);
}

}  // namespace

bool IsBeingWritten(const fs::path& unfinished) {
  return IsFolder(unfinished) && !FileLock::Try(unfinished, LockKind::kExclusive);
}

std::vector<std::string> UnfinishedIn(const fs::path& dataset) {
  std::vector<std::string> names;
  AddUnfinished(dataset, "", names);
  if (IsFolder(dataset / kModelsFolder))
    AddUnfinished(dataset / kModelsFolder, std::string(kModelsFolder) + "/", names);
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> RemoveLeftovers(const fs::path& dataset,
                                         const std::optional<DeadWriter>& writer) {
  std::vector<std::string> removed;
  for (const std::string& name : UnfinishedIn(dataset)) {
    if ((!writer || IsOf(*writer, name)) && Remove(dataset / name)) removed.push_back(name);
  }
  return removed;
}

}  // namespace robocell
