#include "robocell/scene/hold_ctrl.h"

#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/mujoco/names.h"
#include "robocell/scene/actuator_kind.h"

namespace robocell {

std::optional<double> FreeRestingCtrl(const mjModel* model, int actuator, double length) {
  if (!IsPositionServo(model, actuator)) return std::nullopt;
  const mjtNum* bias = model->actuator_biasprm + mjNBIAS * actuator;
  const mjtNum gain = model->actuator_gainprm[mjNGAIN * actuator];
  // The quotients first: 1 and 0 for a plain servo, whose control is then the length to the bit.
  return -bias[1] / gain * length - bias[0] / gain + 0.0;  // not -0
}

std::optional<double> RestingCtrl(const mjModel* model, int actuator, double length) {
  std::optional<double> ctrl = FreeRestingCtrl(model, actuator, length);
  const int input = model->actuator_ctrladr[actuator];
  const mjtNum* range = model->actuator_ctrlrange + 2 * input;
  if (ctrl && model->actuator_ctrllimited[input])
    ctrl = std::clamp(*ctrl, range[0], range[1]) + 0.0;
  return ctrl;
}

std::optional<double> HoldingCtrl(const mjModel* model, const mjData* data, int actuator) {
  return RestingCtrl(model, actuator, data->actuator_length[model->actuator_outadr[actuator]]);
}

bool IsFiltered(const mjModel* model, int actuator) {
  return model->actuator_dyntype[actuator] == mjDYN_FILTER ||
         model->actuator_dyntype[actuator] == mjDYN_FILTEREXACT;
}

void SettleFilter(const mjModel* model, mjData* data, int actuator, double ctrl) {
  if (!IsFiltered(model, actuator) || !IsPositionServo(model, actuator)) return;
  const int activation = model->actuator_actadr[actuator];
  if (activation >= 0) data->act[activation] = ctrl;
}

void Hold(const mjModel* model, mjData* data, int actuator) {
  const auto ctrl = HoldingCtrl(model, data, actuator);
  if (!ctrl) return;
  data->ctrl[model->actuator_ctrladr[actuator]] = *ctrl;
  SettleFilter(model, data, actuator, *ctrl);
}

void MarkDofs(const mjModel* model, const RobotRecord& robot, const MoveGroupConfig& group,
              std::vector<bool>& dofs) {
  for (const std::string& name : group.joints) {
    const int joint = FindId(model, mjOBJ_JOINT, robot.prefix + name);
    if (joint < 0) continue;
    const int end = joint + 1 < model->njnt ? model->jnt_dofadr[joint + 1] : int(model->nv);
    for (int dof = model->jnt_dofadr[joint]; dof < end; ++dof) dofs[dof] = true;
  }
}

bool ActsOn(const mjModel* model, const mjData* data, int actuator, const std::vector<bool>& dofs) {
  const int first = model->actuator_outadr[actuator], count = model->actuator_outnum[actuator];
  for (int output = first; output < first + count; ++output) {
    const int begin = data->moment_rowadr[output], end = begin + data->moment_rownnz[output];
    for (int i = begin; i < end; ++i) {
      if (data->actuator_moment[i] != 0 && dofs[data->moment_colind[i]]) return true;
    }
  }
  return false;
}

}  // namespace robocell
