#include "robocell/features/units.h"

#include <mujoco/mujoco.h>

#include <cmath>

#include "robocell/mujoco/actuators.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/hold_ctrl.h"

namespace robocell::internal {
namespace {

constexpr const char* kOwn = "actuator";

// "m" or "rad" for an actuator whose length is that of one joint or spatial tendon; else "".
std::string LengthUnit(const mjModel* m, int actuator) {
  const int type = m->actuator_trntype[actuator], id = m->actuator_trnid[2 * actuator];
  if (std::abs(Gear(m, actuator)) != 1) return "";
  if (type == mjTRN_TENDON) return m->wrap_type[m->tendon_adr[id]] == mjWRAP_JOINT ? "" : "m";
  if (!IsOnJoint(type)) return "";
  return m->jnt_type[id] == mjJNT_BALL || m->jnt_type[id] == mjJNT_FREE ? "" : JointUnit(m, id);
}

// Returns the unit of an actuator's control, or "actuator" for a meaning of the actuator's own.
std::string UnitOf(const mjModel* m, int actuator) {
  const std::string length = LengthUnit(m, actuator);
  const int dynamics = m->actuator_dyntype[actuator];
  const bool integrates = dynamics == mjDYN_INTEGRATOR;
  const bool follows = dynamics == mjDYN_NONE || IsFiltered(m, actuator);
  const auto kind = ActuatorForceKind(m, actuator);
  if (length.empty() || !kind || !(follows || integrates)) return kOwn;
  const mjtNum gain = m->actuator_gainprm[mjNGAIN * actuator];
  const mjtNum* bias = m->actuator_biasprm + mjNBIAS * actuator;
  if (kind == CtrlMode::kPosition && bias[0] == 0 && bias[1] == -gain)
    return integrates ? length + "/s" : length;
  if (kind == CtrlMode::kVelocity && follows) return length + "/s";
  if (kind == CtrlMode::kTorque && follows && gain == 1) return length == "m" ? "N" : "N m";
  return kOwn;
}

}  // namespace

std::string JointUnit(const mjModel* model, int joint) {
  return model->jnt_type[joint] == mjJNT_SLIDE ? "m" : "rad";
}

std::vector<std::string> CtrlUnits(const mjModel* model) {
  std::vector<std::string> units;
  for (int a = 0; a < model->nactuator; ++a)
    units.insert(units.end(), static_cast<size_t>(model->actuator_ctrlnum[a]), UnitOf(model, a));
  return units;
}

}  // namespace robocell::internal
