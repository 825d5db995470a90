// Finds robots that move parts as large as houses: MJCF is in metres, and CAD programs write
// millimetres.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/inspection/robot_inspection.h"

namespace robocell::internal {
namespace {

constexpr double kLargestPart = 10;  // metres; of what a robot moves

}  // namespace

void CheckScale(const CompiledRobot& robot, Findings& findings) {
  const mjModel* m = robot.model;
  const int base = FindId(m, mjOBJ_BODY, robot.robot.base_body);
  if (base < 0) return;
  int largest = -1;
  for (int g = 0; g < m->ngeom; ++g) {
    const int body = m->geom_bodyid[g];
    if (!IsInSubtree(m, body, base) || m->body_weldid[body] == m->body_weldid[base]) continue;
    if (2 * m->geom_rbound[g] <= kLargestPart) continue;
    if (largest < 0 || m->geom_rbound[g] > m->geom_rbound[largest]) largest = g;
  }
  if (largest < 0) return;
  const bool mesh = m->geom_type[largest] == mjGEOM_MESH;
  const double size = 2 * m->geom_rbound[largest];
  findings.Warn(
      "model",
      fmt::format("{} is {:.3g} m large, and models are in metres. Is it in millimetres? {} (in "
                  "millimetres it would be {:.3g} m)",
                  Describe(m, mjOBJ_GEOM, largest), size,
                  mesh ? "Then give its <mesh> scale=\"0.001 0.001 0.001\""
                       : "Then write sizes and positions of the model a thousandth as large",
                  size / 1000));
}

}  // namespace robocell::internal
