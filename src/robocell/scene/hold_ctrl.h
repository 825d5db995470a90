// Controls that hold a pose.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/mujoco/forward.h"
#include "robocell/scene/compiled_scene.h"

namespace robocell::internal {

// Share of a joint's range by which a servo may miss its target without a warning.
inline constexpr double kServoSlack = 0.02;

// Returns true if an actuator's activation follows its control with a delay.
bool IsFiltered(const mjModel* model, int actuator);

// Returns the control with which a position servo would rest at `length`, independent of its
// control range. Unset for other actuators.
std::optional<double> FreeRestingCtrl(const mjModel* model, int actuator, double length);

// Returns the control with which a position servo rests at `length`, clamped to the control range.
// Unset for other actuators.
std::optional<double> RestingCtrl(const mjModel* model, int actuator, double length);

// Returns RestingCtrl at the length in `data`, which must be up to date (position stage).
std::optional<double> HoldingCtrl(const mjModel* model, const mjData* data, int actuator);

// Sets what lags behind the control of a position servo, its filter or its delay, to the value that
// `ctrl` leads to. Leaves other actuators alone.
void SettleLag(const mjModel* model, mjData* data, int actuator, double ctrl);

// Makes actuators with a delay see their present controls at once, as after a long rest. A keyframe
// has no past controls: the engine would pull the joints to those of its default, 0.
void ForgetPastCtrl(const mjModel* model, mjData* data);

// Control and activation that keep an actuator at rest. A servo that integrates its control
// (intvelocity) holds by its activation, at control 0; a filtered one has the same number in both.
struct HoldingInputs {
  double ctrl = 0;
  std::optional<double> act = {};  // activation of actuators that have one
};

// Unset for actuators that hold no position: motors, velocity servos, muscles, those with several
// inputs. Clamped to the ranges of control and activation. Lengths must be up to date (position
// stage).
std::optional<HoldingInputs> FindHoldingInputs(const mjModel* model, const mjData* data,
                                               int actuator);

// Returns the length at which it would rest with these inputs. For actuators with HoldingInputs.
double RestingLength(const mjModel* model, int actuator, const HoldingInputs& inputs);

// Sets the inputs. Leaves other actuators alone.
void Hold(const mjModel* model, mjData* data, int actuator);

// Marks the degrees of freedom (nv) of a group's joints, and of the joints that follow them. A
// joint of -1 is left out.
void MarkDofs(const mjModel* model, std::span<const int> joints, std::vector<bool>& dofs);

// Returns true if an actuator pulls at one of the marked degrees of freedom: directly, through a
// tendon or at a site. Moments must be up to date (position stage).
bool ActsOn(const mjModel* model, const mjData* data, int actuator, const std::vector<bool>& dofs);

// Makes every servo that acts on the marked degrees of freedom hold their new positions, whether a
// robot lists it or not. Poses have to agree with the positions. Throws EngineError with `context`.
void HoldMoved(const mjModel* model, mjData* data, const std::vector<bool>& moved,
               const std::string& context);

}  // namespace robocell::internal
