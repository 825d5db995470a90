#include "robocell/data/leftovers.h"

#include <algorithm>
#include <system_error>

#include "robocell/base/error.h"
#include "robocell/base/io_error.h"
#include "robocell/base/temporary_name.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/model_store.h"
#include "robocell/data/work_folder.h"

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
    if (internal::TemporaryName::Parse(name)) names.push_back(prefix + name);
  }
  if (error) ThrowIoError("list", folder, error.value());
}

// Verify reports folders that cannot be listed.
void AddWhatCanBeListed(const fs::path& folder, const std::string& prefix,
                        std::vector<std::string>& names) {
  try {
    AddUnfinished(folder, prefix, names);
  } catch (const IoError&) {
  }
}

std::vector<std::string> ModelsThatCanBeListed(const fs::path& dataset) {
  try {
    return internal::StoredModels(dataset);
  } catch (const IoError&) {
    return {};
  }
}

bool IsOfModel(const std::string& name) {
  return name.starts_with(std::string(kModelsFolder) + "/");
}

bool IsOf(const DeadWriter& writer, const std::string& name) {
  const auto parsed = internal::TemporaryName::Parse(fs::path(name).filename().string());
  return parsed->process == writer.process &&
         (IsOfModel(name) || parsed->name.starts_with(writer.episode));
}

// Returns true for "<prefix>-000017"; names of other prefixes may begin with this one too.
bool IsOfNumbering(const std::string& prefix, const std::string& name) {
  const std::string episode = internal::TemporaryName::Parse(name)->name;
  return episode.starts_with(prefix + "-") &&
         episode.find_first_not_of("0123456789", prefix.size() + 1) == std::string::npos;
}

// Call it under the folder's lock. The lock goes last and the folder only if it is empty then: in
// between, a new owner may take the folder into use.
void Empty(const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    if (it->path().filename() != kLockFile) fs::remove_all(it->path(), ignored);
  }
  if (!error) fs::remove(folder / kLockFile, error);
}

// Returns false if it is being written, or cannot be removed.
bool Remove(const fs::path& leftover) {
  std::error_code error;
  if (!IsFolder(leftover)) return fs::remove(leftover, error);
  try {
    const auto lock = internal::TryLockOfWork(leftover, LockKind::kExclusive);
    if (!lock || !lock->holds()) return false;
    Empty(leftover);
  } catch (const IoError&) {  // it disappeared meanwhile
  }
  // Unlocks first: some file systems keep a removed file's name, and so the folder, while it is
  // open.
  fs::remove(leftover, error);
  return !fs::exists(leftover, error);
}

}  // namespace

bool IsBeingWritten(const fs::path& unfinished) {
  std::error_code error;
  if (!IsFolder(unfinished) || !fs::exists(unfinished / kLockFile, error)) return false;
  try {
    const auto lock =
        internal::TryLockOfWork(unfinished, LockKind::kShared);  // nothing is written there for it
    return !lock || !lock->holds();
  } catch (const IoError&) {
    return fs::exists(unfinished / kLockFile, error);
  }
}

std::vector<std::string> UnfinishedIn(const fs::path& dataset) {
  std::vector<std::string> names;
  AddUnfinished(dataset, "", names);
  if (IsFolder(dataset / kModelsFolder))
    AddWhatCanBeListed(dataset / kModelsFolder, std::string(kModelsFolder) + "/", names);
  for (const std::string& model : ModelsThatCanBeListed(dataset))
    AddWhatCanBeListed(dataset / model, model + "/", names);
  std::sort(names.begin(), names.end());
  return names;
}

namespace {

template <class Chosen>
std::vector<std::string> RemoveThose(const fs::path& dataset, const Chosen& chosen) {
  std::vector<std::string> removed;
  for (const std::string& name : UnfinishedIn(dataset))
    if (chosen(name) && Remove(dataset / name)) removed.push_back(name);
  return removed;
}

}  // namespace

std::vector<std::string> RemoveLeftovers(const fs::path& dataset,
                                         const std::optional<DeadWriter>& writer) {
  return RemoveThose(dataset,
                     [&](const std::string& name) { return !writer || IsOf(*writer, name); });
}

std::vector<std::string> RemoveLeftoverFolders(const fs::path& dataset) {
  return RemoveThose(dataset, [&](const std::string& name) { return IsFolder(dataset / name); });
}

std::vector<std::string> RemoveLeftoversOfNumbering(const fs::path& dataset,
                                                    const std::string& prefix) {
  return RemoveThose(dataset, [&](const std::string& name) {
    return IsFolder(dataset / name) && (IsOfModel(name) || IsOfNumbering(prefix, name));
  });
}

}  // namespace robocell
