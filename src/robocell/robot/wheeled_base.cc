#include "robocell/robot/wheeled_base.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <Eigen/Geometry>
#include <Eigen/QR>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/drive_matrix.h"
#include "robocell/scene/hold_ctrl.h"

namespace robocell::internal {
namespace {

constexpr double kParallel = 0.99;  // cosine of the largest angle between axles
constexpr double kFarthest = 1e6;   // m, of a target; farther is a mistake
constexpr double kAcceleration = 1.5, kTurnAcceleration = 6;  // m/s^2, rad/s^2
constexpr double kWheelBraking = 0.8;                         // share of these with which it brakes
constexpr double kFar = 0.05;         // m, from where on the reference heads for the target's place
constexpr double kNear = 0.03;        // m, at which it no longer does
constexpr double kBackwards = 0.6;    // m; a target behind that is nearer is driven to backwards
constexpr double kAimed = 0.15;       // rad, within which it drives
constexpr double kThere = 0.01;       // m, within which it turns to the target's yaw
constexpr double kSmallTurn = 0.3;    // rad, which it turns on the way
constexpr double kGain = 8;           // 1/s, near the target
constexpr double kErrorGain = 4;      // 1/s, of the base's error
constexpr double kSideGain = 10;      // rad/m^2 of its error to the side
constexpr double kLost = 0.5;         // m from the reference: somebody else moved the base
constexpr double kLongestTick = 0.1;  // s; avoids a jump after a pause
constexpr double kWheelTime = 0.05;   // s, in which motors bring the wheels to speed

double Turned(double from, double to) { return std::remainder(to - from, 2 * kPi); }

// Returns the speed from which the base can stop in this distance.
double SpeedTo(double distance, double acceleration, double most) {
  const double away = std::abs(distance);
  const double speed =
      std::min({most, kGain * away, std::sqrt(2 * kWheelBraking * acceleration * away)});
  return distance < 0 ? -speed : speed;
}

}  // namespace

WheeledBase::WheeledBase(const Scene& scene, GroupNames names)
    : JointGroupOf(scene, std::move(names), MoveGroupKind::kBase) {
  Bind();
}

void WheeledBase::Bind() const {
  core().Bind();
  if (generation_ == core().scene().generation()) return;
  FindDrive();
  generation_ = core().scene().generation();
}

WheeledBase::Wheel WheeledBase::WheelOf(int joint) const {
  const mjModel* m = core().model();
  const mjData* d = core().data();
  const Pose root = leaf_frame_to_world();
  const int body = m->jnt_bodyid[joint];
  const std::string name = ElementName(m, mjOBJ_JOINT, joint);
  if (m->jnt_type[joint] != mjJNT_HINGE || !IsInSubtree(m, body, root_)) {
    throw ArgumentError(
        fmt::format("{}: '{}' is no hinge of a wheel on '{}'. Name the joints of the wheels that "
                    "drive the base",
                    place(), name, core().names().leaf.name));
  }
  const Eigen::Vector3d axis(d->xaxis + 3 * joint);
  double radius = 0;
  for (const bool colliding : {true, false}) {
    for (int g = 0; g < m->ngeom && !(radius > 0 && !colliding); ++g) {
      if (m->body_weldid[m->geom_bodyid[g]] != m->body_weldid[body]) continue;
      if (colliding && m->geom_contype[g] == 0 && m->geom_conaffinity[g] == 0) continue;
      const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> axes(d->geom_xmat +
                                                                                9 * g);
      for (int k = 0; k < 3; ++k) {
        // The box around the geom, across the axle.
        if (std::abs(axes.col(k).dot(axis)) < 0.7)
          radius = std::max<double>(radius, m->geom_aabb[6 * g + 3 + k]);
      }
    }
  }
  if (radius <= 0)
    throw ArgumentError(fmt::format(
        "{}: the wheel of joint '{}' has no geom that says how large it is", place(), name));
  const Eigen::Matrix3d from_world = root.rotation().transpose();
  const Eigen::Vector3d axle = from_world * axis;
  return {.at = from_world * (Eigen::Vector3d(d->xanchor + 3 * joint) - root.translation()),
          .ahead = axle.cross(Eigen::Vector3d::UnitZ()),
          .radius = radius};
}

void WheeledBase::FindDrive() const {
  const mjModel* m = core().model();
  core().scene().SyncPoses();
  root_ = RequireId(m, mjOBJ_BODY, core().names().leaf.name, place());
  root_dof_ = m->jnt_dofadr[m->body_jntadr[root_]];
  wheels_.clear();
  for (const int joint : core().joint_ids()) wheels_.push_back(WheelOf(joint));
  if (wheels_.size() < 2)
    throw ArgumentError(place() + ": a base on wheels needs the joints of at least two of them");
  Eigen::Vector3d ahead = wheels_.front().ahead;
  if (ahead.x() < -1e-6) ahead = -ahead;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double floor = 0;
  for (const Wheel& wheel : wheels_) {
    if (std::abs(wheel.ahead.dot(ahead)) < kParallel * ahead.norm() ||
        wheel.ahead.norm() < kParallel)
      throw ArgumentError(place() + ": the axles of the wheels are not parallel and level");
    middle += wheel.at / static_cast<double>(wheels_.size());
    floor += (wheel.at.z() - wheel.radius) / static_cast<double>(wheels_.size());
  }
  ahead.normalize();
  const Eigen::Vector3d left = Eigen::Vector3d::UnitZ().cross(ahead);
  const bool apart = std::ranges::any_of(wheels_, [&](const Wheel& wheel) {
    return std::abs((wheel.at - middle).dot(left)) > wheel.radius / 10;
  });
  if (!apart)
    throw ArgumentError(place() +
                        ": the wheels are behind each other, so that they cannot turn the base");
  base_ = Pose(Eigen::Vector3d(0, 0, floor));
  drive_ = Pose::FromRpy({middle.x(), middle.y(), floor}, {0, 0, std::atan2(ahead.y(), ahead.x())});
  kinds_.clear();
  std::vector<DriveLength> lengths;
  for (const int actuator : core().actuator_ids()) {
    const std::string name = ElementName(m, mjOBJ_ACTUATOR, actuator);
    const std::optional<CtrlMode> kind = ActuatorKind(m, actuator);
    const std::optional<DriveLength> length = LengthOver(m, actuator, core().joint_ids(), {});
    if (!kind || !length)
      throw ArgumentError(fmt::format(
          "{}: actuator '{}' is {}{}. Wheels are driven by velocity servos, "
          "motors or position servos",
          place(), name, DescribeActuator(m, actuator), length ? "" : ", not on the wheels alone"));
    kinds_.push_back(*kind);
    lengths.push_back(*length);
  }
  lengths_ = DriveMatrix(lengths, std::vector<double>(wheels_.size()));
  forces_ = lengths_.transpose().completeOrthogonalDecomposition().pseudoInverse();
  const auto wheels = static_cast<Eigen::Index>(wheels_.size());
  rates_.resize(wheels);
  torques_.resize(wheels);
}

double WheeledBase::time() const { return core().data()->time; }

Pose WheeledBase::pose() const {
  Bind();
  return leaf_frame_to_world() * base_;
}

Pose WheeledBase::drive_frame() const {
  Bind();
  return base_.inverse() * drive_;
}

void WheeledBase::SetPose(const Pose& pose) {
  Bind();
  leaving_.Warn(core().scene(), core().names().robot, place(), BaseKind::kPlanar, this->pose(),
                pose);
  const mjModel* m = core().model();
  for (const int joint : core().joint_ids()) core().data()->qvel[m->jnt_dofadr[joint]] = 0;
  Scene(core().scene()).SetBodyPose(core().names().leaf.name, pose * base_.inverse());
  Hold();
  ++puts_;
}

void WheeledBase::GetJointPos(std::span<double> out) const {
  const Pose here = pose();
  const Eigen::Vector3d ahead = here.rotation().col(0);
  const std::array<double, 3> q{here.translation().x(), here.translation().y(),
                                std::atan2(ahead.y(), ahead.x())};
  RequireValues([&] { return place(); }, "joint", std::span<const double>(q),
                static_cast<int>(out.size()));
  std::ranges::copy(q, out.begin());
}

void WheeledBase::GetJointVel(std::span<double> out) const {
  Bind();
  const mjData* d = core().data();
  // Linear velocities are in the world's axes, angular ones in the body's.
  const Eigen::Vector3d turn =
      leaf_frame_to_world().rotation() * Eigen::Vector3d(d->qvel + root_dof_ + 3);
  const std::array<double, 3> v{d->qvel[root_dof_], d->qvel[root_dof_ + 1], turn.z()};
  RequireValues([&] { return place(); }, "joint", std::span<const double>(v),
                static_cast<int>(out.size()));
  std::ranges::copy(v, out.begin());
}

void WheeledBase::GetJointTorque(std::span<double> out) const {
  Bind();
  const mjModel* m = core().model();
  const Pose root = leaf_frame_to_world();
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  double torque = 0;
  for (size_t w = 0; w < wheels_.size(); ++w) {
    const Wheel& wheel = wheels_[w];
    const int dof = m->jnt_dofadr[core().joint_ids()[w]];
    const Eigen::Vector3d push = core().data()->qfrc_actuator[dof] / wheel.radius * wheel.ahead;
    force += push;
    torque += wheel.at.cross(push).z();
  }
  force = root.rotation() * force;
  const std::array<double, 3> all{force.x(), force.y(), torque};
  RequireValues([&] { return place(); }, "joint", std::span<const double>(all),
                static_cast<int>(out.size()));
  std::ranges::copy(all, out.begin());
}

void WheeledBase::SetJointPos(std::span<const double> q) {
  RequireValues([&] { return place(); }, "joint", q, 3);
  SetPose(Pose::FromRpy({q[0], q[1], pose().translation().z()}, {0, 0, q[2]}));
}

void WheeledBase::SetJointVel(std::span<const double> v) {
  RequireValues([&] { return place(); }, "joint", v, 3);
  Bind();
  mjData* d = core().data();
  const int dof = root_dof_;
  const Eigen::Vector3d turn =
      leaf_frame_to_world().rotation().transpose() * Eigen::Vector3d(0, 0, v[2]);
  std::copy_n(v.data(), 2, d->qvel + dof);
  d->qvel[dof + 2] = 0;
  std::copy_n(turn.data(), 3, d->qvel + dof + 3);
}

std::vector<Interval> WheeledBase::joint_pos_limits() const {
  std::vector<Interval> limits(3);
  GetJointPosLimits(limits);
  return limits;
}

void WheeledBase::GetJointPosLimits(std::span<Interval> out) const {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  std::ranges::fill(out, Interval{-kAny, kAny});
}

void WheeledBase::CtrlForJointPos(std::span<const double> /*q*/, std::span<double> /*ctrl*/) const {
  throw ArgumentError(place() +
                      ": wheels have no controls that hold a place; the controller 'unicycle' "
                      "drives the base");
}

void WheeledBase::Integrate(std::span<double> q, std::span<const double> v) const {
  for (size_t i = 0; i < 3; ++i) q[i] += v[i];
}

void WheeledBase::Jacobian(Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> out) const {
  const Eigen::Vector3d off = pose().translation() - leaf_frame_to_world().translation();
  out.setZero();
  out(0, 0) = out(1, 1) = out(5, 2) = 1;
  out.block<3, 1>(0, 2) = -Eigen::Vector3d::UnitZ().cross(off);  // of the leaf, the root itself
}

std::vector<double> WheeledBase::JointsAt(const Pose& pose, std::span<const double> near) const {
  const Eigen::Vector3d ahead = pose.rotation().col(0);
  return {pose.translation().x(), pose.translation().y(),
          near[2] + Turned(near[2], std::atan2(ahead.y(), ahead.x()))};
}

void WheeledBase::CtrlForSpeed(const DriveSpeed& speed, double seconds, std::span<double> ctrl) {
  Bind();
  const mjModel* m = core().model();
  const mjData* d = core().data();
  const Eigen::Vector3d ahead = drive_.rotation().col(0);
  const double share = m->body_subtreemass[root_] / static_cast<double>(wheels_.size());
  for (size_t w = 0; w < wheels_.size(); ++w) {
    const Wheel& wheel = wheels_[w];
    const auto row = static_cast<Eigen::Index>(w);
    const Eigen::Vector3d turning =
        speed.turn * Eigen::Vector3d::UnitZ().cross(wheel.at - drive_.translation());
    rates_[row] = (speed.ahead * ahead + turning).dot(wheel.ahead) / wheel.radius;
    const double present = d->qvel[m->jnt_dofadr[core().joint_ids()[w]]];
    // Each wheel moves its share of the robot.
    torques_[row] = share * wheel.radius * wheel.radius / kWheelTime * (rates_[row] - present);
  }
  if (rolled_to_.empty()) {
    for (const int actuator : core().actuator_ids())
      rolled_to_.push_back(d->actuator_length[m->actuator_outadr[actuator]]);
  }
  for (size_t a = 0; a < kinds_.size(); ++a) {
    const int actuator = core().actuator_ids()[a];
    const auto row = static_cast<Eigen::Index>(a);
    const double moved = lengths_.row(row).dot(rates_);
    switch (kinds_[a]) {
      case CtrlMode::kVelocity:
        ctrl[a] = moved;
        break;
      case CtrlMode::kTorque:
        ctrl[a] = forces_.row(row).dot(torques_) / m->actuator_gainprm[mjNGAIN * actuator];
        break;
      case CtrlMode::kPosition:
        rolled_to_[a] += moved * seconds;
        ctrl[a] = FreeRestingCtrl(m, actuator, rolled_to_[a]).value_or(0);
        break;
    }
  }
}

std::unique_ptr<Controller> MakeUnicycleController(MoveGroup& group) {
  if (auto* base = dynamic_cast<WheeledBase*>(&group))
    return std::make_unique<UnicycleController>(*base);
  throw ArgumentError(group.place() +
                      ": the controller 'unicycle' drives a base on wheels; give the robot `base: "
                      "{kind: planar}`, a free joint and a base group with the wheels");
}

UnicycleController::UnicycleController(WheeledBase& base) : base_(base) { Reset(); }

UnicycleController::Place UnicycleController::DrivePlace(std::span<const double> q) const {
  const Pose drive = Pose::FromRpy({q[0], q[1], 0}, {0, 0, q[2]}) * base_.drive_frame();
  const Eigen::Vector3d ahead = drive.rotation().col(0);
  return {drive.translation().x(), drive.translation().y(), std::atan2(ahead.y(), ahead.x())};
}

void UnicycleController::HoldHere() const {
  puts_ = base_.puts();
  base_.GetJointPos(target_);
  reference_ = DrivePlace(target_);
  speed_ = {};
  is_far_ = false;
  base_.Hold();
}

void UnicycleController::FollowOthers() const {
  if (puts_ != base_.puts()) HoldHere();
}

void UnicycleController::Reset() {
  HoldHere();
  time_ = base_.time();
}

std::span<const double> UnicycleController::commanded_joint_pos() const {
  FollowOthers();
  return target_;
}

void UnicycleController::SetTarget(std::span<const double> target) {
  RequireValues([&] { return base_.place(); }, "joint", target, 3);
  if (std::hypot(target[0], target[1]) > kFarthest)
    throw ArgumentError(fmt::format("{}: the target is {:g} m away; give metres within {:g} m",
                                    base_.place(), std::hypot(target[0], target[1]), kFarthest));
  FollowOthers();
  std::ranges::copy(target, target_.begin());
}

// Moves the reference towards the target: to its place first, and then to its yaw.
void UnicycleController::Advance(const Place& target, double seconds) {
  const BaseSpeeds most = base_.most_speeds();
  const double dx = target.x - reference_.x, dy = target.y - reference_.y;
  const double away = std::hypot(dx, dy);
  is_far_ = away > (is_far_ ? kNear : kFar);
  DriveSpeed wanted;
  if (is_far_) {
    double aside = Turned(reference_.yaw, std::atan2(dy, dx));
    double sign = 1;
    if (std::abs(aside) > kPi / 2 && away < kBackwards) {
      sign = -1;
      aside = std::remainder(aside + kPi, 2 * kPi);
    }
    wanted.turn = SpeedTo(aside, kTurnAcceleration, most.angular);
    if (std::abs(aside) < kAimed) wanted.ahead = sign * SpeedTo(away, kAcceleration, most.linear);
  } else {
    const double left = dx * std::cos(reference_.yaw) + dy * std::sin(reference_.yaw);
    const double turn = Turned(reference_.yaw, target.yaw);
    wanted.ahead = SpeedTo(left, kAcceleration, most.linear);
    if (std::abs(left) < kThere || std::abs(turn) < kSmallTurn)
      wanted.turn = SpeedTo(turn, kTurnAcceleration, most.angular);
  }
  const double faster = kAcceleration * seconds, turns_faster = kTurnAcceleration * seconds;
  speed_.ahead += std::clamp(wanted.ahead - speed_.ahead, -faster, faster);
  speed_.turn += std::clamp(wanted.turn - speed_.turn, -turns_faster, turns_faster);
  const double middle = reference_.yaw + speed_.turn * seconds / 2;
  reference_.x += speed_.ahead * seconds * std::cos(middle);
  reference_.y += speed_.ahead * seconds * std::sin(middle);
  reference_.yaw += speed_.turn * seconds;
}

void UnicycleController::Compute(std::span<double> ctrl) {
  FollowOthers();
  RequireValues([&] { return base_.place(); }, "joint", std::span<const double>(target_), 3);
  std::array<double, 3> q;
  base_.GetJointPos(q);
  const Place here = DrivePlace(q);
  const double now = base_.time();
  const double seconds = std::clamp(now - time_, 0.0, kLongestTick);
  time_ = now;
  if (std::hypot(here.x - reference_.x, here.y - reference_.y) > kLost) {
    reference_ = here;
    speed_ = {};
    base_.Hold();
  }
  Advance(DrivePlace(target_), seconds);
  const double dx = reference_.x - here.x, dy = reference_.y - here.y;
  const double ahead = dx * std::cos(here.yaw) + dy * std::sin(here.yaw);
  const double aside = dy * std::cos(here.yaw) - dx * std::sin(here.yaw);
  const double turned = Turned(here.yaw, reference_.yaw);
  base_.CtrlForSpeed({.ahead = speed_.ahead * std::cos(turned) + kErrorGain * ahead,
                      .turn = speed_.turn + kSideGain * speed_.ahead * aside + kErrorGain * turned},
                     seconds, ctrl);
}

}  // namespace robocell::internal
