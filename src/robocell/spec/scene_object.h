// An object of the scene: a model (mjcf_path) or a primitive (shape with size, rgba,
// mass and friction).
#pragma once

#include <array>
#include <optional>
#include <string>

#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/types.h"

namespace robocell {

enum class Shape { kBox, kSphere, kCylinder };
template <>
struct EnumNames<Shape> {
  static constexpr std::array kNames = {std::pair{Shape::kBox, "box"},
                                        std::pair{Shape::kSphere, "sphere"},
                                        std::pair{Shape::kCylinder, "cylinder"}};
};

// The kinds of friction at a contact; the numbers are MuJoCo's condim.
enum class Condim { kTangential = 3, kTorsional = 4, kRolling = 6 };
template <>
struct EnumNames<Condim> {
  static constexpr std::array kNames = {std::pair{Condim::kTangential, "tangential"},
                                        std::pair{Condim::kTorsional, "torsional"},
                                        std::pair{Condim::kRolling, "rolling"}};
};

struct SceneObject {
  std::string name = {};
  std::string mjcf_path = {};
  std::optional<Shape> shape = {};
  std::optional<Vec3> size = {};
  std::optional<Vec4> rgba = {};
  std::optional<double> mass = {};
  std::optional<Vec3> friction = {};
  std::optional<Condim> condim = {};
  AttachTarget attach_to = {};
  std::optional<Vec3> pos = {};
  Vec3 euler = {};
  Vec4 quat = kIdentityQuat;
  bool reset_root_pose = false;
  std::optional<bool> fixed = {};
  std::optional<bool> parked = {};

  static constexpr const char* kTypeName = "SceneObject";
  template <class V>
  static void Fields(V&& v) {
    v("name", &SceneObject::name,
      "Name in the scene. Names of a model's elements get the prefix `name_`; a primitive becomes "
      "body `name`, geom `name_geom` and joint `name_joint`.");
    v("mjcf_path", &SceneObject::mjcf_path, "Model file: path, `menagerie:...` or built-in name.");
    v("shape", &SceneObject::shape, "Primitive: box, sphere or cylinder.");
    v("size", &SceneObject::size,
      "Half sizes of a primitive, metres: box x y z; sphere radius 0 0; cylinder radius, half "
      "height, 0.",
      Bound::kNonNegative);
    v("rgba", &SceneObject::rgba, "Colour.", Bound::kFraction);
    v("mass", &SceneObject::mass, "Mass, kg.", Bound::kPositive);
    v("friction", &SceneObject::friction, "Sliding, torsional and rolling friction.",
      Bound::kNonNegative);
    v("condim", &SceneObject::condim,
      "Kinds of friction that act: tangential, torsional or rolling.");
    v("attach_to", &SceneObject::attach_to,
      "Frame of the object's pose. An object that is not free is fixed to it.");
    v("pos", &SceneObject::pos,
      "Position in the parent, metres. Unset: its origin; objects that a task adds then get a "
      "place "
      "at each start.");
    v("euler", &SceneObject::euler, "Orientation in the parent, degrees, extrinsic xyz.");
    v("quat", &SceneObject::quat, "Orientation in the parent, quaternion xyzw; instead of euler.");
    v("reset_root_pose", &SceneObject::reset_root_pose,
      "Drop the pose that the model file gives its root.");
    v("fixed", &SceneObject::fixed,
      "true: the object stays in place. false: it moves freely and falls. Unset: a model falls if "
      "its root has a free joint, and a primitive falls.");
    v("parked", &SceneObject::parked,
      "Set for objects of the pool, which are added and removed without compiling: true if a reset "
      "leaves the object outside of the scene, false if inside. Such objects move freely.");
  }
  Pose pose() const { return PlacementPose(pos.value_or(Vec3{}), euler, quat); }
  // Returns true if `pos` is set, even to the origin, or the rotation is not the identity.
  bool has_pose() const { return pos || euler != Vec3{} || quat != kIdentityQuat; }
  std::string Label() const { return LabelOf("object", name); }
  void Validate(Problems& problems) const;
};

// Returns the full name of an element of a model object without building a scene: ("table",
// "table_top") -> "table_table_top".
std::string SceneObjectElementName(const std::string& object, const std::string& element);

}  // namespace robocell
