// Private to rollout: reads episodes that anybody may have edited. A missing field, or one of
// another type or length, is an IoError that names file and field.
//
//   const EpisodeJson metadata = EpisodeJson::Metadata(episode);
//   const std::string name = metadata.At("environment").At("name").AsText();
//   const auto config = metadata.At("environment").At("config").AsSpec<EnvConfig>();
//   const std::vector<double> rewards = ReadSteps<double>(episode, "reward");
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>
#include <nlohmann/json_fwd.hpp>

#include "robocell/base/error.h"
#include "robocell/data/episode_reader.h"
#include "robocell/spec/yaml.h"

namespace robocell::internal {

// A value of episode.json with its path in the file.
class EpisodeJson {
 public:
  static EpisodeJson Metadata(const Episode& episode);
  static EpisodeJson Results(const Episode& episode);
  static EpisodeJson Versions(const Episode& episode);

  const nlohmann::json& value() const { return *value_; }
  // Returns the field of an object. Throws IoError if there is none.
  EpisodeJson At(const std::string& key) const;
  // Returns the field; unset if there is none, or if this is not an object.
  std::optional<EpisodeJson> Find(const std::string& key) const;
  // Returns the values of a list.
  std::vector<EpisodeJson> Items() const;
  std::string AsText() const;
  bool AsBool() const;
  std::vector<double> AsNumbers() const;
  // Parses a spec from the YAML that ToYaml writes.
  template <class Spec>
  Spec AsSpec() const {
    const std::string text = AsText();
    try {
      return FromYamlUnchecked<Spec>(text);
    } catch (const SpecError& error) {
      ThrowNot("what robocell writes there", error.what());
    }
  }
  // Throws IoError: the value is not `what`.
  [[noreturn]] void ThrowNot(const std::string& what, const std::string& detail = "") const;

 private:
  EpisodeJson(std::string file, std::string path, nlohmann::json value);

  std::string file_, path_;
  std::shared_ptr<const nlohmann::json> value_;
};

// Throws IoError unless a column has as many rows as the episode.
void RequireRowOfEachStep(const Episode& episode, const std::string& column);

// Returns the numbers of a column of the steps, row by row.
template <class T>
std::vector<T> ReadSteps(const Episode& episode, const std::string& column) {
  RequireRowOfEachStep(episode, column);
  return episode.Read<T>(column);
}

}  // namespace robocell::internal
