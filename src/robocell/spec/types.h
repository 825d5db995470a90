// Small value types that several specs share: numbers as plain arrays, attachment targets,
// placements.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "robocell/math/pose.h"
#include "robocell/spec/fields.h"

namespace robocell {

using Vec2 = std::array<double, 2>;
using Vec3 = std::array<double, 3>;
using Vec4 = std::array<double, 4>;
using Vec6 = std::array<double, 6>;

inline constexpr Vec4 kIdentityQuat = {0, 0, 0, 1};  // xyzw

inline Eigen::Vector3d ToEigen(const Vec3& v) { return {v[0], v[1], v[2]}; }
inline Vec3 ToVec3(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }

// The kinds of elements to which something can be attached.
enum class AttachKind {
  kWorld,       // the world frame
  kRoot,        // the rig's root frame: root_frame_to_world
  kSharedBase,  // the rig's shared base frame
  kBody,        // a body, site or frame by its full name
  kSite,
  kFrame,
  kRobotBase,   // the root body of the robot of that name
  kAttachment,  // the attachment site of the robot of that name
};

template <>
struct EnumNames<AttachKind> {
  static constexpr std::array kNames = {
      std::pair{AttachKind::kWorld, "world"},
      std::pair{AttachKind::kRoot, "root"},
      std::pair{AttachKind::kSharedBase, "shared_base"},
      std::pair{AttachKind::kBody, "body"},
      std::pair{AttachKind::kSite, "site"},
      std::pair{AttachKind::kFrame, "frame"},
      std::pair{AttachKind::kRobotBase, "robot_base"},
      std::pair{AttachKind::kAttachment, "attachment"},
  };
};

// (kind, name); in YAML `world`, `root`, `shared_base` or `{site: pinch_site}`.
struct AttachTarget {
  AttachKind kind = AttachKind::kWorld;
  std::string name = {};

  bool operator==(const AttachTarget&) const = default;
};

inline AttachTarget World() { return {}; }
inline AttachTarget Root() { return {AttachKind::kRoot, ""}; }
inline AttachTarget SharedBase() { return {AttachKind::kSharedBase, ""}; }
inline AttachTarget Body(std::string name) { return {AttachKind::kBody, std::move(name)}; }
inline AttachTarget Site(std::string name) { return {AttachKind::kSite, std::move(name)}; }
inline AttachTarget Frame(std::string name) { return {AttachKind::kFrame, std::move(name)}; }
inline AttachTarget RobotBase(std::string robot) {
  return {AttachKind::kRobotBase, std::move(robot)};
}
inline AttachTarget Attachment(std::string robot) {
  return {AttachKind::kAttachment, std::move(robot)};
}

// The pose made of the fields pos (m), euler (degrees, extrinsic xyz) and quat (xyzw). At most one
// of euler and quat may differ from the identity; validation reports it otherwise.
Pose PlacementPose(const Vec3& pos, const Vec3& euler, const Vec4& quat);

}  // namespace robocell
