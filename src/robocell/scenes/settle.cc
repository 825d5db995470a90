#include "robocell/scenes/settle.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robocell/mujoco/names.h"
#include "robocell/robot/control_ticks.h"

namespace robocell::internal {
namespace {

constexpr double kSeconds = 0.4;      // time between checks of the objects ...
constexpr int kChecks = 6;            // ... and the number of checks
constexpr double kRestSpeed = 0.005;  // m/s below which an object rests ...
constexpr double kRestTurn = 0.1;     // ... and rad/s

// Returns the name of an object that is not at rest; "" if all are. Parked ones do not count.
std::string MovingObject(const Scene& scene, const std::vector<std::string>& objects) {
  const mjModel* m = scene.model();
  for (const std::string& name : objects) {
    const ObjectRecord& object = scene.compiled()->object(name);
    if (!object.free_joint) continue;
    const mjtNum* v =
        scene.data()->qvel + m->jnt_dofadr[FindId(m, mjOBJ_JOINT, *object.free_joint)];
    if (mju_norm3(v) > kRestSpeed || mju_norm3(v + 3) > kRestTurn) return object.name;
  }
  return "";
}

}  // namespace

std::string Settle(Scene& scene, std::span<Robot> robots, const std::string& target_body,
                   const SettleOptions& options) {
  const auto target = [&] { return target_body.empty() ? Pose() : scene.body_pose(target_body); };
  const Pose before = target();
  const double tick = scene.timestep() * options.sim_steps;
  const ControlTicks between{.ticks = std::max(1, static_cast<int>(std::lround(kSeconds / tick))),
                             .sim_steps = options.sim_steps};
  std::string moving = "something";
  for (int look = 0; look < kChecks && !moving.empty() && !ShouldStop(options.stop); ++look) {
    const StepResult result = RunControlTicks(scene, robots, between);
    if (!result.ok()) return result.message;
    moving = MovingObject(scene, options.resting.value_or(scene.object_names()));
  }
  if (!moving.empty()) return moving + " still moves";
  const Pose after = target();
  if ((after.translation() - before.translation()).norm() > options.most_drift) {
    return "the target rolled away or fell off its support";
  }
  return "";
}

}  // namespace robocell::internal
