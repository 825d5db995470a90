#include "robocell/kinematics/kdl_bridge.h"

#include "robocell/kinematics/kdl_segments.h"

namespace robocell {
namespace {

KDL::Vector ToKdl(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

KDL::Frame ToKdl(const Transform& t) {
  const Eigen::Matrix3d& r = t.rotation;
  return {KDL::Rotation(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1),
                        r(2, 2)),
          ToKdl(t.translation)};
}

Eigen::Vector3d FromKdl(const KDL::Vector& v) { return {v.x(), v.y(), v.z()}; }

Eigen::Matrix3d FromRows(const double* nine) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(nine);
}

KDL::Joint JointOf(const KdlSegment& segment) {
  if (segment.motion == KdlSegment::Motion::kFixed) return KDL::Joint(KDL::Joint::Fixed);
  const auto type =
      segment.motion == KdlSegment::Motion::kSlide ? KDL::Joint::TransAxis : KDL::Joint::RotAxis;
  return KDL::Joint(segment.joint, ToKdl(segment.origin), ToKdl(segment.axis), type, 1,
                    segment.offset, segment.armature);
}

KDL::RigidBodyInertia InertiaOf(const KdlSegment& segment) {
  if (segment.mass <= 0) return KDL::RigidBodyInertia::Zero();
  const Eigen::Matrix3d& i = segment.inertia;
  return KDL::RigidBodyInertia(
      segment.mass, ToKdl(segment.centre),
      KDL::RotationalInertia(i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2)));
}

bool Slides(const KDL::Joint& joint) {
  const KDL::Joint::JointType type = joint.getType();
  return type == KDL::Joint::TransAxis || type == KDL::Joint::TransX ||
         type == KDL::Joint::TransY || type == KDL::Joint::TransZ;
}

void ReadJoint(const KDL::Joint& joint, KdlSegment* out) {
  if (joint.getType() == KDL::Joint::Fixed) return;
  out->motion = Slides(joint) ? KdlSegment::Motion::kSlide : KdlSegment::Motion::kRotate;
  out->joint = joint.getName();
  out->origin = FromKdl(joint.JointOrigin());
  out->axis = FromKdl(joint.JointAxis()).normalized();
  out->armature = joint.getInertia();
  const KDL::Twist unit = joint.twist(1);
  const KDL::Frame at_zero = joint.pose(0);
  SetOffset({FromRows(at_zero.M.data), FromKdl(at_zero.p)},
            FromKdl(Slides(joint) ? unit.vel : unit.rot).dot(out->axis), out);
}

KdlSegment ReadSegment(const KDL::Segment& segment) {
  KdlSegment out{.name = segment.getName(), .joint = {}};
  ReadJoint(segment.getJoint(), &out);
  const KDL::Frame tip = segment.getFrameToTip();
  out.tip = {FromRows(tip.M.data), FromKdl(tip.p)};
  const KDL::RigidBodyInertia& inertia = segment.getInertia();
  out.mass = inertia.getMass();
  out.centre = FromKdl(inertia.getCOG());
  SetInertiaAboutOrigin(FromRows(inertia.getRotationalInertia().data), &out);
  return out;
}

}  // namespace

Chain FromKdl(const KDL::Chain& chain, std::span<const std::array<double, 2>> limits) {
  std::vector<KdlSegment> segments;
  for (const KDL::Segment& segment : chain.segments) segments.push_back(ReadSegment(segment));
  return ChainFromSegments(segments, limits);
}

KDL::Chain ToKdl(const Chain& chain) {
  KDL::Chain out;
  for (const KdlSegment& segment : KdlSegments(chain)) {
    out.addSegment(
        KDL::Segment(segment.name, JointOf(segment), ToKdl(segment.tip), InertiaOf(segment)));
  }
  return out;
}

KDL::Frame ToKdl(const Pose& pose) { return ToKdl(ToTransform(pose)); }

Pose FromKdl(const KDL::Frame& frame) {
  return Pose(Eigen::Map<const Eigen::Vector3d>(frame.p.data),
              Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(frame.M.data));
}

KDL::Twist ToKdl(const Twist& twist) { return {ToKdl(twist.linear), ToKdl(twist.angular)}; }

Twist FromKdl(const KDL::Twist& twist) { return {FromKdl(twist.vel), FromKdl(twist.rot)}; }

KDL::Wrench ToKdl(const Wrench& wrench) { return {ToKdl(wrench.force), ToKdl(wrench.torque)}; }

Wrench FromKdl(const KDL::Wrench& wrench) {
  return {FromKdl(wrench.force), FromKdl(wrench.torque)};
}

JointVector FromKdl(const KDL::JntArray& q) {
  return JointVector(std::span<const double>(q.data.data(), q.rows()));
}

KDL::JntArray ToKdl(std::span<const double> q) {
  KDL::JntArray out(static_cast<unsigned>(q.size()));
  for (std::size_t i = 0; i < q.size(); ++i) out(static_cast<unsigned>(i)) = q[i];
  return out;
}

}  // namespace robocell
