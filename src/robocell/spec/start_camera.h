// StartCamera: a camera that each start of a run places anew: a copy of a camera of the models, a
// camera on a body, in the world, or somewhere around objects; with noise, and with what it has to
// see. Streams name it like any other camera of the scene (camera_spec.h).
//
//   start:
//     cameras:
//       wrist: {camera: wrist_camera, pos_noise: [0.005, 0.005, 0.005], rotation_noise: 2}
//       shoulder: {mount: link_base, pos: [0.1, 0.4, 0.6], look_at: [0.4, 0, 0], fovy: 60}
//       side:
//         around: [target, gripper]
//         distance: [0.6, 1.0]
//         height: [0.2, 0.6]
//         sees: {target: {pixels: 200, share: 0.5}, gripper: {pixels: 50}}
//
// task/start_cameras.h places them.
#pragma once

#include <optional>
#include <string>

#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/types.h"

namespace robocell {

// What a camera has to see of something when an episode begins.
struct CameraSight {
  int pixels = 1;
  double share = 0;
  NameList not_hidden_by = {};

  static constexpr const char* kTypeName = "CameraSight";
  template <class V>
  static void Fields(V&& v) {
    v("pixels", &CameraSight::pixels, "Fewest pixels of the image that show it.",
      Bound::kNonNegative);
    v("share", &CameraSight::share,
      "Smallest share of it that is in the image with nothing in front of it.", Bound::kFraction);
    v("not_hidden_by", &CameraSight::not_hidden_by,
      "Objects, bodies, `gripper` or `robot` that may not be in front of any part of it. Unset: "
      "none.");
  }
};

struct StartCamera {
  std::string camera = {};
  std::string mount = {};
  std::optional<Vec3> pos = {};
  Vec3 euler = {};
  Vec4 quat = kIdentityQuat;
  std::optional<Vec3> look_at = {};
  Vec3 up = {0, 0, 1};
  NameList around = {};
  Vec2 distance = {0.6, 1.2};
  Vec2 height = {0.2, 0.8};
  Vec2 azimuth = {-180, 180};
  double look_at_noise = 0;
  std::optional<double> fovy = {};
  Vec3 pos_noise = {0, 0, 0};
  double rotation_noise = 0;
  double fovy_noise = 0;
  Map<CameraSight> sees = {};
  int tries = 20;

  static constexpr double kFovy = 60;  // degrees, of a camera without a model's lens

  static constexpr const char* kTypeName = "StartCamera";
  template <class V>
  static void Fields(V&& v) {
    v("camera", &StartCamera::camera,
      "Camera of the robot (without its prefix) or of the scene whose mount, pose and lens it "
      "takes over. Unset: that of its own name, unless it has a `mount`, a `pos` or `around`.");
    v("mount", &StartCamera::mount,
      "Body or site of the robot (without its prefix) or of the scene that carries it. Unset: the "
      "world.");
    v("pos", &StartCamera::pos, "Position in the mount, metres.");
    v("euler", &StartCamera::euler, "Orientation in the mount, degrees, extrinsic xyz.");
    v("quat", &StartCamera::quat,
      "Orientation in the mount, quaternion xyzw (in YAML also quat_wxyz).");
    v("look_at", &StartCamera::look_at,
      "Point in the mount to look at, metres; instead of a rotation.");
    v("up", &StartCamera::up, "Direction in the mount that is up in the image of `look_at`.");
    v("around", &StartCamera::around,
      "Objects, bodies or `gripper` (the TCP): the camera stands somewhere around their middle and "
      "looks at it. Instead of a mount and a pose.");
    v("distance", &StartCamera::distance,
      "Horizontal distance from the middle of `around`, metres, smallest and largest.",
      Bound::kNonNegative);
    v("height", &StartCamera::height,
      "Height above the middle of `around`, metres, smallest and largest.");
    v("azimuth", &StartCamera::azimuth,
      "Direction from the middle of `around` to the camera, degrees about the vertical, smallest "
      "and largest: 0 is away from the robot's base, 90 to its left.");
    v("look_at_noise", &StartCamera::look_at_noise,
      "Largest random offset of the point that a camera with `around` or `look_at` looks at, "
      "metres along each axis.",
      Bound::kNonNegative);
    v("fovy", &StartCamera::fovy,
      "Vertical field of view, degrees. Unset: that of `camera`, else 60.", Bound::kPositive);
    v("pos_noise", &StartCamera::pos_noise,
      "Largest random offset along each axis of the camera (right, up, backwards), metres.",
      Bound::kNonNegative);
    v("rotation_noise", &StartCamera::rotation_noise,
      "Largest random rotation, about any axis, degrees.", Bound::kNonNegative);
    v("fovy_noise", &StartCamera::fovy_noise,
      "Largest random change of the vertical field of view, degrees.", Bound::kNonNegative);
    v("sees", &StartCamera::sees,
      "Objects, bodies, `gripper` or `robot`, and what the camera has to see of them when an "
      "episode begins.");
    v("tries", &StartCamera::tries,
      "Most poses of a camera with noise or `around` that are drawn for a start until it sees what "
      "it has to see.",
      Bound::kPositive);
  }
  void Validate(Problems& problems) const;

  // Returns true if nothing says where it is but a camera of the models.
  bool IsCopy() const { return !camera.empty() || (mount.empty() && !pos && around.empty()); }
  // Returns true if no two starts have the same camera.
  bool IsRandom() const {
    return !around.empty() || pos_noise != Vec3{} || rotation_noise > 0 || fovy_noise > 0 ||
           (look_at && look_at_noise > 0);
  }
};

}  // namespace robocell
