#include "robocell/kinematics/pose_table.h"

#include <algorithm>

#include "robocell/kinematics/base_inertial_parameters.h"
#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/normal_frames.h"

namespace robocell::internal {
namespace {

Eigen::DiagonalMatrix<double, 3> LeftHanded() { return {1, -1, 1}; }

PoseJoint::Twist TwistOf(const Eigen::Matrix3d& rotation) {
  using enum PoseJoint::Twist;
  if (rotation.col(0) != Eigen::Vector3d::UnitX()) return kAny;
  if (rotation(2, 1) == 1 && rotation(1, 1) == 0) return kQuarter;
  // For a twist below 1e-8 the cosine is 1 as well.
  return rotation(1, 1) == 1 && rotation(2, 1) == 0 ? kNone : kAboutX;
}

void PutStep(const JointModel& joint, bool first, PoseJoint* out) {
  out->twist = first ? PoseJoint::Twist::kAny : TwistOf(joint.fixed.rotation);
  out->twist_cosine = joint.fixed.rotation(1, 1);
  out->twist_sine = joint.fixed.rotation(2, 1);
  using Eigen::Map;
  Map<Eigen::Matrix3d> rotation(out->rotation);
  rotation = joint.fixed.rotation;
  if (!first) {
    rotation = LeftHanded() * joint.fixed.rotation;
    Map<Eigen::Vector3d>(out->translation) = LeftHanded() * joint.fixed.translation;
  }
  for (int k = 0; k < 3; ++k) out->shifted[k] = out->translation[k] != 0;
  out->reference = joint.reference;
  out->slide = joint.slide;
  out->turns = joint.slide ? 0 : 1;
  out->armature = joint.armature;
}

void PutLink(const LinkInertia& link, PoseJoint* out) {
  using Eigen::Map, Eigen::Vector3d;
  const Eigen::Matrix3d inertia = LeftHanded() * link.inertia * LeftHanded();
  out->mass = link.mass;
  out->weight_mass = link.weight_mass;
  Map<Vector3d>(out->moment) = LeftHanded() * link.moment;
  Map<Vector3d>(out->weight_moment) = LeftHanded() * link.weight_moment;
  Map<Vector3d>(out->inertia) = inertia.diagonal();
  Map<Vector3d>(out->inertia + 3) = Vector3d(inertia(0, 1), inertia(0, 2), inertia(1, 2));
}

bool IsPlain(const PoseTable& table) {
  using enum PoseJoint::Twist;
  const auto plain = [](const PoseJoint& joint) {
    return !joint.slide && !joint.shifted[1] && (joint.twist == kQuarter || joint.twist == kNone);
  };
  return !table.joints[0].slide && std::all_of(table.joints + 1, table.joints + table.n, plain);
}

}  // namespace

PoseTable TabulatePoses(const ChainModel& chain) {
  const ChainModel normal = WithBaseInertialParameters(InNormalFrames(chain));
  PoseTable table;
  table.n = normal.n;
  double mass = 0, weight = 0;
  for (int i = normal.n - 1; i >= 0; --i) {
    PoseJoint& joint = table.joints[i];
    PutStep(normal.joints[i], i == 0, &joint);
    PutLink(normal.joints[i].link, &joint);
    joint.mass_behind = mass += joint.mass;
    joint.weight_behind = weight += joint.weight_mass;
    joint.heavy = joint.mass_behind != 0;
    joint.weighs = joint.weight_behind != 0;
  }
  table.plain = IsPlain(table);
  using Eigen::Map, Eigen::Vector3d;
  Map<Vector3d>(table.origin) = normal.joints[0].fixed.translation;
  Map<Eigen::Matrix3d>(table.tip_rotation) = LeftHanded() * normal.last_to_tip.rotation;
  Map<Vector3d>(table.tip_translation) = LeftHanded() * normal.last_to_tip.translation;
  return table;
}

}  // namespace robocell::internal
