// Private to scene: actuators for the control modes of arms, and the groups that switch the modes
// (RobotSpec::control_modes, docs/control.md).
//
// An arm whose joints have actuators of one kind gets motors `<joint>_torque` and velocity servos
// `<joint>_velocity` for the modes that its robot declares, after all elements of its model. Each
// mode of each arm is a separate actuator group (two, if the arm's joints are only guessed:
// Limb::may_end_in_finger); the engine switches groups off by their numbers 0 ... 30. All other
// actuators, also of grippers, stay in groups that are never switched off. An arm that declares
// position only is left as authored.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robocell/mujoco/forward.h"
#include "robocell/scene/compile_log.h"
#include "robocell/spec/robot_spec.h"

struct mjSpec_;
typedef struct mjSpec_ mjSpec;

namespace robocell::internal {

// Joints that are switched together, with one actuator of the model for each.
struct Limb {
  std::string name = {};  // name of the move group, for messages
  std::vector<std::string> joints = {}, actuators = {};
  CtrlMode native = CtrlMode::kPosition;   // the kind of the model's actuators
  CtrlMode initial = CtrlMode::kPosition;  // the configured mode
  std::vector<CtrlMode> modes = {};        // all available modes, the native one first
  // True if the arm's joints are only guessed: the last may be a finger of its hand, which is then
  // not switched with the others.
  bool may_end_in_finger = false;
};

// The groups that the engine can switch are 0 ... this.
inline constexpr int kLastActuatorGroup = 30;

// Returns "joint1_torque".
std::string ModeActuatorName(const std::string& joint, CtrlMode mode);

// Returns the common kind of these actuators of a compiled model, which act on joints or tendons
// (actuator_kind.h); unset for no actuators, or if they are of several kinds or of another kind.
std::optional<CtrlMode> NativeMode(const mjModel* model, const std::vector<std::string>& actuators);

// Returns the actuators of an arm, in the order of its joints: those that it lists, else those on
// its joints of the kind that drives them (actuator_kind.h; fewer than joints if some have none).
std::vector<std::string> ArmActuators(const MoveGroupConfig& arm, const mjSpec* spec);

// Returns the limbs of a robot without move groups: the serial stretches of joints with position
// servos and, for a robot whose modes are `declared`, of joints that have velocity servos or motors
// instead. Call it before tools are mounted, whose joints do not belong to its limbs.
std::vector<Limb> SerialLimbs(mjSpec* spec, bool declared);
// Returns the limbs of its arm groups.
std::vector<Limb> ConfiguredLimbs(const RobotConfig& config, const mjSpec* spec);

// Adds actuators for `limbs` to a robot's own model, once it is complete. Returns the limbs that
// can be switched, in names of that model. Reports a problem if the configuration asks for a
// controller whose mode is not declared.
std::vector<Limb> AddModeActuators(const RobotSpec& robot, std::vector<Limb> limbs,
                                   const std::string& place, mjSpec* spec, CompileLog& log);

// The limbs of each robot of a scene, with the prefix of its names there.
struct RobotLimbs {
  std::string place;
  std::string prefix;
  bool declared = false;  // control_modes was given and is binding
  std::vector<Limb> limbs = {};
};

// Gives every limb's modes their groups and switches on the initial ones. Reports a problem if the
// groups do not suffice for declared modes, and a note if they do not for others. A possible finger
// gets its own groups while groups are left.
void AssignActuatorGroups(mjSpec* spec, const std::vector<RobotLimbs>& robots, CompileLog& log);

// Switches all other actuators that act on the joints of a limb with its own ones, such as a
// velocity servo beside each position servo. Motors stay on, since they push only as commanded, and
// so do actuators that also act on other joints, which are noted. Writes the groups into the spec
// and the model that was compiled from it. `data` has moments (position stage).
void SwitchBesides(mjSpec* spec, mjModel* model, const mjData* data,
                   const std::vector<RobotLimbs>& robots, CompileLog& log);

// Velocity servos brake like the position servos of their joints and the velocity servos beside
// those; where these do not define it, such that a position servo of the same stiffness would be
// critically damped. Those beside motors brake the inertia that their joint has at the keyframe
// `home_key` (the diagonal of the mass matrix, armature included; at the reference if < 0) within
// kVelocityTime. Written into the compiled model.
void FillVelocityGains(mjModel* model, int home_key, const std::vector<RobotLimbs>& robots);

// Seconds in which an error of the velocity of a joint with a motor falls to 1/e, with the others
// at rest.
inline constexpr double kVelocityTime = 0.05;

}  // namespace robocell::internal
