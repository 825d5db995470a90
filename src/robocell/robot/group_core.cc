#include "robocell/robot/group_core.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "robocell/base/error.h"
#include "robocell/base/small_arrays.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/gravity.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/joint_followers.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/drive_matrix.h"
#include "robocell/scene/hold_ctrl.h"

namespace robocell {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

int PositionsOf(int type) { return type == mjJNT_FREE ? 7 : type == mjJNT_BALL ? 4 : 1; }
int VelocitiesOf(int type) { return type == mjJNT_FREE ? 6 : type == mjJNT_BALL ? 3 : 1; }

// Returns the index, among the group's positions, of the hinge or slide that an actuator drives; -1
// if it drives something else.
int DrivenPosition(const mjModel* m, int actuator, const std::vector<int>& qpos_addresses) {
  if (!internal::ActsOnJoint(m, actuator)) return -1;
  const int joint = m->actuator_trnid[2 * actuator];
  if (PositionsOf(m->jnt_type[joint]) != 1) return -1;
  const auto at = std::find(qpos_addresses.begin(), qpos_addresses.end(), m->jnt_qposadr[joint]);
  return at == qpos_addresses.end() ? -1 : static_cast<int>(at - qpos_addresses.begin());
}

// Returns true if joints move a body.
bool IsCarried(const mjModel* m, int body) {
  for (; body > 0; body = m->body_parentid[body]) {
    if (m->body_jntnum[body] > 0) return true;
  }
  return false;
}

}  // namespace

GroupCore::GroupCore(const Scene& scene, GroupNames names)
    : scene_(scene.inner()), names_(std::move(names)) {
  Resolve();
}

std::string GroupCore::place() const {
  const std::string group = "group '" + names_.group + "'";
  return names_.robot.empty() ? group : "robot '" + names_.robot + "' / " + group;
}

void GroupCore::ThrowClosed() const {
  throw ClosedError(place() + " is closed: its scene was closed");
}

void GroupCore::Resolve() const {
  const std::string where = "scene '" + scene_.name() + "' / " + place();
  ResolveJoints(where);
  ResolveActuators(where);
  ResolveFollowers();
  ResolveLengths();
  root_ = Find(names_.root, where);
  leaf_ = Find(names_.leaf, where);
  base_ = Find(names_.robot_base, where);
  base_is_carried_ = IsCarried(model(), base_.is_site ? model()->site_bodyid[base_.id] : base_.id);
  jacobian_.resize(6 * static_cast<size_t>(model()->nv));
  generation_ = scene_.generation();
}

void GroupCore::ResolveJoints(const std::string& where) const {
  const mjModel* m = model();
  joint_ids_.clear();
  qpos_addresses_.clear();
  dof_addresses_.clear();
  for (const std::string& joint : names_.joints) {
    const int id = RequireId(m, mjOBJ_JOINT, joint, where);
    joint_ids_.push_back(id);
    qpos_addresses_.Add(m->jnt_qposadr[id], PositionsOf(m->jnt_type[id]));
    dof_addresses_.Add(m->jnt_dofadr[id], VelocitiesOf(m->jnt_type[id]));
  }
}

void GroupCore::ResolveActuators(const std::string& where) const {
  const mjModel* m = model();
  actuator_ids_.clear();
  ctrl_addresses_.clear();
  driven_.clear();
  for (const std::string& actuator : names_.actuators) {
    const int id = RequireId(m, mjOBJ_ACTUATOR, actuator, where);
    actuator_ids_.push_back(id);
    ctrl_addresses_.Add(m->actuator_ctrladr[id], m->actuator_ctrlnum[id]);
    driven_.push_back(DrivenPosition(m, id, qpos_addresses_.list()));
  }
}

void GroupCore::ResolveFollowers() const {
  const mjModel* m = model();
  followers_.clear();
  if (!names_.couples || m->neq == 0) return;
  for (const internal::JointFollower& f : internal::FollowersOf(m, joint_ids_)) {
    followers_.push_back(
        {f.joint, m->jnt_qposadr[f.joint], m->jnt_dofadr[f.joint], f.leader, f.of_leader});
  }
}

void GroupCore::ResolveLengths() const {
  const mjModel* m = model();
  lengths_.reset();
  if (!names_.couples || actuator_ids_.empty()) return;
  bool plain = driven_.size() == joint_ids_.size();
  for (size_t i = 0; plain && i < driven_.size(); ++i) plain = driven_[i] == static_cast<int>(i);
  if (plain) return;
  const std::vector<internal::JointFollower> followers = internal::FollowersOf(m, joint_ids_);
  internal::DriveLengths lengths;
  for (const int id : actuator_ids_) {
    lengths.of_actuators.push_back(
        internal::LengthOver(m, id, joint_ids_, followers).value_or(internal::DriveLength{}));
  }
  lengths_ = std::make_shared<const internal::DriveLengths>(std::move(lengths));
}

Eigen::MatrixXd GroupCore::DriveMatrix(std::span<const double> q) const {
  return internal::DriveMatrix(lengths_->of_actuators, q);
}

GroupCore::FrameId GroupCore::Find(const FrameName& frame, const std::string& where) const {
  const mjtObj kind = frame.is_site ? mjOBJ_SITE : mjOBJ_BODY;
  return {frame.is_site, RequireId(model(), kind, frame.name, where)};
}

void GroupCore::ThrowWrongSize(size_t got, int expected, const char* what) const {
  throw ArgumentError(fmt::format("{}: expected {}, got {}", place(),
                                  Counted(expected, std::string(what) + " value"), got));
}

void GroupCore::RequireFiniteValues(std::span<const double> values,
                                    const std::vector<std::string>& element_names,
                                    const char* kind) const {
  if (AllFinite(values.data(), values.size())) return;
  for (size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    const std::string name = values.size() == element_names.size()
                                 ? fmt::format("{} '{}'", kind, element_names[i])
                                 : fmt::format("value {}", i);
    throw ArgumentError(
        fmt::format("{}: {} cannot be set to {}; values must be finite", place(), name, values[i]));
  }
}

void GroupCore::GetJointPos(std::span<double> out) const {
  Bind();
  RequireSize(out.size(), nq(), "joint");
  qpos_addresses_.Gather(data()->qpos, out);
}

void GroupCore::GetJointVel(std::span<double> out) const {
  Bind();
  RequireSize(out.size(), nv(), "joint velocity");
  dof_addresses_.Gather(data()->qvel, out);
}

void GroupCore::GetJointTorque(std::span<double> out) const {
  Bind();
  RequireSize(out.size(), nv(), "joint torque");
  dof_addresses_.Gather(data()->qfrc_actuator, out);
  for (const Follower& f : followers_) {
    const double slope = f.of_leader.slope(data()->qpos[qpos_addresses_[f.leader]]);
    out[f.leader] += slope * data()->qfrc_actuator[f.dof_address];
  }
}

void GroupCore::GetCtrl(std::span<double> out) const {
  Bind();
  RequireSize(out.size(), nu(), "control");
  ctrl_addresses_.Gather(data()->ctrl, out);
}

void GroupCore::SetJointPos(std::span<const double> q) const {
  WriteJointPos(q);
  Scene(scene_).Forward();
}

void GroupCore::WriteJointPos(std::span<const double> q) const {
  Bind();
  RequireSize(q.size(), nq(), "joint");
  RequireFiniteValues(q, names_.joints, "joint");
  qpos_addresses_.Scatter(q, data()->qpos);
  for (const Follower& f : followers_) data()->qpos[f.qpos_address] = f.of_leader.at(q[f.leader]);
  Scene(scene_).PosesChanged();
}

void GroupCore::SetJointVel(std::span<const double> v) const {
  Bind();
  RequireSize(v.size(), nv(), "joint velocity");
  RequireFiniteValues(v, names_.joints, "joint");
  dof_addresses_.Scatter(v, data()->qvel);
  for (const Follower& f : followers_) {
    const double slope = f.of_leader.slope(data()->qpos[qpos_addresses_[f.leader]]);
    data()->qvel[f.dof_address] = slope * v[f.leader];
  }
}

void GroupCore::SetCtrl(std::span<const double> ctrl) const {
  Bind();
  RequireSize(ctrl.size(), nu(), "control");
  RequireFiniteValues(ctrl, names_.actuators, "actuator");
  ctrl_addresses_.Scatter(ctrl, data()->ctrl);
}

std::vector<Interval> GroupCore::joint_pos_limits() const {
  Bind();
  std::vector<Interval> limits(qpos_addresses_.size());
  GetJointPosLimits(limits);
  return limits;
}

void GroupCore::GetJointPosLimits(std::span<Interval> out) const {
  Bind();
  RequireSize(out.size(), nq(), "joint");
  const mjModel* m = model();
  Interval* limits = out.data();
  for (const int id : joint_ids_) {
    const int count = PositionsOf(m->jnt_type[id]);
    const bool limited = m->jnt_limited[id] && count == 1;
    const mjtNum* range = m->jnt_range + 2 * id;
    limits = std::fill_n(limits, count,
                         limited ? Interval{range[0], range[1]} : Interval{-kInfinity, kInfinity});
  }
  if (!followers_.empty()) [[unlikely]]
    NarrowToFollowers(out);
}

// Only followers that carry the leaf are joints of its chain.
void GroupCore::NarrowToFollowers(std::span<Interval> limits) const {
  const mjModel* m = model();
  const int leaf = leaf_.is_site ? m->site_bodyid[leaf_.id] : leaf_.id;
  for (const Follower& f : followers_) {
    const bool carries = internal::IsInSubtree(m, leaf, m->jnt_bodyid[f.joint]);
    if (!m->jnt_limited[f.joint] || !carries) continue;
    Interval& own = limits[f.leader];
    const internal::JointRange within =
        internal::RangeWithin(f.of_leader, {own.lower, own.upper}, internal::LimitsOf(m, f.joint));
    if (within.lower <= within.upper) own = {within.lower, within.upper};
  }
}

std::vector<Interval> GroupCore::ctrl_limits() const {
  Bind();
  const mjModel* m = model();
  std::vector<Interval> limits;
  for (const int a : ctrl_addresses_.list()) {
    const mjtNum* range = m->actuator_ctrlrange + 2 * a;
    limits.push_back(m->actuator_ctrllimited[a] ? Interval{range[0], range[1]}
                                                : Interval{-kInfinity, kInfinity});
  }
  return limits;
}

void GroupCore::NoopCtrl(std::span<double> out) const {
  Bind();
  RequireSize(out.size(), nu(), "control");
  scene_.SyncPoses();
  const mjModel* m = model();
  mjData* d = data();
  // After a teleport inside a reset, lengths are still the old ones.
  internal::Guarded("lengths of the actuators", d, [&] {
    mj_tendon(m, d);
    mj_transmission(m, d);
  });
  std::fill(out.begin(), out.end(), 0.0);
  size_t at = 0;
  for (const int id : actuator_ids_) {
    if (const auto ctrl = internal::HoldingCtrl(m, d, id)) out[at] = *ctrl;
    at += m->actuator_ctrlnum[id];
  }
}

std::optional<double> GroupCore::LengthFor(size_t actuator, std::span<const double> q) const {
  const int joint = driven_[actuator];
  if (joint >= 0) return internal::Gear(model(), actuator_ids_[actuator]) * q[joint];
  if (!lengths_ || lengths_->of_actuators[actuator].empty()) return std::nullopt;
  return internal::LengthAt(lengths_->of_actuators[actuator], q);
}

// Ignores its control range. Unset if it is not a position servo of one of the joints.
std::optional<double> GroupCore::RestingCtrlFor(size_t actuator, std::span<const double> q) const {
  const std::optional<double> length = LengthFor(actuator, q);
  if (!length) return std::nullopt;
  return internal::FreeRestingCtrl(model(), actuator_ids_[actuator], *length);
}

void GroupCore::CtrlForJointPos(std::span<const double> q, std::span<double> ctrl) const {
  Bind();
  RequireSize(q.size(), nq(), "joint");
  RequireSize(ctrl.size(), nu(), "control");
  const mjModel* m = model();
  for (size_t i = 0; i < actuator_ids_.size(); ++i) {
    const std::optional<double> rest = RestingCtrlFor(i, q);
    if (!rest) {
      throw ArgumentError(fmt::format(
          "{}: actuator '{}' is not a position servo of one of its joints{}, so it cannot be "
          "driven "
          "to "
          "a joint position; give the group another controller (for an arm of motors: `control: "
          "{{{}: joint_impedance}}` at the top level of the robot file, or joint_torque there to "
          "command torques), or the model a servo",
          place(), names_.actuators[i],
          driven_[i] < 0 ? "" : " but " + internal::DescribeActuator(m, actuator_ids_[i]),
          names_.group));
    }
    ctrl[i] = *rest;
    const int input = m->actuator_ctrladr[actuator_ids_[i]];
    if (!m->actuator_ctrllimited[input]) continue;
    const mjtNum* range = m->actuator_ctrlrange + 2 * input;
    ctrl[i] = std::clamp(ctrl[i], range[0], range[1]);
  }
}

void GroupCore::SettleLags(std::span<const double> q) const {
  Bind();
  RequireSize(q.size(), nq(), "joint");
  const mjModel* m = model();
  for (size_t i = 0; i < actuator_ids_.size(); ++i) {
    const int id = actuator_ids_[i];
    const std::optional<double> length = LengthFor(i, q);
    if (!length) continue;
    if (const auto ctrl = internal::RestingCtrl(m, id, *length))
      internal::SettleLag(m, data(), id, *ctrl);
  }
}

std::optional<CutCtrl> GroupCore::FindCutCtrl(std::span<const double> q,
                                              std::span<const double> ctrl, size_t from) const {
  Bind();
  const mjModel* m = model();
  for (size_t i = from; i < actuator_ids_.size(); ++i) {
    const int input = m->actuator_ctrladr[actuator_ids_[i]];
    const mjtNum* range = m->actuator_ctrlrange + 2 * input;
    const bool at_end = ctrl[i] <= range[0] || ctrl[i] >= range[1];
    if (!m->actuator_ctrllimited[input] || !at_end) continue;
    const std::optional<double> rest = RestingCtrlFor(i, q);
    if (!rest || (*rest >= range[0] && *rest <= range[1])) continue;
    const size_t joint =
        driven_[i] >= 0 ? static_cast<size_t>(driven_[i]) : lengths_->of_actuators[i].front().joint;
    return CutCtrl{i, joint, *rest, {range[0], range[1]}};
  }
  return std::nullopt;
}

void GroupCore::Integrate(std::span<double> q, std::span<const double> v) const {
  Bind();
  RequireSize(q.size(), nq(), "joint");
  RequireSize(v.size(), nv(), "joint velocity");
  size_t iq = 0, iv = 0;
  for (const int id : joint_ids_) {
    const int type = model()->jnt_type[id];
    const int linear = type == mjJNT_FREE ? 3 : type == mjJNT_BALL ? 0 : 1;
    for (int k = 0; k < linear; ++k) q[iq + k] += v[iv + k];
    if (PositionsOf(type) > 1) mju_quatIntegrate(&q[iq + linear], &v[iv + linear], 1);
    iq += PositionsOf(type);
    iv += VelocitiesOf(type);
  }
}

// Takes the frame by reference: Bind may have to look it up again first.
Pose GroupCore::FramePose(FrameId& frame) const {
  Bind();
  scene_.SyncPoses();
  const mjData* d = data();
  const int id = frame.id;
  if (frame.is_site) {
    return Pose::FromTranslationAndMatrix(d->site_xpos + 3 * id, d->site_xmat + 9 * id);
  }
  return Pose::FromWxyz(d->xpos + 3 * id, d->xquat + 4 * id);
}

Eigen::Vector3d GroupCore::gravity_in_base() const {
  Bind();
  if (base_is_carried_) scene_.SyncPoses();
  const mjtNum* matrix = base_.is_site ? data()->site_xmat : data()->xmat;
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rotation(matrix +
                                                                                9 * base_.id);
  // Avoids a product of matrices, which would be a call.
  return rotation.transpose().lazyProduct(
      Eigen::Map<const Eigen::Vector3d>(internal::EffectiveGravity(model())));
}

void GroupCore::Jacobian(Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> out) const {
  Bind();
  RequireSize(static_cast<size_t>(out.cols()), nv(), "Jacobian column");
  scene_.SyncPoses();
  const mjModel* m = model();
  const mjData* d = data();
  double* linear = jacobian_.data();
  double* angular = linear + 3 * static_cast<size_t>(m->nv);
  const double* point = leaf_.is_site ? d->site_xpos + 3 * leaf_.id : d->xpos + 3 * leaf_.id;
  mj_jac(m, d, linear, angular, point, leaf_.is_site ? m->site_bodyid[leaf_.id] : leaf_.id);
  for (int c = 0; c < nv(); ++c) {
    for (int r = 0; r < 3; ++r) {
      out(r, c) = linear[r * m->nv + dof_addresses_[c]];
      out(r + 3, c) = angular[r * m->nv + dof_addresses_[c]];
    }
  }
  for (const Follower& f : followers_) {
    const double slope = f.of_leader.slope(d->qpos[qpos_addresses_[f.leader]]);
    const auto column = static_cast<Eigen::Index>(f.leader);
    for (int r = 0; r < 3; ++r) {
      out(r, column) += slope * linear[r * m->nv + f.dof_address];
      out(r + 3, column) += slope * angular[r * m->nv + f.dof_address];
    }
  }
}

}  // namespace robocell
