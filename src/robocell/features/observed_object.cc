#include "robocell/features/observed_object.h"

#include <utility>

namespace robocell {
namespace {

BodyHandle RootOf(const Scene& scene, const std::string& object) {
  return {scene, scene.compiled()->object(object).root_body};
}

}  // namespace

ObservedObject::ObservedObject(const Scene& scene, std::string name, ObjectOfName object_of)
    : scene_(scene.inner()),
      name_(std::move(name)),
      object_of_(std::move(object_of)),
      object_(Present()),
      body_(RootOf(scene_, object_)) {}

Pose ObservedObject::pose_in_world() {
  if (object_of_) {
    std::string present = Present();
    if (present != object_) {
      body_ = RootOf(scene_, present);
      object_ = std::move(present);
    }
  }
  return body_.pose_in_world();
}

}  // namespace robocell
