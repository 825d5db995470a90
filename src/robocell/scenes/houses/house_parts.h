// What the generator of houses builds with, before there is a model: bodies of simple shapes, joints,
// and slots in which objects are put. Metres, kilograms, radians. Private to scenes/houses.
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <Eigen/Core>

namespace robocell::internal {

enum class PartShape { kBox, kCylinder, kSphere, kCapsule, kEllipsoid };
// What a part may touch; the names of the classes in the files of houses.
enum class PartClass { kStructure, kWall, kArticulated, kObject, kVisual };

struct HousePart {
  PartShape shape = PartShape::kBox;
  Eigen::Vector3d pos = Eigen::Vector3d::Zero();
  Eigen::Vector3d half = Eigen::Vector3d::Zero();  // half sizes; cylinder: radius, half length, 0
  std::string material;
  std::string name = {};
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // of the shape's z
  double yaw = 0;                                   // about that axis
  PartClass part_class = PartClass::kStructure;
  double density = 500;
};

struct HouseJoint {
  std::string name;
  bool is_slide = false;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double range = 0;  // it opens from 0 to this
  double damping = 0.2, friction = 0.1;
};

// A space in which objects are put: on top of something, or inside of it.
struct HouseSlot {
  Eigen::Vector3d pos = Eigen::Vector3d::Zero();  // the middle of its floor, in the body
  double half_x = 0, half_y = 0, height = 0;
  bool is_container = false;
};

struct HouseBody {
  std::string name = {};
  Eigen::Vector3d pos = Eigen::Vector3d::Zero();  // in the parent
  double yaw = 0;
  std::optional<HouseJoint> joint = {};
  bool is_free = false;  // an object that moves freely
  std::vector<HousePart> parts = {};
  std::vector<HouseSlot> slots = {};
  std::vector<HouseBody> children = {};
};

// A piece of furniture or an object, with what the metadata say of it.
struct HouseThing {
  std::string category = {};  // "CoffeeTable"
  std::vector<std::string> words = {};
  Eigen::Vector3d size =
      Eigen::Vector3d::Zero();  // its bounding box; its middle is above its origin
  HouseBody body = {};
};

// Shorthands: boxes by their middles and half sizes, cylinders upright, or along an axis.
inline HousePart Box(const Eigen::Vector3d& pos, const Eigen::Vector3d& half,
                     const std::string& material) {
  return {.shape = PartShape::kBox, .pos = pos, .half = half, .material = material};
}
inline HousePart Cylinder(const Eigen::Vector3d& pos, double radius, double half_length,
                          const std::string& material,
                          const Eigen::Vector3d& axis = Eigen::Vector3d::UnitZ()) {
  return {.shape = PartShape::kCylinder,
          .pos = pos,
          .half = {radius, half_length, 0},
          .material = material,
          .axis = axis};
}
inline HousePart Capsule(const Eigen::Vector3d& pos, double radius, double half_length,
                         const std::string& material, const Eigen::Vector3d& axis) {
  return {.shape = PartShape::kCapsule,
          .pos = pos,
          .half = {radius, half_length, 0},
          .material = material,
          .axis = axis};
}

}  // namespace robocell::internal
