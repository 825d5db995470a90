#include "robocell/robot/control_ticks.h"

namespace robocell {

StepResult RunControlTicks(Scene& scene, std::span<Robot> robots, ControlTicks count,
                           const OnControlTick& on_tick) {
  StepResult result;
  for (int tick = 0; tick < count.ticks && result.ok(); ++tick) {
    for (Robot& robot : robots) robot.Update();
    if (on_tick) on_tick(scene.model(), scene.data());
    const int before = result.steps;
    result = scene.StepN(count.sim_steps);
    const bool is_whole = result.steps == count.sim_steps;
    result.steps += before;
    if (!is_whole) break;
  }
  return result;
}

}  // namespace robocell
