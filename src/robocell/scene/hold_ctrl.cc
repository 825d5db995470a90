#include "robocell/scene/hold_ctrl.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/joint_followers.h"
#include "robocell/scene/actuator_kind.h"

namespace robocell::internal {
namespace {

double Clamped(double value, bool limited, const mjtNum* range) {
  return limited ? std::clamp(value, range[0], range[1]) + 0.0 : value;  // not -0
}

double ClampedCtrl(const mjModel* model, int actuator, double ctrl) {
  const int input = model->actuator_ctrladr[actuator];
  return Clamped(ctrl, model->actuator_ctrllimited[input], model->actuator_ctrlrange + 2 * input);
}

// Returns the factor of the gain: the control, or the activation that results from it.
double RestingInput(const mjModel* model, int actuator, double length) {
  const mjtNum* bias = model->actuator_biasprm + mjNBIAS * actuator;
  const mjtNum gain = model->actuator_gainprm[mjNGAIN * actuator];
  // The quotients come first: 1 and 0 for a plain servo, whose control is then the length to the
  // bit.
  return -bias[1] / gain * length - bias[0] / gain + 0.0;
}

// Returns true for an actuator with one activation, the integral of the control.
bool IsIntegrated(const mjModel* model, int actuator) {
  return model->actuator_dyntype[actuator] == mjDYN_INTEGRATOR &&
         model->actuator_actnum[actuator] == 1 &&
         ActuatorForceKind(model, actuator) == CtrlMode::kPosition;
}

// Fills what the engine remembers of a delayed actuator's controls.
void ForgetPastCtrl(const mjModel* model, mjData* data, int actuator, const mjtNum* ctrl) {
  if (model->actuator_historyadr[actuator] < 0) return;
  const int samples = model->actuator_history[2 * static_cast<ptrdiff_t>(actuator)];
  std::vector<mjtNum> past;
  past.reserve(static_cast<size_t>(samples) * model->actuator_ctrlnum[actuator]);
  for (int i = 0; i < samples; ++i)
    past.insert(past.end(), ctrl, ctrl + model->actuator_ctrlnum[actuator]);
  mj_initCtrlHistory(model, data, actuator, nullptr, past.data());
}

}  // namespace

std::optional<double> FreeRestingCtrl(const mjModel* model, int actuator, double length) {
  if (!IsPositionServo(model, actuator)) return std::nullopt;
  return RestingInput(model, actuator, length);
}

std::optional<double> RestingCtrl(const mjModel* model, int actuator, double length) {
  std::optional<double> ctrl = FreeRestingCtrl(model, actuator, length);
  if (ctrl) ctrl = ClampedCtrl(model, actuator, *ctrl);
  return ctrl;
}

std::optional<double> HoldingCtrl(const mjModel* model, const mjData* data, int actuator) {
  return RestingCtrl(model, actuator, data->actuator_length[model->actuator_outadr[actuator]]);
}

bool IsFiltered(const mjModel* model, int actuator) {
  return model->actuator_dyntype[actuator] == mjDYN_FILTER ||
         model->actuator_dyntype[actuator] == mjDYN_FILTEREXACT;
}

void SettleLag(const mjModel* model, mjData* data, int actuator, double ctrl) {
  const int activation = IsFiltered(model, actuator) ? model->actuator_actadr[actuator] : -1;
  const bool lags = activation >= 0 || model->actuator_historyadr[actuator] >= 0;
  if (!lags || !IsPositionServo(model, actuator)) return;
  ForgetPastCtrl(model, data, actuator, &ctrl);
  if (activation >= 0) data->act[activation] = ctrl;
}

void ForgetPastCtrl(const mjModel* model, mjData* data) {
  for (int actuator = 0; actuator < model->nactuator; ++actuator)
    ForgetPastCtrl(model, data, actuator, data->ctrl + model->actuator_ctrladr[actuator]);
}

std::optional<HoldingInputs> FindHoldingInputs(const mjModel* model, const mjData* data,
                                               int actuator) {
  const double length = data->actuator_length[model->actuator_outadr[actuator]];
  if (IsIntegrated(model, actuator)) {
    const double act =
        Clamped(RestingInput(model, actuator, length), model->actuator_actlimited[actuator],
                model->actuator_actrange + 2 * static_cast<ptrdiff_t>(actuator));
    return HoldingInputs{ClampedCtrl(model, actuator, 0), act};
  }
  const std::optional<double> ctrl = RestingCtrl(model, actuator, length);
  if (!ctrl) return std::nullopt;
  const bool has_act = IsFiltered(model, actuator) && model->actuator_actadr[actuator] >= 0;
  return HoldingInputs{*ctrl, has_act ? ctrl : std::nullopt};
}

double RestingLength(const mjModel* model, int actuator, const HoldingInputs& inputs) {
  const mjtNum* bias = model->actuator_biasprm + mjNBIAS * actuator;
  const mjtNum gain = model->actuator_gainprm[mjNGAIN * actuator];
  const double input = IsIntegrated(model, actuator) ? inputs.act.value_or(0) : inputs.ctrl;
  return -(gain * input + bias[0]) / bias[1];
}

void Hold(const mjModel* model, mjData* data, int actuator) {
  const auto inputs = FindHoldingInputs(model, data, actuator);
  if (!inputs) return;
  data->ctrl[model->actuator_ctrladr[actuator]] = inputs->ctrl;
  ForgetPastCtrl(model, data, actuator, &inputs->ctrl);
  if (inputs->act) data->act[model->actuator_actadr[actuator]] = *inputs->act;
}

void MarkDofs(const mjModel* model, std::span<const int> joints, std::vector<bool>& dofs) {
  for (const int joint : joints) {
    if (joint < 0) continue;
    const int end = joint + 1 < model->njnt ? model->jnt_dofadr[joint + 1] : int(model->nv);
    for (int dof = model->jnt_dofadr[joint]; dof < end; ++dof) dofs[dof] = true;
  }
  for (const JointFollower& follower : FollowersOf(model, joints))
    dofs[model->jnt_dofadr[follower.joint]] = true;
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

void HoldMoved(const mjModel* model, mjData* data, const std::vector<bool>& moved,
               const std::string& context) {
  if (std::find(moved.begin(), moved.end(), true) == moved.end()) return;
  // Computes all that the length of an actuator depends on, which excludes contacts and masses.
  Guarded(context, data, [&] {
    mj_tendon(model, data);
    mj_transmission(model, data);
  });
  for (int actuator = 0; actuator < model->nactuator; ++actuator) {
    if (ActsOn(model, data, actuator, moved)) Hold(model, data, actuator);
  }
}

}  // namespace robocell::internal
