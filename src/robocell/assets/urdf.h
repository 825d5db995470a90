// Reads URDF into plain data: links, joints, mimic joints, limits and the files of its meshes. The
// scene makes the model from it (scene/urdf_model.h).
//
//   const Urdf arm = ReadUrdf("/ws/arm/urdf/arm.urdf");
//   arm.joints[0].limit->effort;
//
// Numbers are the file's: metres, radians, kilograms. Angles `rpy` are extrinsic xyz. `line` is
// the element's line in the file.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace robocell::internal {

struct UrdfOrigin {
  std::array<double, 3> xyz = {}, rpy = {};
};

struct UrdfInertial {
  UrdfOrigin origin = {};
  double mass = 0;
  std::array<double, 6> inertia = {};  // xx, yy, zz, xy, xz, yz
  int line = 0;
};

enum class UrdfShape { kBox, kCylinder, kSphere, kCapsule, kMesh };

struct UrdfGeometry {
  bool collision = false;  // else visual
  std::string name = {};
  UrdfOrigin origin = {};
  UrdfShape shape = UrdfShape::kBox;
  // Box: full lengths. Cylinder and capsule: radius and full length. Sphere: radius. Mesh: scale.
  std::array<double, 3> size = {};
  std::string mesh = {};     // absolute path
  std::string written = {};  // the name of the mesh in the URDF
  std::optional<std::array<double, 4>> rgba = {};
  int line = 0;
};

struct UrdfLink {
  std::string name;
  std::optional<UrdfInertial> inertial = {};
  std::vector<UrdfGeometry> geometry = {};
  int line = 0;

  bool is_bare() const { return !inertial && geometry.empty(); }
  bool has_mass() const { return inertial && inertial->mass > 0; }
};

enum class UrdfJointType { kRevolute, kContinuous, kPrismatic, kFixed, kFloating };

struct UrdfMimic {
  std::string joint = {};
  double multiplier = 1, offset = 0;
  int line = 0;
};

struct UrdfJoint {
  std::string name = {}, parent = {}, child = {};
  UrdfJointType type = UrdfJointType::kFixed;
  UrdfOrigin origin = {};
  std::array<double, 3> axis = {1, 0, 0};
  std::optional<std::array<double, 2>> range = {};  // rad or m
  double effort = 0, velocity = 0;                  // 0: not limited
  double damping = 0, friction = 0;
  std::optional<UrdfMimic> mimic = {};
  bool has_transmission = false;  // a <transmission> or <ros2_control> moves it
  int line = 0;
};

struct Urdf {
  std::string name;
  std::filesystem::path file;
  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;
  bool has_transmissions = false;
  std::string root;                // the link that has no parent
  std::string mujoco;              // the text of its <mujoco> element, "" if it has none
  std::vector<std::string> notes;  // what was read differently than it may be meant
  std::vector<std::filesystem::path> manifests;  // package.xml of its packages

  const UrdfLink* link(std::string_view link_name) const;
  const UrdfJoint* joint(std::string_view joint_name) const;
  // Returns the joint that a link hangs on; null for the root.
  const UrdfJoint* parent_joint(std::string_view link_name) const;
  // Returns the links that fixed joints connect to this one, with it; the one nearest to the root
  // comes first.
  std::vector<const UrdfLink*> RigidWith(const UrdfLink& link) const;
  // Returns true if one of these has a mass.
  bool IsWeighed(const UrdfLink& link) const;
};

// Returns true if the file's first element is <robot>, that is a URDF or a xacro file.
bool IsUrdf(const std::filesystem::path& file);

// Returns the file that is read for a mesh: an OBJ or STL of the same name beside it if the engine
// cannot read its format, such as Collada; else the file itself. It may be missing.
std::filesystem::path ReadableMesh(const std::filesystem::path& mesh);

// Throws SpecError with all problems, each with file, line, element and the next step: unknown
// links, several roots, mimic joints in a circle, missing meshes, unknown packages, moving links
// without mass, xacro, Collada; IoError if the file cannot be read.
Urdf ReadUrdf(const std::filesystem::path& file);

}  // namespace robocell::internal
