#include "robocell/scene/body_handle.h"

#include <mujoco/mujoco.h>

#include "robocell/mujoco/names.h"

namespace robocell {

BodyHandle::BodyHandle(const Scene& scene, std::string name)
    : scene_(scene.inner()), name_(std::move(name)) {
  id();
}

int BodyHandle::id() const {
  if (generation_ != scene_.generation()) {
    id_ = RequireId(scene_.model(), mjOBJ_BODY, name_, "scene '" + scene_.name() + "'");
    generation_ = scene_.generation();
  }
  return id_;
}

Pose BodyHandle::pose_in_world() const {
  scene_.SyncPoses();
  const mjData* data = scene_.data();
  return Pose::FromWxyz(data->xpos + 3 * id(), data->xquat + 4 * id());
}

}  // namespace robocell
