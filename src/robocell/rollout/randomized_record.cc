#include "robocell/rollout/randomized_record.h"

#include <vector>
#include <nlohmann/json.hpp>

#include "robocell/rollout/episode_reading.h"

namespace robocell::internal {

nlohmann::json RandomizedRecord(const RandomizedValues& values) {
  nlohmann::json record = nlohmann::json::object();
  for (const auto& [name, value] : values.entries()) {
    if (!value->word.empty())
      record[name] = value->word;
    else if (value->numbers.size() == 1)
      record[name] = value->numbers.front();
    else
      record[name] = value->numbers;
  }
  return record;
}

RandomizedValues RandomizedOf(const Episode& episode) {
  RandomizedValues values;
  const auto record = EpisodeJson::Metadata(episode).Find(kRandomized);
  if (!record) return values;
  if (!record->value().is_object()) record->ThrowNot("an object of values by name");
  for (const auto& [name, json] : record->value().items()) {
    const EpisodeJson value = record->At(name);
    if (json.is_string())
      values[name].word = value.AsText();
    else if (json.is_number())
      values[name].numbers = {json.get<double>()};
    else
      values[name].numbers = value.AsNumbers();
  }
  return values;
}

}  // namespace robocell::internal
