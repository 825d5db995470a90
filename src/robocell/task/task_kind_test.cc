#include "robocell/task/task_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

TEST(TaskKind, BuiltInKindsExist) {
  for (const char* kind : {"pick", "pick_and_place"})
    EXPECT_NE(FindTaskKind(kind)->Make(TaskSpec(kind)), nullptr) << kind;
  ExpectThrow<NotFoundError>([] { FindTaskKind("pik"); }, "Did you mean 'pick'?");
}

TEST(TaskKind, ItsFieldsAreRegisteredWithIt) {
  const auto pick = FindTaskKind("pick");
  ExpectThrow<ArgumentError>(
      [&] { RegisterTask("pick", std::make_shared<KindFieldsOf<PickTaskConfig>>(), pick); },
      "task 'pick' is registered already");
  ExpectThrow<ArgumentError>(
      [] { RegisterTask("none", std::make_shared<KindFieldsOf<PickTaskConfig>>(), nullptr); },
      "task 'none' needs a TaskKind");
  EXPECT_THAT(TaskKinds(), ::testing::Not(::testing::Contains("none")));
}

}  // namespace
}  // namespace robocell
