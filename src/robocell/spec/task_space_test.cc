// Tests which fields of a task space belong together.
#include "robocell/spec/task_space.h"

#include <gtest/gtest.h>

#include <string>

#include "robocell/base/error.h"
#include "robocell/spec/validate.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

TEST(TaskSpaceConfig, RejectsFieldsOfOtherKinds) {
  const auto refuses = [](const TaskSpaceConfig& config, const std::string& text) {
    ExpectThrow<SpecError>([&] { RequireValid(config, "task space"); }, text);
  };
  refuses({.kind = TaskSpaceKind::kPosition, .axis = Vec3{0, 0, 1}}, "belongs to `kind: axis`");
  refuses({.kind = TaskSpaceKind::kAxis, .axis = Vec3{0, 0, 0}}, "has no direction");
  refuses({.kind = TaskSpaceKind::kAxis, .cone = -1}, "cone");
  refuses({.kind = TaskSpaceKind::kAxis, .rotation_weights = Vec3{1, 1, 1}},
          "belongs to `kind: pose`");
  refuses({.position_weights = Vec3{0, 0, 0}}, "no position counts");
}

}  // namespace
}  // namespace robocell
