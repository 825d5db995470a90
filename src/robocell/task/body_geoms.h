// BodyGeoms: the collision geoms of a body's subtree, looked up once, and again after the scene was
// compiled again; for code that needs them at every step. Threads: those of the scene.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "robocell/motion/geom_extent.h"
#include "robocell/scene/body_handle.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

class BodyGeoms {
 public:
  BodyGeoms(const Scene& scene, std::string body)
      : scene_(scene.inner()), body_(scene_, std::move(body)) {}

  const BodyHandle& body() const { return body_; }
  const std::vector<int>& ids() const {
    if (generation_ != scene_.generation()) {
      ids_ = CollisionGeomsOf(scene_.model(), body_.id());
      generation_ = scene_.generation();
    }
    return ids_;
  }

 private:
  Scene scene_;
  BodyHandle body_;
  mutable std::vector<int> ids_;
  mutable uint64_t generation_ = 0;  // the generation of ids_; no scene has 0
};

}  // namespace robocell::internal
