#include "robocell/scene/state_number.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/names.h"

namespace robocell {
namespace {

std::string OfPosition(const mjModel* m, int index) {
  int joint = static_cast<int>(m->njnt) - 1;
  while (joint > 0 && m->jnt_qposadr[joint] > index) --joint;
  return "the position of " + Describe(m, mjOBJ_JOINT, joint);
}

std::string OfDof(const mjModel* m, const char* what, int dof) {
  return fmt::format("the {} of {}", what, Describe(m, mjOBJ_JOINT, m->dof_jntid[dof]));
}

std::string OfControl(const mjModel* m, int index) {
  int actuator = static_cast<int>(m->nactuator) - 1;
  while (actuator > 0 && m->actuator_ctrladr[actuator] > index) --actuator;
  return "the control of " + Describe(m, mjOBJ_ACTUATOR, actuator);
}

std::string OfMocap(const mjModel* m, const char* what, int mocap) {
  for (int body = 0; body < m->nbody; ++body) {
    if (m->body_mocapid[body] == mocap)
      return fmt::format("the {} of {}", what, Describe(m, mjOBJ_BODY, body));
  }
  return fmt::format("the {} of mocap body {}", what, mocap);
}

std::string OfPart(const mjModel* m, int part, int index) {
  switch (part) {
    case mjSTATE_TIME:
      return "the time";
    case mjSTATE_QPOS:
      return OfPosition(m, index);
    case mjSTATE_QVEL:
      return OfDof(m, "velocity", index);
    case mjSTATE_WARMSTART:
      return OfDof(m, "warm start", index);
    case mjSTATE_CTRL:
      return OfControl(m, index);
    case mjSTATE_QFRC_APPLIED:
      return OfDof(m, "applied force", index);
    case mjSTATE_XFRC_APPLIED:
      return "the wrench on " + Describe(m, mjOBJ_BODY, index / 6);
    case mjSTATE_MOCAP_POS:
      return OfMocap(m, "position", index / 3);
    case mjSTATE_MOCAP_QUAT:
      return OfMocap(m, "orientation", index / 4);
    case mjSTATE_ACT:
      return fmt::format("number {} of the activations", index);
    default:
      return fmt::format("number {} of what else the engine keeps", index);
  }
}

}  // namespace

std::string DescribeStateNumber(const mjModel* m, size_t index) {
  auto left = static_cast<int>(index);
  for (int bit = 0; bit < mjNSTATE; ++bit) {
    const int part = mjSTATE_INTEGRATION & (1 << bit);
    const int size = part ? static_cast<int>(mj_stateSize(m, part)) : 0;
    if (left < size) return OfPart(m, part, left);
    left -= size;
  }
  return fmt::format("number {}", index);
}

}  // namespace robocell
