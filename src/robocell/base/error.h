// The error hierarchy of robocell.
//
// A message gives the problem, its place, the alternatives and the next step, for example
//   robot 'left': no joint 'joint8'. Its joints: joint1 ... joint7. Did you mean 'joint7'?
// base/suggestions.h helps to write such messages. Results of normal operation (IK not converged,
// diverged, grasp failed) are values, not exceptions.
//
// In Python: Error is a RuntimeError; SpecError and ArgumentError are also ValueErrors,
// NotFoundError also a LookupError, IoError also an OSError.
#pragma once

#include <stdexcept>
#include <string>

namespace robocell {

// Base of everything robocell throws.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(message) {}
};

// A spec, robot file or run file is wrong. Lists every problem found, one per line.
class SpecError : public Error {
 public:
  using Error::Error;
};

// A requested name does not exist.
class NotFoundError : public Error {
 public:
  using Error::Error;
};

// An argument has the wrong shape, range or kind.
class ArgumentError : public Error {
 public:
  using Error::Error;
};

// The object was closed, or what it refers to was removed from the scene.
class ClosedError : public Error {
 public:
  using Error::Error;
};

// The simulation diverged and the caller requested an exception instead of a value.
class DivergedError : public Error {
 public:
  using Error::Error;
};

// MuJoCo reported an error.
class EngineError : public Error {
 public:
  using Error::Error;
};

// A file, folder, pipe or child process failed; the message carries the path and the system's
// reason.
class IoError : public Error {
 public:
  // `system_error` is the errno of the failed call. 0 if no call failed: then the content is wrong,
  // and it will be the same the next time.
  explicit IoError(const std::string& message, int system_error = 0)
      : Error(message), system_error_(system_error) {}
  int system_error() const { return system_error_; }

 private:
  int system_error_ = 0;
};

}  // namespace robocell
