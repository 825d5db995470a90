// Random queries for inverse kinematics, and an independent judge of solutions: the engine.
#pragma once

#include <numbers>
#include <span>

#include "robocell/kinematics/testing/models.h"

namespace robocell {

// Returns values uniform in the limits; within half a turn of 0 without limits.
inline JointVector RandomJoints(const Chain& chain, Rng* rng) {
  JointVector q(chain.n_joints());
  for (int i = 0; i < chain.n_joints(); ++i) {
    const ChainJoint& joint = chain.joints()[i];
    q[i] = joint.limited ? rng->Uniform(joint.lower, joint.upper)
                         : rng->Uniform(-std::numbers::pi, std::numbers::pi);
  }
  return q;
}

inline bool InLimits(const Chain& chain, std::span<const double> q) {
  for (int i = 0; i < chain.n_joints(); ++i) {
    if (!(q[i] >= chain.joints()[i].lower && q[i] <= chain.joints()[i].upper)) return false;
  }
  return true;
}

// Judges a result by the engine: position and rotation as norms.
inline bool EngineAgrees(const TestModel& t, const Chain& chain, const Pose& target,
                         std::span<const double> q, double tolerance) {
  for (int i = 0; i < chain.n_joints(); ++i) t.data()->qpos[chain.joints()[i].qpos_address] = q[i];
  mj_kinematics(t.model(), t.data());
  const Transform tip = t.TipInBase(chain);
  const Eigen::Matrix3d difference = ToTransform(target).rotation * tip.rotation.transpose();
  return (tip.translation - target.translation()).norm() <= tolerance &&
         Eigen::AngleAxisd(difference).angle() <= tolerance;
}

// A robot of the Menagerie.
struct Arm {
  explicit Arm(const MenagerieArm& arm)
      : model(TestModel::FromFile(MenagerieModel(arm.folder, arm.file))),
        chain(model.model(), arm.base, arm.tip) {}
  TestModel model;
  Chain chain;
};

}  // namespace robocell
