#include "robocell/viewer/edit_values.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <numbers>
#include <optional>
#include <span>

#include "robocell/mujoco/actuators.h"
#include "robocell/scene/hold_ctrl.h"
#include "robocell/spec/ctrl_mode.h"

namespace robocell::internal {
namespace {

bool IsScalar(const mjModel* m, int joint) {
  return m->jnt_type[joint] == mjJNT_HINGE || m->jnt_type[joint] == mjJNT_SLIDE;
}

// Returns the place of a joint among those of a robot's arm.
std::optional<size_t> PlaceInArm(const Robot& robot, const std::string& joint) {
  if (!robot.has_arm()) return std::nullopt;
  const std::vector<std::string>& names = robot.joint_names();
  const auto found = std::find(names.begin(), names.end(), joint);
  if (found == names.end()) return std::nullopt;
  return static_cast<size_t>(found - names.begin());
}

// Returns the length at which a position servo rests with a control, the inverse of FreeRestingCtrl,
// which is affine. Unset for other actuators.
std::optional<double> RestingLength(const mjModel* m, int actuator, double ctrl) {
  const auto at_zero = FreeRestingCtrl(m, actuator, 0), at_one = FreeRestingCtrl(m, actuator, 1);
  if (!at_zero || !at_one || *at_zero == *at_one) return std::nullopt;
  return (ctrl - *at_zero) / (*at_one - *at_zero);
}

}  // namespace

std::vector<std::string> ScalarJoints(const mjModel* m) {
  std::vector<std::string> names;
  for (int id = 0; id < static_cast<int>(m->njnt); ++id) {
    const char* name = mj_id2name(m, mjOBJ_JOINT, id);
    if (name && IsScalar(m, id)) names.emplace_back(name);
  }
  return names;
}

std::vector<std::string> NamedActuators(const mjModel* m) {
  std::vector<std::string> names;
  for (int id = 0; id < static_cast<int>(m->nactuator); ++id) {
    const char* name = mj_id2name(m, mjOBJ_ACTUATOR, id);
    if (name && m->actuator_ctrlnum[id] == 1) names.emplace_back(name);
  }
  return names;
}

SliderRange JointRange(const mjModel* m, const std::string& joint) {
  const int id = mj_name2id(m, mjOBJ_JOINT, joint.c_str());
  if (id < 0) return {};
  if (m->jnt_limited[id]) return {m->jnt_range[2 * id], m->jnt_range[2 * id + 1]};
  const double most = m->jnt_type[id] == mjJNT_HINGE ? std::numbers::pi : 1;
  return {-most, most};
}

SliderRange ControlRange(const mjModel* m, const std::string& actuator) {
  const int id = mj_name2id(m, mjOBJ_ACTUATOR, actuator.c_str());
  if (id < 0) return {};
  const ptrdiff_t input = m->actuator_ctrladr[id];
  const mjtNum* range = m->actuator_ctrlrange + 2 * input;
  if (m->actuator_ctrllimited[input] && range[0] < range[1]) return {range[0], range[1]};
  if (ActsOnJoint(m, id) && m->actuator_biastype[id] == mjBIAS_AFFINE) {
    if (const char* joint = mj_id2name(m, mjOBJ_JOINT, m->actuator_trnid[2 * id]))
      return JointRange(m, joint);
  }
  return {-1, 1};
}

double JointValue(const Scene& scene, const std::string& joint) { return scene.joint_pos(joint); }

double ControlValue(const Scene& scene, const std::string& actuator) {
  return scene.actuator_ctrl(actuator);
}

void SetJoint(const Scene& scene, const std::vector<Robot>& robots, const std::string& joint,
              double value) {
  const mjModel* m = scene.model();
  const int id = mj_name2id(m, mjOBJ_JOINT, joint.c_str());
  if (id < 0) return;
  scene.data()->qvel[m->jnt_dofadr[id]] = 0;
  for (Robot robot : robots) {
    const auto place = PlaceInArm(robot, joint);
    if (!place) continue;
    std::vector<double> q;
    for (const std::string& name : robot.joint_names()) q.push_back(scene.joint_pos(name));
    q[*place] = value;
    robot.SetJointPos(q);
    return;
  }
  scene.data()->qpos[m->jnt_qposadr[id]] = value;
  Scene(scene).Forward();
}

void SetControl(const Scene& scene, const std::vector<Robot>& robots, const std::string& actuator,
                double value) {
  Scene(scene).SetActuatorCtrl(actuator, value);
  const mjModel* m = scene.model();
  const int id = mj_name2id(m, mjOBJ_ACTUATOR, actuator.c_str());
  if (id < 0 || !ActsOnJoint(m, id)) return;
  const char* joint = mj_id2name(m, mjOBJ_JOINT, m->actuator_trnid[2 * id]);
  const double gear = Gear(m, id);
  if (!joint || gear == 0) return;
  for (const Robot& robot : robots) {
    const auto place = PlaceInArm(robot, joint);
    if (place && robot.ctrl_mode() == CtrlMode::kPosition) {
      if (const auto length = RestingLength(m, id, value))
        robot.jnt_pos_cmd()[*place] = *length / gear;
    }
  }
}

}  // namespace robocell::internal
