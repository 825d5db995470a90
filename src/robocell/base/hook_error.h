// Hooks: methods of tasks, experts and samplers, and functions of features, which users may write.
// HookError: a hook failed, or returned an unusable value. It ends the attempt of a run, no matter
// which code detected it.
#pragma once

#include <string>

#include "robocell/base/error.h"

namespace robocell {

class HookError : public ArgumentError {
 public:
  // Kinds of errors; in Python: TypeError, ArgumentError, Error.
  enum class Kind { kType, kValue, kFailed };
  // `place`: where the hook is written, "my_task.py:12, in judge"; it ends the message. "" if
  // unknown, or for compiled code.
  HookError(const std::string& message, const std::string& place, Kind kind = Kind::kValue)
      : ArgumentError(place.empty() ? message : message + " (" + place + ")"),
        has_place_(!place.empty()),
        kind_(kind) {}
  bool has_place() const { return has_place_; }
  Kind kind() const { return kind_; }
  // Returns the calls that led to the error, one a line; "" for compiled code.
  virtual std::string trace() const { return ""; }

 private:
  bool has_place_;
  Kind kind_;
};

// An object with hooks.
class Hooks {
 public:
  virtual ~Hooks() = default;
  // Returns where a method is written, in the form of HookError; "" for compiled code.
  virtual std::string PlaceOfHook(const char* /*method*/) const { return ""; }
};

}  // namespace robocell
