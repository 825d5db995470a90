// The results of earlier attempts at an episode's item: a part of its metadata. A refused attempt
// leaves nothing else, and with `keep: successes` neither does a failed one.
//
//   "earlier_attempts": [{"object_kind": "mug", "refused": "too far"},
//                        {"object_kind": "cup", "failed": "dropped"}]
#pragma once

#include <string>
#include <vector>

namespace robocell {

struct EarlierAttempt {
  std::string object_kind;  // "": it is not known
  bool refused = false;     // the start; else the rollout failed
  std::string reason;
};
using EarlierAttempts = std::vector<EarlierAttempt>;  // by their numbers

inline constexpr const char* kEarlierAttempts = "earlier_attempts";

// A JSON list.
std::string ToJson(const EarlierAttempts& earlier);
// Reads them from an episode's metadata; none if there are none. IoError for invalid metadata.
EarlierAttempts EarlierAttemptsIn(const std::string& metadata_json);

}  // namespace robocell
