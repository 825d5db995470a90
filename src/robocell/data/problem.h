// A problem with one file of a dataset.
#pragma once

#include <exception>
#include <string>

namespace robocell {

enum class ProblemKind {
  kDamage,      // it is not what was written, or not there
  kForeign,     // it does not belong there; what does is whole
  kUnreadable,  // this machine or version cannot judge it: access, a broken disk, a missing decoder
};

struct VerifyProblem {
  std::string episode;  // its id; "" for the dataset itself
  std::string file;     // within the episode, or within the dataset
  std::string reason;
  ProblemKind kind = ProblemKind::kDamage;
  // "pick-000017/steps.h5: 4096 of 9216 bytes are there".
  std::string Text() const;
};

// An error of the system says nothing about what was written; any other is about the bytes.
ProblemKind KindOf(const std::exception& error);

}  // namespace robocell
