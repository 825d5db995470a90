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

}  // namespace

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

KDL::JntArray ToKdl(std::span<const double> q) {
  KDL::JntArray out(static_cast<unsigned>(q.size()));
  for (std::size_t i = 0; i < q.size(); ++i) out(static_cast<unsigned>(i)) = q[i];
  return out;
}

}  // namespace robocell
