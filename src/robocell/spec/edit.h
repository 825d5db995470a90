// Small changes to a model while it is loaded, which save a copy of its file. One edit changes,
// adds or deletes one element and sets some of its attributes; units are SI and radians, euler
// angles are in degrees, quaternions xyzw.
//
//   edits:
//     - {body: link_base, pos: [0, 0, 0]}
//     - {geom: {body: left_finger, index: 3}, friction: [1, 0.005, 0.0001]}
//     - {actuator: {joint: joint2}, name: servo2}
//     - {add_site: tool, body: flange, pos: [0, 0, 0.1]}
//     - {delete: {camera: demo_view}}
#pragma once

#include <optional>
#include <string>

#include "robocell/spec/element_ref.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/types.h"

namespace robocell {

struct Edit {
  // The element to change: exactly one of these, or one of the add_* fields (then `body` or `site`
  // gives the place), or `remove`.
  std::optional<ElementRef> body = {};
  std::optional<ElementRef> site = {};
  std::optional<ElementRef> joint = {};
  std::optional<ElementRef> geom = {};
  std::optional<ElementRef> camera = {};
  std::optional<ElementRef> actuator = {};
  std::optional<std::string> add_site = {};
  std::optional<std::string> add_camera = {};
  std::optional<std::string> add_sensor = {};
  std::optional<ElementRef> remove = {};
  // Attributes.
  std::optional<std::string> name = {};
  std::optional<Vec3> pos = {};
  std::optional<Vec4> quat = {};
  std::optional<Vec3> euler = {};
  std::optional<Vec6> xyaxes = {};
  std::optional<Vec2> range = {};
  std::optional<Vec2> ctrlrange = {};
  std::optional<Vec2> forcerange = {};
  std::optional<double> fovy = {};
  std::optional<double> damping = {};
  std::optional<double> armature = {};
  std::optional<double> frictionloss = {};
  std::optional<double> kp = {};
  std::optional<double> kv = {};
  std::optional<double> mass = {};
  std::optional<Vec3> friction = {};
  std::optional<Vec3> size = {};
  std::optional<Vec4> rgba = {};
  std::optional<int> condim = {};
  std::optional<std::string> type = {};

  static constexpr const char* kTypeName = "Edit";
  template <class V>
  static void Fields(V&& v) {
    v("body", &Edit::body, "Body to change, or parent of the added element.");
    v("site", &Edit::site, "Site to change, or site of the added sensor.");
    v("joint", &Edit::joint, "Joint to change; unnamed ones as {body, index}.");
    v("geom", &Edit::geom, "Geom to change; unnamed ones as {body, index}.");
    v("camera", &Edit::camera, "Camera to change.");
    v("actuator", &Edit::actuator,
      "Actuator to change; unnamed ones as {joint: name}, the joint on which they act.");
    v("add_site", &Edit::add_site, "Name of a site to add to `body`.");
    v("add_camera", &Edit::add_camera, "Name of a camera to add to `body`.");
    v("add_sensor", &Edit::add_sensor,
      "Name of a sensor of `type` (force, torque, gyro, accelerometer) to add at `site`.");
    v("delete", &Edit::remove, "Element to delete, as {kind: name}.");
    v("name", &Edit::name, "A name for an element that has none.");
    v("pos", &Edit::pos, "Position in the parent, metres.");
    v("quat", &Edit::quat, "Orientation in the parent, quaternion xyzw (in YAML also quat_wxyz).");
    v("euler", &Edit::euler, "Orientation in the parent, degrees, extrinsic xyz.");
    v("xyaxes", &Edit::xyaxes, "Orientation by the x and y axes in the parent.");
    v("range", &Edit::range, "Joint range, rad or m.");
    v("ctrlrange", &Edit::ctrlrange, "Actuator control range.");
    v("forcerange", &Edit::forcerange, "Actuator force range, N or Nm.");
    v("fovy", &Edit::fovy, "Camera's vertical field of view, degrees.", Bound::kPositive);
    v("damping", &Edit::damping, "Joint damping.", Bound::kNonNegative);
    v("armature", &Edit::armature, "Joint armature.", Bound::kNonNegative);
    v("frictionloss", &Edit::frictionloss, "Joint friction loss.", Bound::kNonNegative);
    v("kp", &Edit::kp, "Position gain of a servo.", Bound::kNonNegative);
    v("kv", &Edit::kv, "Velocity gain of a servo.", Bound::kNonNegative);
    v("mass", &Edit::mass, "Mass of a geom or body, kg.", Bound::kNonNegative);
    v("friction", &Edit::friction, "Geom friction: sliding, torsional, rolling.",
      Bound::kNonNegative);
    v("size", &Edit::size, "Geom or site size, metres.", Bound::kNonNegative);
    v("rgba", &Edit::rgba, "Colour.", Bound::kFraction);
    v("condim", &Edit::condim, "Contact dimension of a geom: 1, 3, 4 or 6.");
    v("type", &Edit::type, "Type of an added sensor.");
  }
  // Returns the kind of element that is changed or added, and whether it is added.
  ElementKind kind() const;
  // Returns a label for messages: "edit of joint 'elbow'".
  std::string Label() const;
  void Validate(Problems& problems) const;
};

}  // namespace robocell
