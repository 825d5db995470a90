// What became of the attempts at an item before the one that an episode is of: a part of its
// metadata. An attempt that was refused leaves nothing else, and with `keep: successes` neither
// does one that failed.
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
// Of an episode's metadata; none when it says nothing about them. IoError for what is none of this.
EarlierAttempts EarlierAttemptsIn(const std::string& metadata_json);

}  // namespace robocell
