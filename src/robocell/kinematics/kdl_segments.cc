#include "robocell/kinematics/kdl_segments.h"

namespace robocell {
namespace {

void SetInertia(KdlSegment& segment, const LinkInertia& link, const Transform& joint_to_body) {
  if (link.mass <= 0) return;
  const Eigen::Vector3d com = link.moment / link.mass;
  const Eigen::Matrix3d about_com =
      link.inertia -
      link.mass * (com.squaredNorm() * Eigen::Matrix3d::Identity() - com * com.transpose());
  const Transform body_to_joint = joint_to_body.inverse();
  segment.mass = link.mass;
  segment.centre = body_to_joint * com;
  segment.inertia = body_to_joint.rotation * about_com * body_to_joint.rotation.transpose();
}

// The joint's motion by `distance`, in the frame in which it is described.
Transform Motion(const KdlSegment& segment, double distance) {
  if (segment.motion == KdlSegment::Motion::kSlide) {
    return {Eigen::Matrix3d::Identity(), segment.axis * distance};
  }
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(distance, segment.axis).toRotationMatrix();
  return {turn, segment.origin - turn * segment.origin};
}

// `to_last` is the frame of the segment before, in the moved frame of its joint.
KdlSegment SegmentOf(const std::string& name, const ChainJoint& joint, const JointModel& model,
                     const Transform& to_last) {
  const Transform at_reference = to_last.inverse() * model.fixed;
  KdlSegment segment{
      .name = name,
      .joint = joint.name,
      .motion = model.slide ? KdlSegment::Motion::kSlide : KdlSegment::Motion::kRotate,
      .origin = at_reference.translation,
      .axis = at_reference.rotation.col(2),
      .offset = -model.reference,
      .armature = model.armature};
  segment.tip = Motion(segment, -model.reference) * at_reference * model.joint_to_body;
  SetInertia(segment, model.link, model.joint_to_body);
  return segment;
}

}  // namespace

std::vector<KdlSegment> KdlSegments(const Chain& chain) {
  std::vector<KdlSegment> segments;
  Transform to_last;
  for (int i = 0; i < chain.n_joints(); ++i) {
    const ChainJoint& joint = chain.joints()[i];
    const bool more_on_body = i + 1 < chain.n_joints() && chain.joints()[i + 1].body == joint.body;
    const JointModel& model = chain.model().joints[i];
    segments.push_back(SegmentOf(more_on_body ? joint.name : joint.body, joint, model, to_last));
    to_last = model.joint_to_body;
  }
  if (chain.tip().kind == ChainTip::Kind::kSite || chain.tip().name != chain.joints().back().body) {
    segments.push_back({.name = chain.tip().name,
                        .joint = {},
                        .tip = to_last.inverse() * chain.model().last_to_tip});
  }
  return segments;
}

}  // namespace robocell
