// The dynamics of Chain (chain.h), all in the axes of the base frame.
#include "robocell/kinematics/chain.h"

namespace robocell {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Mass, moment and inertia of a link about the origin of its joint frame, turned into base axes.
struct TurnedLink {
  double mass;
  Vector3d moment;
  Matrix3d inertia;
};

TurnedLink Turn(const LinkInertia& link, const Matrix3d& rotation) {
  return {link.mass, rotation * link.moment, rotation * link.inertia * rotation.transpose()};
}

// What a link must be pushed with, about its joint's origin.
struct Force {
  Vector3d force;
  Vector3d torque;
};

struct Motion {
  Vector3d omega = Vector3d::Zero();  // angular velocity
  Vector3d alpha = Vector3d::Zero();  // angular acceleration
  Vector3d accel = Vector3d::Zero();  // linear acceleration of the joint's origin
};

// Moves the point of reference by `arm` on the same rigid body.
void Shift(const Vector3d& arm, Motion* m) {
  m->accel += m->alpha.cross(arm) + m->omega.cross(m->omega.cross(arm));
}

void AddJointMotion(bool slide, const Vector3d& z, double qd, double qdd, Motion* m) {
  if (slide) {
    m->accel += z * qdd + 2 * m->omega.cross(z * qd);
  } else {
    m->alpha += z * qdd + m->omega.cross(z * qd);
    m->omega += z * qd;
  }
}

Force NewtonEuler(const TurnedLink& link, const Motion& m) {
  const Vector3d spin = link.inertia * m.omega;
  return {
      link.mass * m.accel + m.alpha.cross(link.moment) + m.omega.cross(m.omega.cross(link.moment)),
      link.inertia * m.alpha + m.omega.cross(spin) + link.moment.cross(m.accel)};
}

// Inertia of all links from one joint on, about the base's origin.
struct Composite {
  double mass = 0;
  Vector3d moment = Vector3d::Zero();
  Matrix3d inertia = Matrix3d::Zero();

  void Add(const TurnedLink& link, const Vector3d& p) {
    mass += link.mass;
    const Vector3d& h = link.moment;
    const double trace = 2 * h.dot(p) + link.mass * p.squaredNorm();
    inertia += link.inertia + trace * Matrix3d::Identity() - h * p.transpose() - p * h.transpose() -
               link.mass * p * p.transpose();
    moment += h + link.mass * p;
  }
};

// A joint's unit motion as a twist of the base's origin.
struct UnitTwist {
  Vector3d linear;
  Vector3d angular;
};

UnitTwist TwistOf(bool slide, const Vector3d& axis, const Vector3d& origin) {
  if (slide) return {axis, Vector3d::Zero()};
  return {origin.cross(axis), axis};
}

}  // namespace

void Chain::GravityTorques(std::span<const double> q, const Vector3d& gravity,
                           std::span<double> out) const {
  CheckSize("q", q.size());
  CheckSize("torques", out.size());
  std::array<Vector3d, kMaxChainJoints> axis, origin, moment;
  WalkChain(model_, q.data(), [&](int i, const Transform& frame) {
    axis[i] = frame.rotation.col(2);
    origin[i] = frame.translation;
    moment[i] = frame.rotation * model_.joints[i].link.weight_moment;
  });
  double mass = 0;
  Vector3d sum = Vector3d::Zero();  // of mass * position, about the base's origin
  for (int i = n_joints() - 1; i >= 0; --i) {
    const double m = model_.joints[i].link.weight_mass;
    mass += m;
    sum += moment[i] + m * origin[i];
    const Vector3d torque = (sum - mass * origin[i]).cross(gravity);
    out[i] = model_.joints[i].slide ? -mass * axis[i].dot(gravity) : -axis[i].dot(torque);
  }
}

void Chain::MassMatrix(std::span<const double> q, Eigen::Ref<Eigen::MatrixXd> out) const {
  CheckSize("q", q.size());
  CheckSize("rows of the mass matrix", out.rows());
  CheckSize("columns of the mass matrix", out.cols());
  std::array<UnitTwist, kMaxChainJoints> twists;
  std::array<Transform, kMaxChainJoints> frames;
  WalkChain(model_, q.data(), [&](int i, const Transform& frame) {
    frames[i] = frame;
    twists[i] = TwistOf(model_.joints[i].slide, frame.rotation.col(2), frame.translation);
  });
  Composite body;
  for (int j = n_joints() - 1; j >= 0; --j) {
    body.Add(Turn(model_.joints[j].link, frames[j].rotation), frames[j].translation);
    const UnitTwist& t = twists[j];
    const Vector3d momentum = body.mass * t.linear + t.angular.cross(body.moment);
    const Vector3d spin = body.inertia * t.angular + body.moment.cross(t.linear);
    for (int i = 0; i <= j; ++i) {
      out(i, j) = out(j, i) = twists[i].linear.dot(momentum) + twists[i].angular.dot(spin);
    }
    out(j, j) += model_.joints[j].armature;
  }
}

void Chain::CoriolisTorques(std::span<const double> q, std::span<const double> qd,
                            std::span<double> out) const {
  const JointVector still(n_joints());
  InverseDynamics(q, qd, still, Vector3d::Zero(), out);
}

void Chain::InverseDynamics(std::span<const double> q, std::span<const double> qd,
                            std::span<const double> qdd, const Vector3d& gravity_in_base,
                            std::span<double> out) const {
  CheckSize("q", q.size());
  CheckSize("qd", qd.size());
  CheckSize("qdd", qdd.size());
  CheckSize("torques", out.size());
  std::array<Vector3d, kMaxChainJoints> axis, origin;
  std::array<Force, kMaxChainJoints> forces;
  Motion motion;
  Vector3d at = Vector3d::Zero();
  WalkChain(model_, q.data(), [&](int i, const Transform& frame) {
    axis[i] = frame.rotation.col(2);
    origin[i] = frame.translation;
    Shift(origin[i] - at, &motion);
    at = origin[i];
    AddJointMotion(model_.joints[i].slide, axis[i], qd[i], qdd[i], &motion);
    const LinkInertia& link = model_.joints[i].link;
    forces[i] = NewtonEuler(Turn(link, frame.rotation), motion);
    forces[i].force -= link.weight_mass * gravity_in_base;
    forces[i].torque -= (frame.rotation * link.weight_moment).cross(gravity_in_base);
  });
  Force sum{Vector3d::Zero(), Vector3d::Zero()};
  for (int i = n_joints() - 1; i >= 0; --i) {
    if (i + 1 < n_joints()) sum.torque += (origin[i + 1] - origin[i]).cross(sum.force);
    sum.force += forces[i].force;
    sum.torque += forces[i].torque;
    out[i] = axis[i].dot(model_.joints[i].slide ? sum.force : sum.torque) +
             model_.joints[i].armature * qdd[i];
  }
}

}  // namespace robocell
