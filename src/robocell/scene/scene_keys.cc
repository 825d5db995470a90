#include "robocell/scene/scene_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "robocell/mujoco/closed_loops.h"
#include "robocell/mujoco/coupled_positions.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scene/add_robot.h"
#include "robocell/scene/coupled_groups.h"
#include "robocell/scene/key_ctrl.h"
#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
namespace {

int PositionCount(const mjModel* model, int joint) {
  const int next =
      joint + 1 < model->njnt ? model->jnt_qposadr[joint + 1] : static_cast<int>(model->nq);
  return next - model->jnt_qposadr[joint];
}

int VelocityCount(const mjModel* model, int joint) {
  const int next =
      joint + 1 < model->njnt ? model->jnt_dofadr[joint + 1] : static_cast<int>(model->nv);
  return next - model->jnt_dofadr[joint];
}

// The joints of a group take their values one after the other, usually one each.
void SetGroup(const mjModel* model, mjtNum* qpos, const RobotRecord& robot,
              const MoveGroupConfig& group, const std::vector<double>& values) {
  size_t at = 0;
  for (const std::string& name : group.joints) {
    const int joint = FindId(model, mjOBJ_JOINT, robot.prefix + name);
    if (joint < 0) continue;
    const size_t count = static_cast<size_t>(PositionCount(model, joint));
    if (at + count > values.size()) return;
    std::copy_n(values.begin() + static_cast<ptrdiff_t>(at), count,
                qpos + model->jnt_qposadr[joint]);
    at += count;
  }
}

// Calls f(robot, group, values) for each configured home.
template <class F>
void ForEachHome(const std::vector<RobotRecord>& robots, const F& f) {
  for (const RobotRecord& robot : robots) {
    for (const auto& [name, values] : robot.config.home.entries()) {
      if (const MoveGroupConfig* group = robot.config.move_groups.find(name))
        f(robot, *group, *values);
    }
  }
}

// One keyframe of the model.
class KeyRow {
 public:
  KeyRow(mjModel* model, int row) : m_(model), row_(row) {}

  // Sets the engine's defaults of joints that a key of their model leaves out.
  void TakeDefaults(const PartKey& part) {
    for (const auto& [name, source] : part.joint_sources) {
      const int joint = FindId(m_, mjOBJ_JOINT, name);
      if (joint < 0) continue;
      const int at = m_->jnt_qposadr[joint];
      std::copy_n(m_->qpos0 + at, PositionCount(m_, joint), qpos() + at);
      std::fill_n(qvel() + m_->jnt_dofadr[joint], VelocityCount(m_, joint), 0.0);
    }
  }

  void TakePositions(const PartKey& part) {
    for (const auto& [name, values] : part.qpos) {
      const int joint = FindId(m_, mjOBJ_JOINT, name);
      if (joint >= 0 && static_cast<int>(values.size()) == PositionCount(m_, joint))
        std::copy(values.begin(), values.end(), qpos() + m_->jnt_qposadr[joint]);
    }
    for (const auto& [name, values] : part.qvel) {
      const int joint = FindId(m_, mjOBJ_JOINT, name);
      if (joint >= 0 && static_cast<int>(values.size()) == VelocityCount(m_, joint))
        std::copy(values.begin(), values.end(), qvel() + m_->jnt_dofadr[joint]);
    }
    for (const auto& [name, pose] : part.mocap) TakeMocap(name, pose);
  }

  void CopyFrom(const KeyRow& other) {
    std::copy_n(other.qpos(), m_->nq, qpos());
    std::copy_n(other.qvel(), m_->nv, qvel());
    std::copy_n(other.act(), m_->na, act());
    std::copy_n(other.ctrl(), m_->nu, ctrl());
    std::copy_n(other.mpos(), 3 * m_->nmocap, mpos());
    std::copy_n(other.mquat(), 4 * m_->nmocap, mquat());
  }

  void Write(const mjsKey* key) const {
    mjs_setDouble(key->qpos, qpos(), static_cast<int>(m_->nq));
    mjs_setDouble(key->qvel, qvel(), static_cast<int>(m_->nv));
    mjs_setDouble(key->act, act(), static_cast<int>(m_->na));
    mjs_setDouble(key->ctrl, ctrl(), static_cast<int>(m_->nu));
    mjs_setDouble(key->mpos, mpos(), static_cast<int>(3 * m_->nmocap));
    mjs_setDouble(key->mquat, mquat(), static_cast<int>(4 * m_->nmocap));
  }

  // Loads the state of the key, at rest, with the inputs that hold it or that move it by its
  // weight.
  void Load(mjData* data) const {
    Guarded("scene's keyframes", data, [&] {
      mj_resetDataKeyframe(m_, data, row_);
      std::fill_n(data->qvel, m_->nv, 0.0);
      mj_fwdPosition(m_, data);
      mj_fwdVelocity(m_, data);
    });
  }

  mjtNum* qpos() const { return m_->key_qpos + row_ * m_->nq; }
  mjtNum* qvel() const { return m_->key_qvel + row_ * m_->nv; }
  mjtNum* act() const { return m_->key_act + row_ * m_->na; }
  mjtNum* ctrl() const { return m_->key_ctrl + row_ * m_->nu; }
  mjtNum* mpos() const { return m_->key_mpos + row_ * 3 * m_->nmocap; }
  mjtNum* mquat() const { return m_->key_mquat + row_ * 4 * m_->nmocap; }

 private:
  void TakeMocap(const std::string& name, const Pose& pose) {
    const int body = FindId(m_, mjOBJ_BODY, name);
    const int mocap = body < 0 ? -1 : m_->body_mocapid[body];
    if (mocap < 0) return;
    const Pose placed = Pose::FromWxyz(m_->body_pos + 3 * static_cast<ptrdiff_t>(body),
                                       m_->body_quat + 4 * static_cast<ptrdiff_t>(body));
    (placed * pose)
        .ToWxyz(mpos() + 3 * static_cast<ptrdiff_t>(mocap),
                mquat() + 4 * static_cast<ptrdiff_t>(mocap));
  }

  mjModel* m_;
  ptrdiff_t row_;
};

class KeyFiller {
 public:
  KeyFiller(mjModel* model, const std::vector<RobotRecord>& robots, CompileLog& log)
      : m_(model), robots_(robots), log_(log), data_(MakeData(model)) {
    configured_.resize(static_cast<size_t>(m_->nv));
    ForEachHome(robots_, [&](const auto& robot, const auto& group, const auto&) {
      MarkDofs(m_, JointIds(m_, robot, group.joints), configured_);
    });
  }

  // If a robot's file sets its home, the key of its model does not count.
  void FillHome(const PartKey& part) {
    const KeyRow row(m_, 0);
    std::copy_n(m_->qpos0, m_->nq, row.qpos());
    KeyRow(m_, 0).TakePositions(part);
    std::vector<int> given;
    ForEachHome(robots_, [&](const auto& robot, const auto& group, const auto& values) {
      SetGroup(m_, row.qpos(), robot, group, values);
      const std::vector<int> joints = JointIds(m_, robot, group.joints);
      PlaceFollowers(m_, joints, row.qpos());
      given.insert(given.end(), joints.begin(), joints.end());
    });
    if (!CloseLoops(m_, given, row.qpos())) WarnOfOpenLoops();
    for (int dof = 0; dof < m_->nv; ++dof) {
      if (configured_[static_cast<size_t>(dof)]) row.qvel()[dof] = 0;
    }
    row.Load(data_.get());
    KeyCtrl ctrl(m_, data_.get(), part, "home", robots_);
    for (int id = 0; id < m_->nactuator; ++id) {
      const bool own = !ActsOn(m_, data_.get(), id, configured_);
      ctrl.Set(id, own, row.ctrl(), row.act());
    }
    ctrl.Warn(log_);
    for (const RobotRecord& robot : robots_) OpenUndecidedGrippers(part, robot, row);
  }

  void FillPreset(int number, const std::string& name, const PartKey& part) {
    KeyRow row(m_, number);
    row.CopyFrom(KeyRow(m_, 0));
    row.TakeDefaults(part);
    row.TakePositions(part);
    row.Load(data_.get());
    std::vector<bool> moved(static_cast<size_t>(m_->nv));
    for (const auto& [joint_name, source] : part.joint_sources) {
      const int joint = FindId(m_, mjOBJ_JOINT, joint_name);
      if (joint < 0) continue;
      const auto first = moved.begin() + m_->jnt_dofadr[joint];
      std::fill(first, first + VelocityCount(m_, joint), true);
    }
    KeyCtrl ctrl(m_, data_.get(), part, name, robots_);
    for (int id = 0; id < m_->nactuator; ++id) {
      if (ctrl.IsOfPart(id) || ActsOn(m_, data_.get(), id, moved))
        ctrl.Set(id, true, row.ctrl(), row.act());
    }
    ctrl.Warn(log_);
  }

 private:
  // Names what leaves a loop open: the first joint of a loop in each home.
  void WarnOfOpenLoops() {
    ForEachHome(robots_, [&](const auto& robot, const auto& group, const auto&) {
      for (const int joint : JointIds(m_, robot, group.joints)) {
        const std::string loop = DescribeLoopOf(m_, joint);
        if (loop.empty()) continue;
        log_.Warn(RobotPlace(robot.name),
                  fmt::format("home: '{}' is {}. No positions of the other joints within their "
                              "limits close it, so the joints swing away after a reset: choose a "
                              "home that the loop allows",
                              ElementName(m_, mjOBJ_JOINT, joint), loop),
                  "home");
        return;
      }
    });
  }

  void OpenUndecidedGrippers(const PartKey& part, const RobotRecord& robot, const KeyRow& row) {
    for (const auto& [name, group] : robot.config.move_groups.entries()) {
      if (group->kind != MoveGroupKind::kGripper || !group->ctrl ||
          robot.config.home.contains(name))
        continue;
      for (const std::string& actuator : group->actuators) {
        const int id = FindId(m_, mjOBJ_ACTUATOR, robot.prefix + actuator);
        if (id < 0 || part.ctrl.contains(robot.prefix + actuator)) continue;
        if (m_->actuator_ctrlnum[id] != 1) continue;
        row.ctrl()[m_->actuator_ctrladr[id]] = group->ctrl->open;
        if (IsFiltered(m_, id) && m_->actuator_actadr[id] >= 0)
          row.act()[m_->actuator_actadr[id]] = group->ctrl->open;
      }
    }
  }

  mjModel* m_;
  const std::vector<RobotRecord>& robots_;
  CompileLog& log_;
  const DataPtr data_;
  std::vector<bool> configured_;
};

}  // namespace

std::vector<mjsKey*> AddSceneKeys(mjSpec* spec, const std::vector<std::string>& presets) {
  std::vector<mjsKey*> keys;
  const auto add = [&](const std::string& name) {
    keys.push_back(mjs_addKey(spec));
    SetSpecName(keys.back()->element, name, "the scene's keyframes");
  };
  add("home");
  for (const std::string& name : presets) add(name);
  return keys;
}

void FillSceneKeys(mjModel* model, const std::vector<mjsKey*>& keys, const PartKeys& parts,
                   const std::vector<RobotRecord>& robots, CompileLog& log) {
  KeyFiller filler(model, robots, log);
  filler.FillHome(parts.home);
  for (size_t i = 0; i < parts.presets.size(); ++i)
    filler.FillPreset(static_cast<int>(i) + 1, parts.presets[i].first, parts.presets[i].second);
  for (size_t i = 0; i < keys.size(); ++i) KeyRow(model, static_cast<int>(i)).Write(keys[i]);
}

}  // namespace robocell::internal
