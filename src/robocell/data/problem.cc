#include "robocell/data/problem.h"

#include <fmt/format.h>

#include "robocell/base/error.h"

namespace robocell {

std::string VerifyProblem::Text() const {
  const std::string place = episode + (episode.empty() || file.empty() ? "" : "/") + file;
  return fmt::format("{}: {}", place, reason);
}

ProblemKind KindOf(const std::exception& error) {
  const auto* io = dynamic_cast<const IoError*>(&error);
  return io != nullptr && io->system_error() != 0 ? ProblemKind::kUnreadable : ProblemKind::kDamage;
}

}  // namespace robocell
