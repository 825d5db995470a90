#include "robocell/data/model_store.h"

#include <optional>
#include <set>
#include <string_view>
#include <system_error>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/hash.h"
#include "robocell/base/io_error.h"
#include "robocell/base/paths.h"
#include "robocell/base/real_file.h"
#include "robocell/data/dataset.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/work_folder.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

constexpr size_t kDigits = 16;  // digits of the hash in a folder's name
constexpr const char* kNotStored = "its hash does not match its bytes";

std::string FolderName(const FileSet& model) {
  return fs::path(model.main).stem().string() + "-" + model.hash.substr(0, kDigits);
}

bool IsStoredName(const std::string& name) {
  if (name.size() <= kDigits || name[name.size() - kDigits - 1] != '-' || name.front() == '.')
    return false;
  return name.find_first_not_of("0123456789abcdef", name.size() - kDigits) == std::string::npos;
}

bool IsRealFolder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(fs::symlink_status(path, ignored));
}

// Returns the entries of the folder of models: "models/rc7-0123456789abcdef", sorted.
std::vector<std::string> NamesInModels(const fs::path& dataset) {
  const fs::path folder = dataset / kModelsFolder;
  if (!IsRealFolder(folder)) return {};
  std::vector<std::string> names = FolderNames(folder);
  std::error_code error;  // the folder may be listable while its entries are not readable
  static_cast<void>(fs::symlink_status(folder / ".", error));
  if (error) ThrowIoError("look into", folder, error.value());
  for (std::string& name : names) name.insert(0, std::string(kModelsFolder) + "/");
  return names;
}

bool IsModel(const fs::path& dataset, const std::string& name) {
  return IsStoredName(fs::path(name).filename().string()) && IsRealFolder(dataset / name);
}

void Copy(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  if (error) ThrowIoError("create", to.parent_path(), error.value());
  AtomicWrite(to, ReadFile(from));
}

// Returns sums of a stored model's files, without its list and unfinished copies of that.
FileSums SumsOfModel(const fs::path& folder) {
  FileSums sums = SumsOfFolder(folder);
  std::erase_if(sums, [](const auto& sum) {
    return sum.first == kModelListFile || IsTemporaryName(sum.first);
  });
  return sums;
}

bool IsStoredIn(const fs::path& folder, const std::string& text) {
  const std::string name = folder.filename().string();
  return Sha256(text).starts_with(name.substr(name.size() - kDigits));
}

// Returns the list if it is as stored: the folder's name has its hash.
std::optional<FileSums> StoredSums(const fs::path& folder) {
  const fs::path path = folder / kModelListFile;
  if (!CanReadFile(path)) return std::nullopt;
  const std::string text = ReadRealFile(path);
  if (!IsStoredIn(folder, text)) return std::nullopt;
  return ParseSums(text).value_or(FileSums());
}

std::map<std::string, std::string> Differences(const FileSums& stored, const FileSums& there) {
  std::map<std::string, std::string> reasons;
  for (const auto& [name, sum] : stored) {
    const auto it = there.find(name);
    if (it == there.end())
      reasons[name] = "it is missing";
    else if (it->second != sum)
      reasons[name] = kNotStored;
  }
  for (const auto& [name, sum] : there) {
    if (!stored.contains(name)) reasons[name] = "it does not belong to the model";
  }
  return reasons;
}

}  // namespace

std::string StoredModelPath(const FileSet& model) {
  return std::string(kModelsFolder) + "/" + FolderName(model) + "/" + model.main;
}

void StoreModel(const fs::path& dataset, const FileSet& model) {
  const fs::path folder = dataset / kModelsFolder, final = folder / FolderName(model);
  std::error_code error;
  RequireRealFolder(folder);
  RequireRealFolder(final);
  if (fs::exists(final, error)) return;
  fs::create_directory(folder, error);
  if (error) ThrowIoError("create", folder, error.value());
  WorkFolder work(folder, FolderName(model));
  for (const auto& [name, path] : model.files) Copy(path, ConfinedPath(work.path(), name));
  const std::string sums = TextOf(SumsOfFolder(work.path()));
  if (Sha256(sums) != model.hash)
    throw IoError("model '" + model.main + "' changed while it was copied into '" +
                  dataset.string() + "'; try again");
  AtomicWrite(work.path() / kModelListFile, sums);
  try {
    work.Commit(final);
  } catch (const IoError&) {
    const bool somebody_was_quicker = !work.committed() && fs::exists(final, error);
    if (!somebody_was_quicker) throw;
  }
}

bool IsStoredModelPath(const std::string& path) {
  const fs::path parts = path;
  int count = 0;
  for (const fs::path& part : parts) {
    const std::string name = part.string();
    if (!ValidFileName(name)) return false;
    if (count == 0 && name != kModelsFolder) return false;
    if (count == 1 && !IsStoredName(name)) return false;
    ++count;
  }
  return count > 2;
}

std::string StoredModelFolder(const std::string& path) {
  const fs::path parts = path;
  return (*parts.begin() / *std::next(parts.begin())).string();
}

std::map<std::string, std::string> DamageOfStoredModel(const fs::path& dataset,
                                                       const std::string& path) {
  const std::string folder = StoredModelFolder(path);
  RequireRealFolder(dataset / kModelsFolder);
  RequireRealFolder(dataset / folder);
  const FileSums there = SumsOfModel(dataset / folder);
  if (const auto stored = StoredSums(dataset / folder)) return Differences(*stored, there);
  if (IsStoredIn(dataset / folder, TextOf(there))) return {};  // only its list is lost
  return {{"", "its files differ from the stored ones"}};
}

FileSums SumsOfStoredModel(const fs::path& dataset, const std::string& path) {
  const fs::path folder = dataset / StoredModelFolder(path);
  if (auto stored = StoredSums(folder)) return *std::move(stored);
  return SumsOfModel(folder);
}

bool HasModelList(const fs::path& dataset, const std::string& path) {
  return StoredSums(dataset / StoredModelFolder(path)).has_value();
}

void WriteModelList(const fs::path& dataset, const std::string& path) {
  const fs::path folder = dataset / StoredModelFolder(path);
  AtomicWrite(folder / kModelListFile, TextOf(SumsOfModel(folder)));
}

bool IsStored(const fs::path& dataset, const std::string& path) {
  return IsRealFolder(dataset / StoredModelFolder(path));
}

std::vector<std::string> StoredModels(const fs::path& dataset) {
  std::vector<std::string> models = NamesInModels(dataset);
  std::erase_if(models, [&](const std::string& name) { return !IsModel(dataset, name); });
  return models;
}

StrayModels StrayModelsIn(const fs::path& dataset) {
  StrayModels stray;
  for (const std::string& name : NamesInModels(dataset)) {
    const std::string own = fs::path(name).filename().string();
    if (IsTemporaryName(own) || IsModel(dataset, name)) continue;
    (IsStoredName(own) ? stray.blocking : stray.others).push_back(name);
  }
  return stray;
}

namespace {

namespace fs = std::filesystem;

using SumsByName = std::map<std::string, std::set<std::string>>;

// Returns "table.xml" for "room/table.xml (2)", the form in which run_inputs.cc numbers files of
// the same name.
std::string OwnName(const std::string& file) {
  const std::string name = fs::path(file).filename().string();
  const size_t number = name.rfind(" (");
  return number != std::string::npos && name.ends_with(')') ? name.substr(0, number) : name;
}

SumsByName SumsOfRun(const fs::path& dataset) {
  SumsByName sums;
  try {
    const auto manifest = ReadManifest(dataset);
    if (!manifest) return sums;
    const auto files = nlohmann::json::parse(*manifest).value("files", nlohmann::json::object());
    for (const auto& [name, sum] : files.items())
      sums[OwnName(name)].insert(sum.get<std::string>());
  } catch (const Error&) {  // reported separately
  } catch (const nlohmann::json::exception&) {
    return {};  // another format
  }
  return sums;
}

// Returns the first file that differs from the run's.
std::optional<std::string> ChangedFile(const FileSums& model, const SumsByName& run) {
  for (const auto& [name, sum] : model) {
    const auto it = run.find(fs::path(name).filename().string());
    if (it != run.end() && !it->second.contains(sum)) return name;
  }
  return std::nullopt;
}

}  // namespace

std::map<std::string, std::string> ChangedModels(const fs::path& dataset) {
  std::map<std::string, std::string> changed;
  const SumsByName run = SumsOfRun(dataset);
  if (run.empty()) return changed;
  std::vector<std::string> folders;
  try {
    folders = StoredModels(dataset);
  } catch (const Error&) {  // reported separately
  }
  for (const std::string& folder : folders) {
    try {
      if (auto file = ChangedFile(SumsOfStoredModel(dataset, folder), run))
        changed[folder] = std::move(*file);
    } catch (const Error&) {  // damage is reported separately
    }
  }
  return changed;
}

bool IsModelOfRun(const fs::path& dataset, const std::string& path) {
  const SumsByName run = SumsOfRun(dataset);
  if (run.empty() || !IsStored(dataset, path)) return false;
  try {
    return !ChangedFile(SumsOfStoredModel(dataset, path), run);
  } catch (const Error&) {
    return false;
  }
}

}  // namespace robocell::internal
