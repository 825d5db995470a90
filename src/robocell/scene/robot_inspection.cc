#include "robocell/scene/robot_inspection.h"

#include <atomic>

namespace robocell::internal {
namespace {

std::atomic<RobotInspection> installed_inspection = nullptr;

}  // namespace

bool InstallRobotInspection(RobotInspection inspection) {
  installed_inspection = inspection;
  return true;
}

RobotInspection InstalledRobotInspection() { return installed_inspection; }

void InspectRobot(const CompiledRobot& robot, CompileLog& log) {
  if (const RobotInspection inspection = installed_inspection) inspection(robot, log);
}

}  // namespace robocell::internal
