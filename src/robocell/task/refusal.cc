#include "robocell/task/refusal.h"

namespace robocell {

const char* ToString(Refusal::Reason reason) {
  switch (reason) {
    case Refusal::kNoFreePlace:
      return "no free place for the objects";
    case Refusal::kUnsettled:
      return "objects did not come to rest";
    case Refusal::kNoReachableBasePose:
      return "no base pose reaches the object";
    case Refusal::kBaseInCollision:
      return "no base pose is free of collisions";
    case Refusal::kNoGrasp:
      return "no grasp";
    case Refusal::kGraspsInCollision:
      return "something is in the way of every grasp";
    case Refusal::kCameraConstraint:
      return "camera constraint";
    case Refusal::kInvalidScene:
      return "invalid scene";
  }
  return "?";
}

}  // namespace robocell
