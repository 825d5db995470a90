#include "robocell/scene/place_camera.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"
#include "robocell/spec/camera_spec.h"
#include "robocell/spec/types.h"

namespace robocell::internal {

void PlaceCamera(Scene& scene, const std::string& camera, const Pose& pose_in_parent, double fovy) {
  const std::string place = "scene '" + scene.name() + "'";
  // The elements of a list are in boxes that can be changed in place, as Python does it.
  const auto& boxes = scene.spec().cameras.boxes();
  const auto box =
      std::ranges::find_if(boxes, [&](const auto& each) { return each->name == camera; });
  if (box == boxes.end()) {
    std::vector<std::string> names;
    for (const auto& each : boxes) names.push_back(each->name);
    throw NotFoundError(NoSuchName(place, "camera of its spec", camera, names));
  }
  CameraSpec& spec = **box;
  const bool in_body =
      spec.attach_to.kind == AttachKind::kWorld || spec.attach_to.kind == AttachKind::kBody;
  if (!in_body || !spec.mjcf_path.empty()) {
    throw ArgumentError(fmt::format(
        "{}: camera '{}' cannot be moved: only cameras without a model, attached to the world or "
        "to a body, can",
        place, camera));
  }
  mjModel* m = scene.mutable_model();
  const int id = RequireId(m, mjOBJ_CAMERA, camera, place);
  pose_in_parent.ToWxyz(m->cam_pos + 3 * id, m->cam_quat + 4 * id);
  m->cam_fovy[id] = fovy;
  spec.pos = ToVec3(pose_in_parent.translation());
  spec.euler = {};
  spec.quat = pose_in_parent.quaternion();
  spec.look_at.reset();
  spec.fovy = fovy;
  scene.PosesChanged();
}

}  // namespace robocell::internal
