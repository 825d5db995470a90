#include "robocell/data/dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>
#include <nlohmann/json.hpp>

#include "robocell/base/checked_json.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/io_error.h"
#include "robocell/base/log.h"
#include "robocell/base/packed_index.h"
#include "robocell/base/paths.h"
#include "robocell/base/real_file.h"
#include "robocell/base/suggestions.h"
#include "robocell/data/dataset_folder.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/episode_state.h"
#include "robocell/data/episode_writer.h"

namespace robocell {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void ThrowNoDataset(const fs::path& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  const fs::path whole = path.has_filename() ? path : path.parent_path();  // no trailing slash
  std::vector<std::string> beside;
  std::error_code ignored;
  for (fs::directory_iterator it(whole.parent_path(), ignored), end; !ignored && it != end;
       it.increment(ignored)) {
    if (it->is_directory(ignored)) beside.push_back(it->path().filename().string());
  }
  throw IoError(
      fmt::format("no dataset '{}': there is no such folder.{} `robocell generate RUN.yaml "
                  "--output {}` makes one",
                  folder.string(), DidYouMean(whole.filename().string(), beside),
                  internal::ShellWord(folder.string())));
}

}  // namespace

Dataset::Dataset(fs::path folder) : folder_(std::move(folder)) {
  Refresh();
  // An empty folder may become one.
  std::error_code error;
  if (ids_.empty() && broken_.empty() && !fs::is_empty(folder_, error)) RequireDataset(folder_);
  for (const auto& [name, id] : misnamed_) LogWarn(internal::MisnamedText(folder_ / name, id));
}

void Dataset::Refresh() {
  const std::vector<std::string> selected = is_selection_ ? ids_ : std::vector<std::string>();
  ids_.clear();
  broken_.clear();
  misnamed_.clear();
  std::error_code error;
  if (!fs::exists(folder_, error) && !error) ThrowNoDataset(folder_);
  const auto packed = internal::PackedIndexOf(folder_);
  if (packed) ids_ = packed->episodes;
  for (fs::directory_iterator it(folder_, error), end; !packed && !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    const bool committed = IsEpisodeId(name) && internal::IsCommitted(it->path());
    if (auto id = committed ? internal::OtherIdIn(it->path()) : std::nullopt)
      misnamed_[name] = std::move(*id);
    else if (committed)
      ids_.push_back(name);
    else if (internal::IsEpisodeFolder(it->path()))
      broken_.push_back(name);
  }
  if (error) ThrowIoError("list dataset", folder_, error.value());
  std::sort(ids_.begin(), ids_.end());
  std::sort(broken_.begin(), broken_.end());
  if (!is_selection_) return;
  const std::vector<std::string> all = std::exchange(ids_, selected);
  std::erase_if(
      ids_, [&](const std::string& id) { return !std::binary_search(all.begin(), all.end(), id); });
}

bool Dataset::Contains(std::string_view id) const {
  if (is_selection_) return std::ranges::find(ids_, id) != ids_.end();  // any order
  return std::binary_search(ids_.begin(), ids_.end(), id);
}

Dataset Dataset::Select(std::vector<std::string> ids) const {
  for (const std::string& id : ids) RequireId(id);
  return Restore(folder_, std::move(ids), true);
}

Dataset Dataset::Restore(fs::path folder, std::vector<std::string> ids, bool is_selection) {
  Dataset restored;
  restored.folder_ = std::move(folder);
  restored.ids_ = std::move(ids);
  restored.is_selection_ = is_selection;
  return restored;
}

Episode Dataset::Open(const std::string& id) const {
  RequireId(id);
  return Episode(folder_ / id);
}

void Dataset::RequireId(const std::string& id) const {
  if (Contains(id)) return;
  const std::string name =
      fmt::format("{}dataset '{}'", is_selection_ ? "selection of " : "", folder_.string());
  throw NotFoundError(NoSuchName(name, "episode", id, ids_));
}

void WriteManifest(const fs::path& dataset, const std::string& json) {
  auto manifest = nlohmann::ordered_json::parse(json, nullptr, false);
  if (!manifest.is_object()) throw ArgumentError("dataset.json must be a JSON object");
  manifest[kJsonHash] = kHashPlaceholder;
  AtomicWrite(dataset / kManifestFile, InsertSelfHash(manifest.dump(2) + "\n"));
}

std::optional<std::string> ReadManifest(const fs::path& dataset) {
  const fs::path path = dataset / kManifestFile;
  std::error_code error;
  const fs::file_type type = fs::symlink_status(path, error).type();
  if (type == fs::file_type::not_found) return std::nullopt;
  if (type == fs::file_type::none)
    ThrowIoError("look at the dataset's folder", dataset, error.value());
  std::string text = internal::ReadRealFile(path);
  const auto damage = JsonDamage(text);
  if (damage && internal::IsPacked(dataset))
    throw IoError(
        fmt::format("'{}' is damaged: {}. Copy it again from where the packed dataset came",
                    path.string(), *damage));
  if (damage)
    throw IoError(
        fmt::format("'{}' is damaged: {}. `robocell verify --repair {}` sets it aside, `robocell "
                    "generate` with the run's file writes it again",
                    path.string(), *damage, internal::ShellWord(dataset.string())));
  return text;
}

}  // namespace robocell
