#include "robocell/kinematics/kdl_segments.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/kinematics/chain_builder.h"
#include "robocell/kinematics/pose_error.h"

namespace robocell {
namespace {

Eigen::Matrix3d PointMass(double mass, const Eigen::Vector3d& at) {
  return mass * (at.squaredNorm() * Eigen::Matrix3d::Identity() - at * at.transpose());
}

void SetInertia(KdlSegment& segment, const LinkInertia& link, const Transform& joint_to_body) {
  if (link.mass <= 0) return;
  const Eigen::Vector3d com = link.moment / link.mass;
  const Eigen::Matrix3d about_com = link.inertia - PointMass(link.mass, com);
  const Transform body_to_joint = joint_to_body.inverse();
  segment.mass = link.mass;
  segment.centre = body_to_joint * com;
  segment.inertia = body_to_joint.rotation * about_com * body_to_joint.rotation.transpose();
}

// Returns the joint's motion by `distance`, in the frame of its description.
Transform Motion(const KdlSegment& segment, double distance) {
  if (segment.motion == KdlSegment::Motion::kSlide) {
    return {Eigen::Matrix3d::Identity(), segment.axis * distance};
  }
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(distance, segment.axis).toRotationMatrix();
  return {turn, segment.origin - turn * segment.origin};
}

// `to_last` is the frame of the previous segment, in the moved frame of its joint.
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

// Returns a right-handed frame on a joint's axis, with the axis as z.
Transform OnAxis(const KdlSegment& segment) {
  const Eigen::Vector3d z = segment.axis.normalized(), x = z.unitOrthogonal();
  Transform frame;
  frame.rotation << x, z.cross(x), z;
  frame.translation = segment.origin;
  return frame;
}

// Adds a segment's inertia to the link that carries it.
void AddInertia(const KdlSegment& segment, const Transform& segment_in_joint, LinkInertia* link) {
  const Eigen::Vector3d com = segment_in_joint * segment.centre;
  const Eigen::Matrix3d& r = segment_in_joint.rotation;
  link->mass += segment.mass;
  link->moment += segment.mass * com;
  link->inertia += r * segment.inertia * r.transpose() + PointMass(segment.mass, com);
  link->weight_mass = link->mass;
  link->weight_moment = link->moment;
}

std::string JointName(const KdlSegment& segment, int number) {
  constexpr const char* kUnnamed = "NoName";  // KDL's word for it
  if (!segment.joint.empty() && segment.joint != kUnnamed) return segment.joint;
  if (!segment.name.empty() && segment.name != kUnnamed) return segment.name;
  return fmt::format("joint{}", number + 1);
}

// Adds segments one by one.
class SegmentReader {
 public:
  explicit SegmentReader(std::span<const std::array<double, 2>> limits) : limits_(limits) {}

  void Read(const KdlSegment& segment) {
    if (segment.motion == KdlSegment::Motion::kFixed) {
      frame_ = frame_ * segment.tip;
    } else {
      AddJoint(segment);
    }
    if (model.n > 0) AddInertia(segment, frame_, &model.joints[model.n - 1].link);
  }

  void Finish() {
    if (model.n == 0) throw ArgumentError("KDL chain: it has no joint that moves");
    if (!limits_.empty() && limits_.size() != joints.size()) {
      throw ArgumentError(fmt::format("KDL chain: {} for {}", Counted(std::ssize(limits_), "limit"),
                                      Counted(std::ssize(joints), "moving joint")));
    }
    model.last_to_tip = frame_;
    internal::MeasureLength(&model);
  }

  ChainModel model;
  std::vector<ChainJoint> joints;

 private:
  void AddJoint(const KdlSegment& segment) {
    if (model.n == kMaxChainJoints) {
      throw ArgumentError(fmt::format("KDL chain: a chain has at most {} joints, this one has more",
                                      kMaxChainJoints));
    }
    const ChainJoint described = Describe(segment);
    RefuseTheSameName(described.name);
    const Transform at_reference = OnAxis(segment);
    JointModel& joint = model.joints[model.n++];
    joint.fixed = frame_ * at_reference;
    joint.joint_to_body = frame_ =
        at_reference.inverse() * Motion(segment, segment.offset).inverse() * segment.tip;
    joint.slide = described.type == ChainJointType::kSlide;
    joint.reference = -segment.offset;
    joint.lower = described.lower;
    joint.upper = described.upper;
    joint.armature = segment.armature;
    joints.push_back(described);
  }

  // Equal names would make joints ambiguous.
  void RefuseTheSameName(const std::string& name) const {
    for (const ChainJoint& joint : joints) {
      if (joint.name != name) continue;
      throw ArgumentError(fmt::format(
          "KDL chain: two of its joints are named '{}'; give each a different name", name));
    }
  }

  ChainJoint Describe(const KdlSegment& segment) const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const size_t i = joints.size();
    const bool slide = segment.motion == KdlSegment::Motion::kSlide;
    ChainJoint joint{.name = JointName(segment, static_cast<int>(i)),
                     .body = segment.name,
                     .type = slide ? ChainJointType::kSlide : ChainJointType::kHinge,
                     .lower = -kInfinity,
                     .upper = kInfinity};
    if (i >= limits_.size()) return joint;
    joint.lower = limits_[i][0];
    joint.upper = limits_[i][1];
    joint.limited = std::isfinite(joint.lower) || std::isfinite(joint.upper);
    if (std::isinf(joint.lower) && joint.lower == joint.upper) {
      throw ArgumentError(
          fmt::format("KDL chain: the limits of joint '{}' are both {}; a joint without limits has "
                      "-inf and inf",
                      joint.name, joint.lower));
    }
    if (joint.lower <= joint.upper) return joint;
    throw ArgumentError(
        fmt::format("KDL chain: the limits of joint '{}' are {} and {}; give the "
                    "lower one first",
                    joint.name, joint.lower, joint.upper));
  }

  std::span<const std::array<double, 2>> limits_;
  Transform frame_;  // present segment in the moved frame of the last joint, or in the base
};

}  // namespace

Chain ChainFromSegments(const std::vector<KdlSegment>& segments,
                        std::span<const std::array<double, 2>> limits) {
  SegmentReader reader(limits);
  for (const KdlSegment& segment : segments) reader.Read(segment);
  reader.Finish();
  return Chain({.model = reader.model,
                .joints = std::move(reader.joints),
                .base_body = "base",
                .tip = ChainTip::Body(segments.back().name)});
}

void SetOffset(const Transform& pose_at_zero, double speed, KdlSegment* segment) {
  if (std::abs(speed - 1) > 1e-9) {
    throw ArgumentError(
        fmt::format("KDL chain: joint '{}' has scale {}; a chain's joints have scale 1. Turn its "
                    "axis around for -1, scale the joint values for others",
                    segment->joint, speed));
  }
  segment->offset = segment->motion == KdlSegment::Motion::kSlide
                        ? (pose_at_zero.translation - segment->origin).dot(segment->axis)
                        : internal::RotationVector(pose_at_zero.rotation).dot(segment->axis);
}

void SetInertiaAboutOrigin(const Eigen::Matrix3d& inertia, KdlSegment* segment) {
  segment->inertia = inertia - PointMass(segment->mass, segment->centre);
}

std::vector<KdlSegment> KdlSegments(const Chain& chain) {
  std::vector<KdlSegment> segments;
  Transform to_last;
  const std::vector<ChainJoint>& joints = chain.link_joints();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const ChainJoint& joint = joints[i];
    const bool more_on_body = i + 1 < joints.size() && joints[i + 1].body == joint.body;
    const JointModel& model = LinksOf(chain.model()).joints[i];
    segments.push_back(SegmentOf(more_on_body ? joint.name : joint.body, joint, model, to_last));
    to_last = model.joint_to_body;
  }
  if (chain.tip().kind == ChainTip::Kind::kSite || chain.tip().name != joints.back().body) {
    segments.push_back({.name = chain.tip().name,
                        .joint = {},
                        .tip = to_last.inverse() * chain.model().last_to_tip});
  }
  return segments;
}

}  // namespace robocell
