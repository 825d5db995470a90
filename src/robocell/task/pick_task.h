// PickTask: pick an object up. Success: it is at least `lift_height` above where the episode began,
// robots hold it, and nothing else touches it (held.h). The reward, 0 to 1, is half for a TCP near
// the object and half for its height; at success it is 1.
//
// A named object lies around its place in the root frame, turned about the root frame's z; without
// one the task draws its objects (object_task.h).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "robocell/task/object_task.h"
#include "robocell/task/pick_task_config.h"

namespace robocell {

class PickTask : public ObjectTask {
 public:
  explicit PickTask(const PickTaskConfig& fields)
      : ObjectTask({.name = fields.object,
                    .lift_height = fields.lift_height,
                    .spread = fields.spread,
                    .rotate = fields.rotate,
                    .refer = fields.refer,
                    .kinds = fields.objects.names}) {}
  // For a scene that has the object already. `object`: name in the scene; `kind`: its word in the
  // instruction; `all_objects`: objects whose poses are observed.
  PickTask(std::string object, std::string kind, std::vector<std::string> all_objects,
           double lift_height)
      : ObjectTask({.name = std::move(object),
                    .word = std::move(kind),
                    .lift_height = lift_height,
                    .all = std::move(all_objects)}) {}

  BodyPoses Starts(Rng& rng) override {
    if (draws_objects()) {
      DrawTarget(rng);
      return {};
    }
    return {{object().name(), root() * Start(rng)}};
  }
  std::string instruction() const override { return "pick up " + phrase(); }
  std::string why_not_done() const override { return "not lifted"; }

 private:
  bool IsDone(const Scene& scene) override { return IsLifted(scene); }
  double Progress() const override { return 0.5 * Nearness() + 0.5 * Lifted(); }
};

}  // namespace robocell
