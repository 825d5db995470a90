// Refusal: why a start could not be made. It is a value: refusals are counted and reported, they
// are not errors.
#pragma once

#include <map>
#include <string>
#include <utility>

namespace robocell {

// Counts of reasons, by Refusal::counted_as().
using RefusalCounts = std::map<std::string, int>;

// Reasons are few and counted, details are for reading. Tasks have reasons of their own, which
// stand beside what refuses (grasp_check.h); those of the stages that all tasks share are listed
// here.
struct Refusal {
  static constexpr const char* kNoFreePlace = "no free place for the objects";
  static constexpr const char* kUnsettled = "objects did not come to rest";
  static constexpr const char* kNoReachableBasePose = "no base pose reaches the object";
  static constexpr const char* kBaseInCollision = "no base pose is free of collisions";
  static constexpr const char* kInDoorSwing = "the base blocks a door";
  static constexpr const char* kCameraConstraint = "camera constraint";
  static constexpr const char* kInvalidScene = "invalid scene";

  // The stages of a StartSampler (start_sampler.h), in order.
  static constexpr const char* kObjectsStage = "objects";
  static constexpr const char* kTaskStage = "task";  // the task's own arrangement and conditions
  static constexpr const char* kBaseStage = "base";
  static constexpr const char* kCamerasStage = "cameras";
  static constexpr const char* kSettlingStage = "settling";

  std::string reason = kInvalidScene;
  std::string detail = {};
  // Places refused earlier in the same call of Sample.
  RefusalCounts redrawn = {};
  std::string object_kind = {};  // kind of the target, if already chosen
  std::string stage = {};        // stage that refused; "" for samplers without stages
  // True if it holds wherever objects and base are: the same start is not drawn again.
  bool holds_everywhere = false;

  // Returns the key for counting: "base: no base pose reaches the object".
  std::string counted_as() const { return stage.empty() ? reason : stage + ": " + reason; }
  // Returns the same refusal with the stage `by`, unless an inner stage has set one.
  Refusal MadeBy(const char* by) && {
    if (stage.empty()) stage = by;
    return std::move(*this);
  }
};

}  // namespace robocell
