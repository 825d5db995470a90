// Hooks: methods of tasks, experts and samplers, and functions of features, which users may write.
// HookError: one of them failed, or returned what cannot be used. Runs end the attempt with it,
// whoever noticed.
#pragma once

#include <string>

#include "robocell/base/error.h"

namespace robocell {

class HookError : public ArgumentError {
 public:
  // In Python: TypeError, ArgumentError, Error.
  enum class Kind { kType, kValue, kFailed };
  // `place`: where the hook is written, "my_task.py:12, in judge"; it ends the message. "" when it
  // is not known yet, or for compiled code.
  HookError(const std::string& message, const std::string& place, Kind kind = Kind::kValue)
      : ArgumentError(place.empty() ? message : message + " (" + place + ")"),
        has_place_(!place.empty()),
        kind_(kind) {}
  bool has_place() const { return has_place_; }
  Kind kind() const { return kind_; }

 private:
  bool has_place_;
  Kind kind_;
};

// What has hooks.
class Hooks {
 public:
  virtual ~Hooks() = default;
  // Where a method is written, as HookError has it; "" for compiled code.
  virtual std::string PlaceOfHook(const char* /*method*/) const { return ""; }
};

}  // namespace robocell
