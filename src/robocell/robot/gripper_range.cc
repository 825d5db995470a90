#include "robocell/robot/gripper_range.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/owners.h"
#include "robocell/mujoco/step.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/once_per_model.h"

namespace robocell {
namespace {

constexpr double kSettleSeconds = 1.0;
constexpr const char* kContext = "measuring a gripper";

ModelPtr AloneWithoutGravity(const mjModel* model, int robot_body) {
  ModelPtr alone = CopyModel(model);
  mjModel* m = alone.get();
  std::fill_n(m->opt.gravity, 3, 0.0);
  const std::vector<bool> inside = SubtreeMask(m, robot_body);
  for (int g = 0; g < m->ngeom; ++g) {
    if (!inside[m->geom_bodyid[g]]) m->geom_contype[g] = m->geom_conaffinity[g] = 0;
  }
  return alone;
}

DataPtr DataAtHome(const mjModel* m, int home_key) {
  DataPtr data = MakeData(m);
  mjData* d = data.get();
  if (home_key >= 0) Guarded(kContext, d, [&] { mj_resetDataKeyframe(m, d, home_key); });
  return data;
}

double SettledDistance(const mjModel* m, mjData* d, const GripperParts& parts, double ctrl) {
  for (const int a : parts.ctrl_addresses) d->ctrl[a] = ctrl;
  const int steps = static_cast<int>(std::ceil(kSettleSeconds / m->opt.timestep));
  const StepResult result = Step(m, d, steps, kContext);
  if (!result.ok()) throw EngineError(std::string(kContext) + ": " + result.message);
  Guarded(kContext, d, [&] { mj_kinematics(m, d); });
  return FingerDistance(m, d, parts.pair.fingers[0], parts.pair.fingers[1]);
}

std::array<double, 2> MeasuredDistances(const Scene& scene, const GripperParts& parts,
                                        std::array<double, 2> ctrl) {
  const ModelPtr model = AloneWithoutGravity(scene.model(), parts.robot_body);
  const DataPtr data = DataAtHome(model.get(), scene.compiled()->home_key());
  std::array<double, 2> distances;
  for (int i = 0; i < 2; ++i) {
    distances[i] = SettledDistance(model.get(), data.get(), parts, ctrl[i]);
  }
  return distances;
}

std::string FingerName(const Finger& finger) {
  return fmt::format("site {} body {} geoms {}", finger.site, finger.body,
                     fmt::join(finger.geoms, " "));
}

}  // namespace

std::array<double, 2> SettledFingerDistances(const Scene& scene, const GripperParts& parts,
                                             std::array<double, 2> ctrl) {
  const std::string what =
      fmt::format("fingers of body {}: {}, {}; controls {}: {}, {}", parts.robot_body,
                  FingerName(parts.pair.fingers[0]), FingerName(parts.pair.fingers[1]),
                  fmt::join(parts.ctrl_addresses, " "), ctrl[0], ctrl[1]);
  const std::vector<double> distances = OncePerModel(*scene.compiled(), what, [&] {
    const auto [first, second] = MeasuredDistances(scene, parts, ctrl);
    return std::vector<double>{first, second};
  });
  return {distances[0], distances[1]};
}

}  // namespace robocell
