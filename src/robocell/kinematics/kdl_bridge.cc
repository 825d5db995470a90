#include "robocell/kinematics/kdl_bridge.h"

namespace robocell {
namespace {

KDL::Vector ToKdl(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

KDL::Frame ToKdl(const Transform& t) {
  const Eigen::Matrix3d& r = t.rotation;
  return {KDL::Rotation(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1),
                        r(2, 2)),
          ToKdl(t.translation)};
}

KDL::RigidBodyInertia InertiaInBody(const LinkInertia& link, const Transform& joint_to_body) {
  if (link.mass <= 0) return KDL::RigidBodyInertia::Zero();
  const Eigen::Vector3d com = link.moment / link.mass;
  const Eigen::Matrix3d about_com =
      link.inertia -
      link.mass * (com.squaredNorm() * Eigen::Matrix3d::Identity() - com * com.transpose());
  const Transform body_to_joint = joint_to_body.inverse();
  const Eigen::Matrix3d i = body_to_joint.rotation * about_com * body_to_joint.rotation.transpose();
  return KDL::RigidBodyInertia(
      link.mass, ToKdl(body_to_joint * com),
      KDL::RotationalInertia(i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2)));
}

// `to_last` is the frame of the segment before, in the moved frame of its joint.
KDL::Segment SegmentOf(const std::string& name, const ChainJoint& joint, const JointModel& model,
                       const Transform& to_last) {
  const Transform at_reference = to_last.inverse() * model.fixed;
  const KDL::Joint kdl(joint.name, ToKdl(at_reference.translation),
                       ToKdl(Eigen::Vector3d(at_reference.rotation.col(2))),
                       model.slide ? KDL::Joint::TransAxis : KDL::Joint::RotAxis, 1,
                       -model.reference, model.armature);
  // KDL wants the segment's frame for q = 0.
  const KDL::Frame motion = kdl.pose(0) * kdl.pose(model.reference).Inverse();
  return KDL::Segment(name, kdl, motion * ToKdl(at_reference * model.joint_to_body),
                      InertiaInBody(model.link, model.joint_to_body));
}

}  // namespace

KDL::Chain ToKdl(const Chain& chain) {
  KDL::Chain out;
  Transform to_last;
  for (int i = 0; i < chain.n_joints(); ++i) {
    const ChainJoint& joint = chain.joints()[i];
    const bool more_on_body = i + 1 < chain.n_joints() && chain.joints()[i + 1].body == joint.body;
    const JointModel& model = chain.model().joints[i];
    out.addSegment(SegmentOf(more_on_body ? joint.name : joint.body, joint, model, to_last));
    to_last = model.joint_to_body;
  }
  if (chain.tip().kind == ChainTip::Kind::kSite || chain.tip().name != chain.joints().back().body) {
    out.addSegment(KDL::Segment(chain.tip().name, KDL::Joint(KDL::Joint::Fixed),
                                ToKdl(to_last.inverse() * chain.model().last_to_tip)));
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
