// Refusal: why a start could not be made. A value: refusals are counted and reported, they are no
// errors.
#pragma once

#include <map>
#include <string>

namespace robocell {

// Reasons are few and counted, details are for reading.
struct Refusal {
  enum Reason {
    kNoFreePlace,
    kUnsettled,
    kNoReachableBasePose,
    kBaseInCollision,
    kNoGrasp,
    kGraspsInCollision,
    kCameraConstraint,
    kInvalidScene
  };
  Reason reason = kInvalidScene;
  std::string detail = {};
  // Places that were tried and refused before, in the same call of Sample.
  std::map<Reason, int> redrawn = {};
  std::string object_kind = {};  // the target's, when it was chosen already
};
using RefusalCounts = std::map<Refusal::Reason, int>;
// As reports have it: "no grasp".
const char* ToString(Refusal::Reason reason);

}  // namespace robocell
