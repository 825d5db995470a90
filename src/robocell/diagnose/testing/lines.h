// For tests only: findings as the lines that `robocell check` prints.
#pragma once

#include <string>
#include <vector>

#include "robocell/diagnose/check_robot.h"

namespace robocell {

// Returns the findings of trying a robot.
inline std::vector<std::string> LinesOfRobot(const Robot& robot,
                                             const RobotCheckOptions& options = {}) {
  std::vector<std::string> lines;
  for (const Finding& finding : CheckRobot(robot, options))
    lines.push_back(LineWithoutSubject(finding));
  return lines;
}

}  // namespace robocell
