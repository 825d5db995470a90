// Private to scene: actuators for the control modes of arms, and the groups by which modes are
// switched (RobotSpec::control_modes, docs/control.md).
//
// An arm whose joints have actuators of one kind gets motors `<joint>_torque` and velocity servos
// `<joint>_velocity` for the modes that its robot declares, after all that its model has. Each mode
// of each arm is an actuator group of its own (two, where nobody said which joints are the arm's:
// Limb::may_end_in_finger); the engine switches groups off by their numbers 0 ... 30. All other
// actuators, grippers' too, stay in groups that are never switched off. An arm that declares
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

// Joints that are switched together, with the actuators that the model has for them, one each.
struct Limb {
  std::string name = {};  // of the move group, for messages
  std::vector<std::string> joints = {}, actuators = {};
  CtrlMode native = CtrlMode::kPosition;   // what the model's actuators are
  CtrlMode initial = CtrlMode::kPosition;  // what the configuration asks for
  std::vector<CtrlMode> modes = {};        // all that it can be switched to, the native one first
  // Nobody said which joints are the arm's: the last may be a finger of its hand, and then stays as
  // it is where the others are switched.
  bool may_end_in_finger = false;
};

// The groups that the engine can switch are 0 ... this.
inline constexpr int kLastActuatorGroup = 30;

// "joint1_torque".
std::string ModeActuatorName(const std::string& joint, CtrlMode mode);

// What these actuators of a compiled model, which act on joints, are (actuator_kind.h); nothing for
// none, when they are of several kinds, or of another.
std::optional<CtrlMode> NativeMode(const mjModel* model, const std::vector<std::string>& actuators);

// The actuators of an arm, in the order of its joints: those that it lists, else those on its
// joints of the kind that drives them (actuator_kind.h; fewer than joints when some have none).
std::vector<std::string> ArmActuators(const MoveGroupConfig& arm, const mjSpec* spec);

// The limbs of a robot without move groups: the serial stretches of joints with position servos
// and, for a robot whose modes are `declared`, of joints that have velocity servos or motors
// instead. To be asked before tools are mounted, whose joints are none of its limbs.
std::vector<Limb> SerialLimbs(mjSpec* spec, bool declared);
// Those of its arm groups.
std::vector<Limb> ConfiguredLimbs(const RobotConfig& config, const mjSpec* spec);

// Adds actuators for `limbs` to a robot's own model, once it is complete. Returns the limbs that
// can be switched, in names of that model. A problem when the configuration asks for a controller
// whose mode is not declared.
std::vector<Limb> AddModeActuators(const RobotSpec& robot, std::vector<Limb> limbs,
                                   const std::string& place, mjSpec* spec, CompileLog& log);

// What each robot of a scene got, with the prefix of its names there.
struct RobotLimbs {
  std::string place;
  std::string prefix;
  bool declared = false;  // control_modes was given, so that it has to be kept to
  std::vector<Limb> limbs = {};
};

// Gives every limb's modes their groups and switches on the initial ones. A problem when the groups
// do not suffice for what was declared; a note when they do not for what was not. What may be a
// finger gets groups of its own as long as there are any to spare.
void AssignActuatorGroups(mjSpec* spec, const std::vector<RobotLimbs>& robots, CompileLog& log);

// Velocity servos brake as the position servos of their joints do; where these do not say, so that
// a position servo as stiff would be critically damped. Those beside motors brake the inertia that
// their joint has at the keyframe `home_key` (the diagonal of the mass matrix, armature included;
// at the reference when < 0) within kVelocityTime. Written into the compiled model.
void FillVelocityGains(mjModel* model, int home_key, const std::vector<RobotLimbs>& robots);

// Seconds in which an error of the velocity of a joint with a motor falls to 1/e, the others still.
inline constexpr double kVelocityTime = 0.05;

}  // namespace robocell::internal
