#include "robocell/scene/home_key.h"

#include <algorithm>
#include <string>

#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scene/hold_ctrl.h"
#include "robocell/scene/spec_tree.h"

namespace robocell {
namespace {

int PositionCount(const mjModel* model, int joint) {
  const int next =
      joint + 1 < model->njnt ? model->jnt_qposadr[joint + 1] : static_cast<int>(model->nq);
  return next - model->jnt_qposadr[joint];
}

void SetJoint(const mjModel* model, mjtNum* qpos, const std::string& name,
              const std::vector<double>& values) {
  const int joint = FindId(model, mjOBJ_JOINT, name);
  if (joint < 0 || static_cast<int>(values.size()) != PositionCount(model, joint)) return;
  std::copy(values.begin(), values.end(), qpos + model->jnt_qposadr[joint]);
}

// The joints of a group take their values one after the other, most of them one each.
void SetGroup(const mjModel* model, mjtNum* qpos, const RobotRecord& robot,
              const MoveGroupConfig& group, const std::vector<double>& values) {
  size_t at = 0;
  for (const std::string& name : group.joints) {
    const int joint = FindId(model, mjOBJ_JOINT, robot.prefix + name);
    if (joint < 0) continue;
    const size_t count = static_cast<size_t>(PositionCount(model, joint));
    if (at + count > values.size()) return;
    std::copy_n(values.begin() + at, count, qpos + model->jnt_qposadr[joint]);
    at += count;
  }
}

void FillQpos(mjModel* model, const PartHome& parts, const std::vector<RobotRecord>& robots) {
  mjtNum* qpos = model->key_qpos;
  std::copy_n(model->qpos0, model->nq, qpos);
  for (const auto& [joint, values] : parts.qpos) SetJoint(model, qpos, joint, values);
  for (const RobotRecord& robot : robots) {
    for (const auto& [name, values] : robot.config.home.entries()) {
      if (const MoveGroupConfig* group = robot.config.move_groups.find(name)) {
        SetGroup(model, qpos, robot, *group, *values);
      }
    }
  }
}

// Degrees of freedom of groups with a configured home: what acts on them holds that home, whatever
// their own model's key says.
std::vector<bool> DofsWithHome(const mjModel* model, const std::vector<RobotRecord>& robots) {
  std::vector<bool> dofs(static_cast<size_t>(model->nv));
  for (const RobotRecord& robot : robots) {
    for (const auto& [name, values] : robot.config.home.entries()) {
      const MoveGroupConfig* group = robot.config.move_groups.find(name);
      if (group) MarkDofs(model, robot, *group, dofs);
    }
  }
  return dofs;
}

void SetCtrl(mjModel* model, int actuator, double value) {
  if (model->actuator_ctrlnum[actuator] != 1) return;
  model->key_ctrl[model->actuator_ctrladr[actuator]] = value;
  const int activation = model->actuator_actadr[actuator];
  if (IsFiltered(model, actuator) && activation >= 0) model->key_act[activation] = value;
}

// Grippers whose home is said nowhere start open.
void OpenUndecidedGrippers(mjModel* model, const PartHome& parts, const RobotRecord& robot) {
  for (const auto& [name, group] : robot.config.move_groups.entries()) {
    if (group->kind != MoveGroupKind::kGripper || !group->ctrl || robot.config.home.contains(name))
      continue;
    for (const std::string& actuator : group->actuators) {
      const int id = FindId(model, mjOBJ_ACTUATOR, robot.prefix + actuator);
      if (id >= 0 && !parts.ctrl.contains(robot.prefix + actuator))
        SetCtrl(model, id, group->ctrl->open);
    }
  }
}

void FillCtrl(mjModel* model, const PartHome& parts, const std::vector<RobotRecord>& robots) {
  const DataPtr data = MakeData(model);
  Guarded("scene's home pose", data.get(), [&] {
    mj_resetDataKeyframe(model, data.get(), 0);
    mj_fwdPosition(model, data.get());
  });
  const std::vector<bool> configured = DofsWithHome(model, robots);
  for (int id = 0; id < model->nactuator; ++id) {
    const std::string name = ElementName(model, mjOBJ_ACTUATOR, id);
    const auto own = parts.ctrl.find(name);
    if (own != parts.ctrl.end() && !ActsOn(model, data.get(), id, configured)) {
      SetCtrl(model, id, own->second[0]);
    } else if (const auto ctrl = HoldingCtrl(model, data.get(), id)) {
      SetCtrl(model, id, *ctrl);
    }
  }
  for (const RobotRecord& robot : robots) OpenUndecidedGrippers(model, parts, robot);
}

}  // namespace

mjsKey* AddHomeKey(mjSpec* spec) {
  mjsKey* key = mjs_addKey(spec);
  SetSpecName(key->element, "home", "the scene's home key");
  return key;
}

void FillHomeKey(mjModel* model, mjsKey* key, const PartHome& parts,
                 const std::vector<RobotRecord>& robots) {
  FillQpos(model, parts, robots);
  FillCtrl(model, parts, robots);
  mjs_setDouble(key->qpos, model->key_qpos, static_cast<int>(model->nq));
  mjs_setDouble(key->ctrl, model->key_ctrl, static_cast<int>(model->nu));
  mjs_setDouble(key->act, model->key_act, static_cast<int>(model->na));
  mjs_setDouble(key->mpos, model->key_mpos, static_cast<int>(3 * model->nmocap));
  mjs_setDouble(key->mquat, model->key_mquat, static_cast<int>(4 * model->nmocap));
}

}  // namespace robocell
