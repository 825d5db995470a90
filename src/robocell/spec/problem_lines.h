// Lists problems as one text each, for warnings, which are listed and not thrown.
#pragma once

#include <string>
#include <vector>

#include "robocell/spec/problems.h"

namespace robocell {

// "file.yaml:1:2: path: message".
inline std::vector<std::string> LinesOf(const Problems& problems) {
  std::vector<std::string> lines;
  for (const Problem& problem : problems.list()) {
    std::string& line = lines.emplace_back();
    if (!problem.source.empty()) line += problem.source + ": ";
    if (!problem.path.empty()) line += problems.Shown(problem.path) + ": ";
    line += problem.message;
  }
  return lines;
}

}  // namespace robocell
