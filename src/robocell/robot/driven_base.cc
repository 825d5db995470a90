#include "robocell/robot/driven_base.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/controller.h"

namespace robocell::internal {
namespace {

// Time in which full speed is reached, and lost again, s.
constexpr double kRampTime = 0.1;
// Planned share of the largest speeds: ticks that hold the mocap body still for two engine steps
// make the base up to 3.5 % faster for a moment.
constexpr double kPlannedShare = 0.96;
// Timestep from which on less is planned, s: effects that the engine leaves out of a step, such as
// the axes of a turning hand, make the base faster the longer the step is.
constexpr double kLongTimestep = 0.01;
constexpr double kFarthestTarget = 1e6;  // m, from the origin; farther is a mistake
// A base is blocked when contacts push on the robot with more than so many times what the weight
// and the fastest motion of the robot and its load ask for, and so many N. What touches the robot
// may be its load, up to so many times its own mass.
constexpr double kPushShare = 3, kPushOnTop = 20, kMostLoad = 5;
// Contacts block translation or rotation if they resist it with at least this share of the work
// with which they resist the other one.
constexpr double kBlockedShare = 0.1;

double PlannedShare(double timestep) {
  return kPlannedShare * std::sqrt(std::min(1.0, kLongTimestep / timestep));
}

BaseSpeeds SpeedsOf(const BaseConfig& config) {
  BaseSpeeds speeds;
  if (config.max_linear_speed) speeds.linear = *config.max_linear_speed;
  if (config.max_angular_speed) speeds.angular = *config.max_angular_speed;
  return speeds;
}

DrivenBase::Target ToTarget(const Pose& pose) {
  const Eigen::Vector3d& p = pose.translation();
  const Quaternion& q = pose.quaternion();
  return {p[0], p[1], p[2], q[0], q[1], q[2], q[3]};
}

// Lead of the mocap body that makes the base move as commanded. The engine
// turns the distance r between them and its rate r' into the acceleration -b r' - k r of the base,
// with b = 2 / (d t) and k = 1 / (d t z)^2 (time constant t, damping ratio z, impedance d). The
// mocap body has no velocity for the engine, so a base at speed v that is to have the acceleration
// a in the next step is b/k v + a/k behind.
struct Lead {
  double of_velocity = 0, of_acceleration = 0;  // b/k in s, 1/k in s^2

  Eigen::Vector3d operator()(const Eigen::Vector3d& v, const Eigen::Vector3d& a) const {
    return of_velocity * v + of_acceleration * a;
  }
};

Lead LeadOf(const mjModel* m, int equality) {
  const mjtNum* reference = m->eq_solref + mjNREF * static_cast<ptrdiff_t>(equality);
  const double impedance = m->eq_solimp[mjNIMP * static_cast<ptrdiff_t>(equality) + 1];
  if (reference[0] == 0) return {};
  if (reference[0] < 0)  // -k d^2 and -b d themselves
    return {impedance * reference[1] / reference[0], impedance * impedance / -reference[0]};
  const double time = std::max<double>(reference[0], 2 * m->opt.timestep);
  const double root = impedance * time * reference[1];
  return {2 * root * reference[1], root * root};
}

// Contact forces on the robot.
struct Push {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // N
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  // N m, about the base's origin
  double lever = 0;  // m, mean distance of the contacts from there, weighted by their forces
};

// Marks the roots of the bodies that move with the robot: its own, and those that active
// constraints hold on it or on one of these, such as a box in a suction cup and the lid on it.
void FindMoved(const mjModel* m, const mjData* d, int robot, std::span<uint8_t> moved) {
  std::ranges::fill(moved, 0);
  moved[robot] = 1;
  const auto can_move = [&](int root) {  // neither fixed in the world nor a mocap body
    return m->body_weldid[root] != 0 && m->body_mocapid[root] < 0;
  };
  for (bool has_more = true; has_more;) {
    has_more = false;
    for (int e = 0; e < m->neq; ++e) {
      const bool is_joined = m->eq_type[e] == mjEQ_WELD || m->eq_type[e] == mjEQ_CONNECT;
      if (!is_joined || !d->eq_active[e]) continue;
      const auto root_of = [&](int id) {
        return m->body_rootid[m->eq_objtype[e] == mjOBJ_SITE ? m->site_bodyid[id] : id];
      };
      const int a = root_of(m->eq_obj1id[e]), b = root_of(m->eq_obj2id[e]);
      if (moved[a] == moved[b] || !can_move(moved[a] ? b : a)) continue;
      moved[a] = moved[b] = 1;
      has_more = true;
    }
  }
}

Push PushOn(const mjModel* m, const mjData* d, int base, std::span<const uint8_t> moved) {
  const Eigen::Map<const Eigen::Vector3d> origin(d->xpos + 3 * static_cast<ptrdiff_t>(base));
  Push push;
  double sum = 0;
  for (int c = 0; c < d->ncon; ++c) {
    const mjContact& contact = d->contact[c];
    if (contact.geom[0] < 0 || contact.geom[1] < 0) continue;
    const auto is_moved = [&](int geom) { return moved[m->body_rootid[m->geom_bodyid[geom]]]; };
    const bool is_first = is_moved(contact.geom[0]), is_second = is_moved(contact.geom[1]);
    if (is_first == is_second) continue;
    mjtNum in_contact[6];
    Eigen::Vector3d force;
    mj_contactForce(m, d, c, in_contact);  // force on the second geom, along the contact's axes
    mju_mulMatTVec3(force.data(), contact.frame, in_contact);
    if (is_first) force = -force;
    const Eigen::Vector3d at = Eigen::Map<const Eigen::Vector3d>(contact.pos) - origin;
    push.force += force;
    push.moment += at.cross(force);
    push.lever += force.norm() * at.norm();
    sum += force.norm();
  }
  if (sum > 0) push.lever /= sum;
  return push;
}

// Returns true for a body that touches the robot or what moves with it.
bool Touch(const mjModel* m, const mjData* d, std::span<const uint8_t> moved, int root) {
  return std::any_of(d->contact, d->contact + d->ncon, [&](const mjContact& contact) {
    if (contact.geom[0] < 0 || contact.geom[1] < 0) return false;
    const int a = m->body_rootid[m->geom_bodyid[contact.geom[0]]];
    const int b = m->body_rootid[m->geom_bodyid[contact.geom[1]]];
    return (b == root && moved[a]) || (a == root && moved[b]);
  });
}

// The mass of the free bodies, with all that hangs on them, that touch the robot on this base or
// that a constraint holds on it, kg.
double LoadOf(const mjModel* m, const mjData* d, int base, std::span<const uint8_t> moved) {
  const int robot = m->body_rootid[base];
  double mass = 0;
  for (int body = 1; body < m->nbody; ++body) {
    if (m->body_parentid[body] != 0 || m->body_weldid[body] == 0 || body == robot) continue;
    if (Touch(m, d, moved, body) || moved[body]) mass += m->body_subtreemass[body];
  }
  return mass;
}

}  // namespace

DrivenBase::DrivenBase(const Scene& scene, GroupNames names, const BaseConfig& config,
                       std::string target_body, std::string weld)
    : JointGroupOf(scene, std::move(names), MoveGroupKind::kBase),
      target_body_(std::move(target_body)),
      weld_(std::move(weld)),
      speeds_(SpeedsOf(config)) {
  Bind();
  FollowOthers();
}

void DrivenBase::Bind() const {
  core().Bind();
  if (generation_ == core().scene().generation()) return;
  const mjModel* m = core().model();
  mocap_ = m->body_mocapid[RequireId(m, mjOBJ_BODY, target_body_, place())];
  equality_ = RequireId(m, mjOBJ_EQUALITY, weld_, place());
  moved_.resize(m->nbody);
  generation_ = core().scene().generation();
}

void DrivenBase::WriteMocap(const Pose& pose) const {
  pose.ToWxyz(written_.data(), written_.data() + 3);
  mjData* d = core().data();
  std::copy_n(written_.data(), 3, d->mocap_pos + 3 * mocap_);
  std::copy_n(written_.data() + 3, 4, d->mocap_quat + 4 * mocap_);
}

void DrivenBase::HoldAt(const Pose& pose) const {
  ramp_.Start(pose);
  target_ = ToTarget(pose);
  time_ = core().data()->time;
}

void DrivenBase::Hold() const {
  Bind();
  const Pose here = pose();
  WriteMocap(here);
  HoldAt(here);
}

void DrivenBase::FollowOthers() const {
  const uint64_t puts = core().scene().times_put(target_body_);
  const bool was_put = puts != puts_;
  puts_ = puts;
  const mjtNum* pos = core().data()->mocap_pos + 3 * mocap_;
  const mjtNum* quat = core().data()->mocap_quat + 4 * mocap_;
  if (!was_put && std::equal(pos, pos + 3, written_.begin()) &&
      std::equal(quat, quat + 4, written_.begin() + 3))
    return;
  std::copy_n(pos, 3, written_.begin());
  std::copy_n(quat, 4, written_.begin() + 3);
  HoldAt(Pose::FromWxyz(pos, quat));
}

void DrivenBase::SetPose(const Pose& pose) {
  Bind();
  Scene(core().scene()).SetBodyPose(core().names().leaf.name, pose);
  Hold();
}

void DrivenBase::SetJointPos(std::span<const double> q) {
  core().SetJointPos(q);
  Hold();
}

Pose DrivenBase::target() const {
  Bind();
  FollowOthers();
  const Target& t = target_;
  try {
    return Pose({t[0], t[1], t[2]}, Quaternion{t[3], t[4], t[5], t[6]});
  } catch (const ArgumentError& error) {
    throw ArgumentError(place() + ": the target: " + error.what());
  }
}

void DrivenBase::SetTarget(const Pose& pose) {
  RequireTarget(pose);
  Bind();
  FollowOthers();
  target_ = ToTarget(pose);
}

void DrivenBase::RequireTarget(const Pose& pose) const {
  const double most = pose.translation().cwiseAbs().maxCoeff();
  if (most <= kFarthestTarget) return;
  throw ArgumentError(
      fmt::format("{}: the target is {:g} m away along an axis of the world, which is too far; it "
                  "must be within {:g} m. Give metres",
                  place(), most, kFarthestTarget));
}

void DrivenBase::SetMaxSpeeds(const BaseSpeeds& speeds) {
  const auto good = [](double speed) { return speed > 0 && std::isfinite(speed); };
  if (!good(speeds.linear) || !good(speeds.angular)) {
    throw ArgumentError(
        fmt::format("{}: the largest speeds cannot be {} m/s and {} rad/s; both "
                    "must be above 0",
                    place(), speeds.linear, speeds.angular));
  }
  speeds_ = speeds;
}

// The weld is much stiffer than contacts: the base would push through whatever is in its way. What
// the contacts push back shows it. Forces that cancel out, as those of a grip, do not.
DrivenBase::Blocked DrivenBase::FindBlocked(const Pose& goal, const BaseSpeeds& planned) const {
  const mjModel* m = core().model();
  const mjData* d = core().data();
  if (d->ncon == 0) return {};
  const int base = m->eq_obj2id[equality_];
  const double arm = mju_dist3(d->subtree_com + 3 * base, d->xpos + 3 * base);
  const double turning = (planned.angular / kRampTime + planned.angular * planned.angular) * arm;
  const double acceleration = mju_norm3(m->opt.gravity) + planned.linear / kRampTime + turning;
  FindMoved(m, d, m->body_rootid[base], moved_);
  const Push push = PushOn(m, d, base, moved_);
  const auto pushes_more = [&](double mass) {
    const double most = kPushShare * acceleration * mass + kPushOnTop;
    return push.force.norm() > most || push.moment.norm() > most * push.lever;
  };
  const double mass = m->body_subtreemass[base];
  if (!pushes_more(mass)) return {};
  if (!pushes_more(mass + std::min(LoadOf(m, d, base, moved_), kMostLoad * mass))) return {};
  const Pose here = pose();
  const double along = -push.force.dot(goal.translation() - here.translation());
  const double around = -push.moment.dot(
      (Pose({0, 0, 0}, goal.quaternion()) * Pose({0, 0, 0}, here.quaternion()).inverse()).rotvec());
  if (along + around <= 0) return {};  // it leaves them
  return {.translation = along > 0 && along >= kBlockedShare * around,
          .rotation = around > 0 && around >= kBlockedShare * along};
}

void DrivenBase::Advance() {
  Bind();
  FollowOthers();
  const Pose goal = target();
  RequireTarget(goal);
  const double now = core().data()->time;
  const double seconds =
      std::clamp(now - time_, 0.0, std::max<double>(kLongestTick, core().model()->opt.timestep));
  time_ = now;
  if (seconds <= 0) return;
  const double share = PlannedShare(core().model()->opt.timestep);
  const double linear = share * speeds_.linear, angular = share * speeds_.angular;
  const Blocked blocked = FindBlocked(goal, {linear, angular});
  if (blocked.translation || blocked.rotation) {
    // If only one of them is blocked, the other one is held: a base that yielded in both would slip
    // round the obstacle.
    const Pose at = pose();
    const Pose& held = ramp_.pose();
    ramp_.Start(Pose(blocked.translation ? at.translation() : held.translation(),
                     blocked.rotation ? at.quaternion() : held.quaternion()));
    WriteMocap(ramp_.pose());
    return;
  }
  // The engine's step begins with the present pose and speed of the base.
  const Pose here = ramp_.pose();
  const Eigen::Vector3d v = ramp_.linear_velocity(), w = ramp_.angular_velocity();
  ramp_.Advance(goal, {linear, angular, linear / kRampTime, angular / kRampTime}, seconds);
  const Lead lead = LeadOf(core().model(), equality_);
  const Pose turned = Pose::FromRotvec({0, 0, 0}, lead(w, ramp_.angular_acceleration())) *
                      Pose({0, 0, 0}, here.quaternion());
  WriteMocap(Pose(here.translation() + lead(v, ramp_.linear_acceleration()), turned.quaternion()));
}

}  // namespace robocell::internal
