// Converts to and from PyKDL through PyKDL's own functions, because two extensions that each know
// KDL::Chain cannot exchange one.
#include <cmath>

#include "kinematics.h"
#include "python_owner.h"
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

class Reader {
 public:
  Reader() : kdl_(ImportPyKdl()) {}

  robocell::Chain Chain(nb::handle chain, std::span<const std::array<double, 2>> limits) const {
    if (!nb::isinstance(chain, kdl_.attr("Chain")))
      ThrowType(FieldPath("chain"), "a PyKDL.Chain", chain);
    std::vector<KdlSegment> segments;
    const int count = nb::cast<int>(chain.attr("getNrOfSegments")());
    for (int i = 0; i < count; ++i) segments.push_back(Segment(chain.attr("getSegment")(i)));
    return ChainFromSegments(segments, limits);
  }

  static Eigen::Vector3d Vector(nb::handle v) {
    return {nb::cast<double>(v[0]), nb::cast<double>(v[1]), nb::cast<double>(v[2])};
  }

 private:
  static Transform Frame(nb::handle frame) {
    Transform out;
    const nb::object rotation = frame.attr("M");
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c)
        out.rotation(r, c) = nb::cast<double>(rotation[nb::make_tuple(r, c)]);
    }
    out.translation = Vector(frame.attr("p"));
    return out;
  }

  KdlSegment Segment(nb::handle segment) const {
    KdlSegment out{.name = nb::cast<std::string>(segment.attr("getName")()), .joint = {}};
    out.tip = Frame(segment.attr("getFrameToTip")());
    const nb::object inertia = segment.attr("getInertia")();
    out.mass = nb::cast<double>(inertia.attr("getMass")());
    out.centre = Vector(inertia.attr("getCOG")());
    const nb::object about_origin = inertia.attr("getRotationalInertia")();
    Eigen::Matrix3d i;
    for (int k = 0; k < 9; ++k) i(k / 3, k % 3) = nb::cast<double>(about_origin[nb::int_(k)]);
    SetInertiaAboutOrigin(i, &out);
    const nb::object joint = segment.attr("getJoint")();
    const auto type = nb::cast<std::string>(joint.attr("getTypeName")());
    if (type.starts_with("Trans") || type.starts_with("Rot")) {
      ReadJoint(joint, type.starts_with("Trans"), &out);
      out.armature = Armature(segment);
    }
    return out;
  }

  static void ReadJoint(nb::handle joint, bool slide, KdlSegment* out) {
    out->motion = slide ? KdlSegment::Motion::kSlide : KdlSegment::Motion::kRotate;
    out->joint = nb::cast<std::string>(joint.attr("getName")());
    out->origin = Vector(joint.attr("JointOrigin")());
    out->axis = Vector(joint.attr("JointAxis")()).normalized();
    const nb::object unit = joint.attr("twist")(1.0);
    const double speed = Vector(unit.attr(slide ? "vel" : "rot")).dot(out->axis);
    SetOffset(Frame(joint.attr("pose")(0.0)), speed, out);
  }

  // PyKDL does not return a joint's inertia. KDL's dynamics of the segment alone give it: the
  // inertia beyond the segment's own mass and its own inertia about the axis.
  double Armature(nb::handle segment) const {
    const auto resistance = [this](nb::handle one) {
      nb::object chain = kdl_.attr("Chain")();
      chain.attr("addSegment")(one);
      nb::object mass = kdl_.attr("JntSpaceInertiaMatrix")(1);
      kdl_.attr("ChainDynParam")(chain, kdl_.attr("Vector")(0.0, 0.0, 0.0))
          .attr("JntToMass")(kdl_.attr("JntArray")(1), mass);
      return nb::cast<double>(mass[nb::make_tuple(0, 0)]);
    };
    const nb::object joint = segment.attr("getJoint")(), types = kdl_.attr("Joint");
    const bool slide = nb::cast<std::string>(joint.attr("getTypeName")()).starts_with("Trans");
    const nb::object bare =
        types(joint.attr("getName")(), joint.attr("JointOrigin")(), joint.attr("JointAxis")(),
              types.attr(slide ? "TransAxis" : "RotAxis"));
    const nb::object without =
        kdl_.attr("Segment")(segment.attr("getName")(), bare, segment.attr("getFrameToTip")(),
                             segment.attr("getInertia")());
    const double armature = resistance(segment) - resistance(without);
    return std::abs(armature) < 1e-12 ? 0 : armature;
  }

  nb::object kdl_;
};

}  // namespace

Chain FromPyKdl(nb::handle chain, std::span<const std::array<double, 2>> limits) {
  return Reader().Chain(chain, limits);
}

nb::object ToPyKdl(const Wrench& wrench) {
  const nb::object kdl = ImportPyKdl();
  const auto vector = [&](const Eigen::Vector3d& v) {
    return kdl.attr("Vector")(v.x(), v.y(), v.z());
  };
  return kdl.attr("Wrench")(vector(wrench.force), vector(wrench.torque));
}

std::optional<Wrench> FromPyKdlWrench(nb::handle wrench) {
  if (!nb::hasattr(wrench, "force") || !nb::hasattr(wrench, "torque")) return std::nullopt;
  return Wrench{Reader::Vector(wrench.attr("force")), Reader::Vector(wrench.attr("torque"))};
}

nb::object ToPyKdl(std::span<const double> values) {
  nb::object array = ImportPyKdl().attr("JntArray")(values.size());
  for (size_t i = 0; i < values.size(); ++i) array[nb::int_(i)] = values[i];
  return array;
}

// PyKDL's solvers keep a pointer to their chain, not the chain. A returned chain lives as long as
// the chain that it was made from; it is returned again unless segments were added to it.
nb::object ToPyKdl(const Chain& chain) {
  if (!chain.companion()) chain.companion() = KeepAlive(nb::list());
  nb::list given = nb::borrow<nb::list>(ObjectOf(chain.companion()));
  if (nb::len(given) > 0) {
    const nb::object last = given[nb::len(given) - 1];
    const auto segments = nb::cast<size_t>(last.attr("getNrOfSegments")());
    if (segments == KdlSegments(chain).size()) return last;
  }
  given.append(Maker().Chain(chain));
  return given[nb::len(given) - 1];
}

}  // namespace robocell::python
