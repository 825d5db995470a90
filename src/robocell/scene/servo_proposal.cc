#include "robocell/scene/servo_proposal.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
namespace {

constexpr double kFrequency = 25, kFingerFrequency = 60;  // rad/s
constexpr double kFingerForce = 30;                       // N
constexpr double kFingerSeconds = 0.08;  // light fingers that are faster pass through each other
constexpr double kFingerReach = 0.2;     // m, of what a finger's slide moves
constexpr double kLeastArmature = 0.01;  // kg m2: rotors behind gears weigh more
constexpr double kSagRad = 0.005, kSagM = 0.0005;    // under the largest weight
constexpr double kFollowing = 10;                    // 1/s, against the joint's own damping
constexpr double kStuckRad = 0.01, kStuckM = 0.001;  // where friction holds the joint
constexpr double kMostFrequency = 250;               // rad/s: stable with steps of 2 ms
constexpr int kPoses = 12;

bool IsScalar(const mjModel* m, int joint) {
  return m->jnt_type[joint] == mjJNT_HINGE || m->jnt_type[joint] == mjJNT_SLIDE;
}

// Returns how fast each degree of freedom moves per unit of the joint, through joint equalities.
std::vector<double> MovesWith(const mjModel* m, int joint) {
  std::vector<double> slopes(static_cast<size_t>(m->nv), 0.0);
  slopes[static_cast<size_t>(m->jnt_dofadr[joint])] = 1;
  for (int round = 0; round < m->neq; ++round) {  // chains of followers
    bool grows = false;
    for (int i = 0; i < m->neq; ++i) {
      if (m->eq_type[i] != mjEQ_JOINT || m->eq_obj2id[i] < 0 || !m->eq_active0[i]) continue;
      const double leader = slopes[static_cast<size_t>(m->jnt_dofadr[m->eq_obj2id[i]])];
      double& follower = slopes[static_cast<size_t>(m->jnt_dofadr[m->eq_obj1id[i]])];
      if (leader == 0 || follower != 0) continue;
      follower = leader * m->eq_data[i * mjNEQDATA + 1];
      grows |= follower != 0;
    }
    if (!grows) break;
  }
  return slopes;
}

struct Load {
  double inertia = 0;  // kg m2 or kg
  double weight = 0;   // N m or N
};

// Updates the largest load of a joint by that at the positions in `d`.
void UpdateLoad(const mjModel* m, mjData* d, const std::vector<double>& slopes,
                std::vector<double>& scratch, Load& most) {
  Guarded("load of a joint", d, [&] {
    mj_kinematics(m, d);
    mj_comPos(m, d);
    mj_comVel(m, d);
    mj_makeM(m, d);
    mj_mulM(m, d, scratch.data(), slopes.data());
    most.inertia = mju_max(most.inertia, mju_dot(slopes.data(), scratch.data(), m->nv));
    mj_rne(m, d, 0, scratch.data());
    most.weight = mju_max(most.weight, mju_abs(mju_dot(slopes.data(), scratch.data(), m->nv)));
  });
}

Load LargestLoad(const mjModel* m, int joint) {
  const DataPtr data = MakeData(m);
  const std::vector<double> slopes = MovesWith(m, joint);
  std::vector<double> scratch(slopes.size());
  Load most;
  UpdateLoad(m, data.get(), slopes, scratch, most);
  Rng rng = Rng::Stream(0, "servo proposal");
  for (int i = 0; i < kPoses; ++i) {
    for (int j = 0; j < m->njnt; ++j) {
      const bool turns = m->jnt_type[j] == mjJNT_HINGE && !m->jnt_limited[j];
      const double* range = m->jnt_range + 2 * j;
      double& q = data->qpos[m->jnt_qposadr[j]];
      if (turns) q = rng.Uniform(-mjPI, mjPI);
      if (m->jnt_limited[j] && IsScalar(m, j)) q = rng.Uniform(range[0], range[1]);
    }
    UpdateLoad(m, data.get(), slopes, scratch, most);
  }
  return most;
}

bool IsBelow(const mjModel* m, int body, int ancestor) {
  while (body != ancestor && body != 0) body = m->body_parentid[body];
  return body == ancestor;
}

// Returns true for a slide that moves something small.
bool IsFinger(const mjModel* m, int joint) {
  if (m->jnt_type[joint] != mjJNT_SLIDE) return false;
  const DataPtr data = MakeData(m);
  Guarded("size of a finger", data.get(), [&] { mj_kinematics(m, data.get()); });
  const int top = m->jnt_bodyid[joint];
  const double* origin = data->xpos + 3 * top;
  for (int body = top; body < m->nbody; ++body) {
    if (IsBelow(m, body, top) && mju_dist3(data->xpos + 3 * body, origin) >= kFingerReach)
      return false;
  }
  for (int geom = 0; geom < m->ngeom; ++geom) {
    if (IsBelow(m, m->geom_bodyid[geom], top) &&
        mju_dist3(data->geom_xpos + 3 * geom, origin) >= kFingerReach)
      return false;
  }
  return true;
}

double TwoDigits(double value) {
  if (!(value > 0)) return value;
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1);
  return std::round(value / unit) * unit;
}

std::array<double, 2> Pair(const mjtNum* values) { return {values[0], values[1]}; }

}  // namespace

ServoProposal ProposeServo(const mjModel* m, int joint) {
  ServoProposal servo;
  const bool finger = IsFinger(m, joint);
  const Load load = LargestLoad(m, joint);
  double inertia = load.inertia;
  if (m->dof_armature[m->jnt_dofadr[joint]] == 0 && m->jnt_type[joint] == mjJNT_HINGE) {
    servo.armature = inertia > kLeastArmature ? kLeastArmature : 0.3 * inertia;
    inertia += servo.armature;
  }
  if (m->jnt_limited[joint]) servo.ctrl_range = Pair(m->jnt_range + 2 * joint);
  if (m->jnt_actfrclimited[joint]) servo.force_range = Pair(m->jnt_actfrcrange + 2 * joint);
  const double frequency = finger ? kFingerFrequency : kFrequency;
  servo.kp = inertia * frequency * frequency;
  if (finger && servo.ctrl_range)
    servo.kp =
        std::max(servo.kp, 2 * kFingerForce / ((*servo.ctrl_range)[1] - (*servo.ctrl_range)[0]));
  const bool slides = m->jnt_type[joint] == mjJNT_SLIDE;
  const double stiffness = load.weight / (slides ? kSagM : kSagRad);
  const int dof = m->jnt_dofadr[joint];
  const double needed = std::max({stiffness, kFollowing * m->dof_damping[dof],
                                  m->dof_frictionloss[dof] / (slides ? kStuckM : kStuckRad)});
  servo.kp = std::max(servo.kp, std::min(needed, inertia * kMostFrequency * kMostFrequency));
  servo.kv = 2 * std::sqrt(servo.kp * inertia);
  if (finger) servo.kv = std::max(servo.kv, kFingerSeconds * servo.kp);
  servo.kv = TwoDigits(servo.kv);
  servo.kp = TwoDigits(servo.kp);
  return servo;
}

void AddServo(mjSpec* spec, const std::string& joint, const ServoProposal& servo) {
  std::string name = joint;
  while (FindSpecElement(spec, mjOBJ_ACTUATOR, name)) name += "_servo";
  mjsActuator* actuator = mjs_addActuator(spec, nullptr);
  SetSpecName(actuator->element, name, "servo");
  double kv = servo.kv;
  mjs_setToPosition(actuator, servo.kp, &kv, nullptr, nullptr, 0);
  actuator->trntype = mjTRN_JOINT;
  mjs_setString(actuator->target, joint.c_str());
  if (servo.ctrl_range) {
    std::copy(servo.ctrl_range->begin(), servo.ctrl_range->end(), actuator->ctrlrange);
    actuator->ctrllimited = mjLIMITED_TRUE;
  }
  if (servo.force_range) {
    std::copy(servo.force_range->begin(), servo.force_range->end(), actuator->forcerange);
    actuator->forcelimited = mjLIMITED_TRUE;
  }
  if (servo.armature > 0)
    mjs_asJoint(FindSpecElement(spec, mjOBJ_JOINT, joint))->armature = servo.armature;
}

}  // namespace robocell::internal
