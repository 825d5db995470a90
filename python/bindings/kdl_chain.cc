// PyKDL.Chain of a robot, made through PyKDL's own constructors: two extensions that each know
// KDL::Chain cannot hand one over.
#include "kinematics.h"
#include "values.h"
#include "robocell/kinematics/kdl_segments.h"

namespace robocell::python {
namespace {

using namespace nb::literals;

class Maker {
 public:
  Maker() : kdl_(ImportPyKdl()) {}

  nb::object Chain(const robocell::Chain& chain) const {
    nb::object out = kdl_.attr("Chain")();
    for (const KdlSegment& segment : KdlSegments(chain)) out.attr("addSegment")(Segment(segment));
    return out;
  }

 private:
  nb::object Vector(const Eigen::Vector3d& v) const {
    return kdl_.attr("Vector")(v.x(), v.y(), v.z());
  }

  nb::object Frame(const Transform& t) const {
    const Eigen::Matrix3d& r = t.rotation;
    return kdl_.attr("Frame")(kdl_.attr("Rotation")(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1),
                                                    r(1, 2), r(2, 0), r(2, 1), r(2, 2)),
                              Vector(t.translation));
  }

  nb::object Joint(const KdlSegment& segment) const {
    const nb::object joint = kdl_.attr("Joint");
    if (segment.motion == KdlSegment::Motion::kFixed) return joint(joint.attr("Fixed"));
    const bool slide = segment.motion == KdlSegment::Motion::kSlide;
    return joint(segment.joint, Vector(segment.origin), Vector(segment.axis),
                 joint.attr(slide ? "TransAxis" : "RotAxis"), 1.0, segment.offset,
                 segment.armature);
  }

  nb::object Inertia(const KdlSegment& segment) const {
    if (segment.mass <= 0) return kdl_.attr("RigidBodyInertia").attr("Zero")();
    const Eigen::Matrix3d& i = segment.inertia;
    return kdl_.attr("RigidBodyInertia")(
        segment.mass, Vector(segment.centre),
        kdl_.attr("RotationalInertia")(i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2)));
  }

  nb::object Segment(const KdlSegment& segment) const {
    return kdl_.attr("Segment")(segment.name, Joint(segment), Frame(segment.tip), Inertia(segment));
  }

  nb::object kdl_;
};

}  // namespace

nb::object ToPyKdl(const Chain& chain) { return Maker().Chain(chain); }

}  // namespace robocell::python
