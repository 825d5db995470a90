#include "robocell/datagen/ctrl_units.h"

#include <mujoco/mujoco.h>

#include <cmath>

namespace robocell {
namespace {

constexpr const char* kOwn = "actuator";

// "m" or "rad" for an actuator whose length is that of one joint or spatial tendon; else "".
std::string LengthUnit(const mjModel* m, int actuator) {
  const int type = m->actuator_trntype[actuator], id = m->actuator_trnid[2 * actuator];
  if (std::abs(m->actuator_gear[6 * actuator]) != 1) return "";
  if (type == mjTRN_TENDON) return m->wrap_type[m->tendon_adr[id]] == mjWRAP_JOINT ? "" : "m";
  if (type != mjTRN_JOINT && type != mjTRN_JOINTINPARENT) return "";
  if (m->jnt_type[id] == mjJNT_SLIDE) return "m";
  return m->jnt_type[id] == mjJNT_HINGE ? "rad" : "";
}

std::string UnitOf(const mjModel* m, int actuator) {
  const std::string length = LengthUnit(m, actuator);
  const mjtNum gain = m->actuator_gainprm[mjNGAIN * actuator];
  const mjtNum* bias = m->actuator_biasprm + mjNBIAS * actuator;
  const int dynamics = m->actuator_dyntype[actuator];
  const bool integrates = dynamics == mjDYN_INTEGRATOR;
  const bool follows =
      dynamics == mjDYN_NONE || dynamics == mjDYN_FILTER || dynamics == mjDYN_FILTEREXACT;
  if (length.empty() || m->actuator_ctrlnum[actuator] != 1 ||
      m->actuator_gaintype[actuator] != mjGAIN_FIXED || !(follows || integrates))
    return kOwn;
  if (m->actuator_biastype[actuator] == mjBIAS_NONE)
    return gain == 1 && follows ? (length == "m" ? "N" : "N m") : kOwn;
  if (m->actuator_biastype[actuator] != mjBIAS_AFFINE || bias[0] != 0) return kOwn;
  const bool position = bias[1] == -gain;
  const bool velocity = bias[1] == 0 && bias[2] == -gain;
  if (integrates) return position ? length + "/s" : kOwn;
  return position ? length : velocity ? length + "/s" : kOwn;
}

}  // namespace

std::vector<std::string> CtrlUnits(const mjModel* model) {
  std::vector<std::string> units;
  for (int a = 0; a < model->nactuator; ++a)
    units.insert(units.end(), static_cast<size_t>(model->actuator_ctrlnum[a]), UnitOf(model, a));
  return units;
}

}  // namespace robocell
