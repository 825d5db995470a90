#include "robocell/spec/task_space.h"

#include <algorithm>

#include "robocell/spec/problems.h"

namespace robocell {
namespace {

bool AreAllZero(const Vec3& v) {
  return std::ranges::all_of(v, [](double x) { return x == 0; });
}

}  // namespace

void TaskSpaceConfig::Validate(Problems& problems) const {
  if (kind != TaskSpaceKind::kAxis && (axis || cone)) {
    problems.AddAt(axis ? "axis" : "cone",
                   "belongs to `kind: axis`; write that kind, or leave it out");
  }
  if (axis && AreAllZero(*axis))
    problems.AddAt("axis", "has no direction; write for example [0, 0, 1]");
  if (kind != TaskSpaceKind::kPose && rotation_weights) {
    problems.AddAt("rotation_weights",
                   "belongs to `kind: pose`; the other kinds say themselves which rotations count");
  }
  if (position_weights && AreAllZero(*position_weights)) {
    problems.AddAt("position_weights",
                   "are all 0, so that no position counts; give at least one above 0");
  }
}

}  // namespace robocell
