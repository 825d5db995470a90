#include "robocell/rollout/episode_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <nlohmann/json.hpp>

#include "robocell/base/paths.h"
#include "robocell/base/suggestions.h"
#include "robocell/data/episode_files.h"

namespace robocell::internal {
namespace {

constexpr size_t kMostOfValue = 60;

std::string FileOf(const Episode& episode) { return (episode.folder() / kEpisodeFile).string(); }

}  // namespace

EpisodeJson EpisodeJson::Metadata(const Episode& episode) {
  return {FileOf(episode), "metadata", nlohmann::json::parse(episode.metadata_json())};
}

EpisodeJson EpisodeJson::Results(const Episode& episode) {
  return {FileOf(episode), "results", nlohmann::json::parse(episode.results_json())};
}

EpisodeJson EpisodeJson::Versions(const Episode& episode) {
  return {FileOf(episode), "versions", nlohmann::json::parse(episode.versions_json())};
}

EpisodeJson::EpisodeJson(std::string file, std::string path, nlohmann::json value)
    : file_(std::move(file)),
      path_(std::move(path)),
      value_(std::make_shared<const nlohmann::json>(std::move(value))) {}

std::optional<EpisodeJson> EpisodeJson::Find(const std::string& key) const {
  const auto found = value_->is_object() ? value_->find(key) : value_->end();
  if (found == value_->end()) return std::nullopt;
  return EpisodeJson(file_, path_ + "." + key, *found);
}

EpisodeJson EpisodeJson::At(const std::string& key) const {
  if (!value_->is_object()) ThrowNot("an object");
  if (std::optional<EpisodeJson> found = Find(key)) return *std::move(found);
  throw IoError(
      fmt::format("'{}': '{}' has no field '{}'; the episode was edited or comes from another "
                  "program",
                  file_, path_, key));
}

std::vector<EpisodeJson> EpisodeJson::Items() const {
  if (!value_->is_array()) ThrowNot("a list");
  std::vector<EpisodeJson> items;
  for (size_t i = 0; i < value_->size(); ++i)
    items.push_back(EpisodeJson(file_, fmt::format("{}[{}]", path_, i), (*value_)[i]));
  return items;
}

std::string EpisodeJson::AsText() const {
  if (!value_->is_string()) ThrowNot("a text");
  return value_->get<std::string>();
}

bool EpisodeJson::AsBool() const {
  if (!value_->is_boolean()) ThrowNot("true or false");
  return value_->get<bool>();
}

std::vector<double> EpisodeJson::AsNumbers() const {
  const bool are_numbers =
      value_->is_array() &&
      std::ranges::all_of(*value_, [](const nlohmann::json& one) { return one.is_number(); });
  if (!are_numbers) ThrowNot("a list of numbers");
  return value_->get<std::vector<double>>();
}

void EpisodeJson::ThrowNot(const std::string& what, const std::string& detail) const {
  std::string shown = value_->dump(-1, ' ', true);
  if (shown.size() > kMostOfValue) shown = shown.substr(0, kMostOfValue) + "...";
  throw IoError(
      fmt::format("'{}': '{}' is {}, not {}{}{}; the episode was edited or comes from another "
                  "program",
                  file_, path_, shown, what, detail.empty() ? "" : ": ", detail));
}

void RequireRowOfEachStep(const Episode& episode, const std::string& column) {
  const ColumnInfo& info = episode.column(column);
  if (info.table == "steps" && info.rows == episode.rows()) return;
  throw IoError(fmt::format(
      "episode '{}': column '{}' has {} in '{}', where '{}' says {}; `robocell verify {}` "
      "names all that is damaged",
      episode.folder().string(), column, Counted(info.rows, "row"), kStepsFile, kEpisodeFile,
      episode.rows(), ShellWord(episode.folder().parent_path().string())));
}

}  // namespace robocell::internal
