#include "robocell/rollout/earlier_attempts.h"

#include <nlohmann/json.hpp>

#include "robocell/base/error.h"

namespace robocell {

using Json = nlohmann::json;

std::string ToJson(const EarlierAttempts& earlier) {
  Json list = Json::array();
  for (const auto& [object_kind, refused, reason] : earlier)
    list.push_back({{"object_kind", object_kind}, {refused ? "refused" : "failed", reason}});
  return list.dump();
}

EarlierAttempts EarlierAttemptsIn(const std::string& metadata_json) try {
  EarlierAttempts earlier;
  const Json metadata = Json::parse(metadata_json);
  if (!metadata.contains(kEarlierAttempts)) return earlier;
  for (const Json& attempt : metadata.at(kEarlierAttempts)) {
    const bool refused = attempt.contains("refused");
    earlier.push_back({.object_kind = attempt.at("object_kind"),
                       .refused = refused,
                       .reason = attempt.at(refused ? "refused" : "failed")});
  }
  return earlier;
} catch (const Json::exception& error) {
  throw IoError(std::string("its ") + kEarlierAttempts + " cannot be read: " + error.what());
}

}  // namespace robocell
