#include "robocell/scene/hold_ctrl.h"

#include <mujoco/mujoco.h>

#include <algorithm>

namespace robocell {

bool IsPositionServo(const mjModel* model, int actuator) {
  const int dynamics = model->actuator_dyntype[actuator];
  return model->actuator_gaintype[actuator] == mjGAIN_FIXED &&
         model->actuator_biastype[actuator] == mjBIAS_AFFINE &&
         model->actuator_ctrlnum[actuator] == 1 &&
         (dynamics == mjDYN_NONE || dynamics == mjDYN_FILTER || dynamics == mjDYN_FILTEREXACT) &&
         model->actuator_gainprm[mjNGAIN * actuator] != 0 &&
         model->actuator_biasprm[mjNBIAS * actuator + 1] < 0;
}

std::optional<double> RestingCtrl(const mjModel* model, int actuator, double length) {
  if (!IsPositionServo(model, actuator)) return std::nullopt;
  const mjtNum* bias = model->actuator_biasprm + mjNBIAS * actuator;
  const mjtNum gain = model->actuator_gainprm[mjNGAIN * actuator];
  // The quotients first: 1 and 0 for a plain servo, whose control is then the length to the bit.
  double ctrl = -bias[1] / gain * length - bias[0] / gain;
  const int input = model->actuator_ctrladr[actuator];
  const mjtNum* range = model->actuator_ctrlrange + 2 * input;
  if (model->actuator_ctrllimited[input]) ctrl = std::clamp(ctrl, range[0], range[1]);
  return ctrl + 0.0;  // not -0
}

std::optional<double> HoldingCtrl(const mjModel* model, const mjData* data, int actuator) {
  return RestingCtrl(model, actuator, data->actuator_length[model->actuator_outadr[actuator]]);
}

}  // namespace robocell
