// ObservedObject: an object by the name under which it is observed. In a scene that serves all
// starts the name may stand for another object after each reset.
//
//   ObservedObject target(scene, "target", [&](const Scene&, const std::string& name) {
//     return drawn.at(name);
//   });
//   Pose pose = target.pose_in_world();
//
// Throws NotFoundError for an object that the scene does not have, and the errors of the function.
// Threads: those of the scene.
#pragma once

#include <functional>
#include <string>

#include "robocell/math/pose.h"
#include "robocell/scene/body_handle.h"
#include "robocell/scene/scene.h"

namespace robocell {

// Returns the name of the object of the scene for which an observed name stands at present.
using ObjectOfName = std::function<std::string(const Scene& scene, const std::string& name)>;

class ObservedObject {
 public:
  // Without a function, `name` is that of an object of the scene.
  ObservedObject(const Scene& scene, std::string name, ObjectOfName object_of = {});

  const std::string& name() const { return name_; }
  Pose pose_in_world();

 private:
  std::string Present() const { return object_of_ ? object_of_(scene_, name_) : name_; }

  Scene scene_;
  std::string name_;
  ObjectOfName object_of_;
  std::string object_;  // the object of body_
  BodyHandle body_;
};

}  // namespace robocell
