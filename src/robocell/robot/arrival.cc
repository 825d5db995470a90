#include "robocell/robot/arrival.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robocell/mujoco/names.h"

namespace robocell::internal {

std::vector<double> ArrivalTolerances(const Robot& robot, const std::string& group) {
  const mjModel* m = robot.scene().model();
  const RobotConfig& config = robot.config();
  std::vector<double> tolerances;
  for (const std::string& joint : robot.group(group).joint_names()) {
    const bool slide = m->jnt_type[FindId(m, mjOBJ_JOINT, joint)] == mjJNT_SLIDE;
    tolerances.push_back(slide ? config.slide_arrival_tolerance() : config.arrival_tolerance);
  }
  return tolerances;
}

double LargestDelay(const Robot& robot, const std::string& group) {
  const mjModel* m = robot.scene().model();
  double delay = 0;
  for (const std::string& actuator : robot.group(group).actuator_names())
    delay = std::max<double>(delay, m->actuator_delay[FindId(m, mjOBJ_ACTUATOR, actuator)]);
  return delay;
}

bool AreWithin(std::span<const double> q, std::span<const double> target,
               std::span<const double> tolerances, double times) {
  for (size_t i = 0; i < q.size(); ++i) {
    if (std::abs(q[i] - target[i]) > times * tolerances[i]) return false;
  }
  return true;
}

}  // namespace robocell::internal
