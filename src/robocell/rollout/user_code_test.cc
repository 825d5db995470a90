#include "robocell/rollout/user_code.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/files.h"
#include "robocell/base/hash.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(UserCode, ListsEachFileOnceInItsOrder) {
  UserCode code;
  code.Add({"/b.py", "/a.py"});
  code.Add({"/a.py", "/c.py"});
  EXPECT_THAT(code.files(), ElementsAre("/b.py", "/a.py", "/c.py"));
}

TEST(UserCode, IsIdentifiedByItsContent) {
  TempDir folder;
  AtomicWrite(folder / "task.py", "a = 1\n");
  AtomicWrite(folder / "moved.py", "a = 1\n");
  AtomicWrite(folder / "other.py", "a = 2\n");
  UserCode code;
  for (const char* file : {"task.py", "moved.py", "other.py"}) code.Add({(folder / file).string()});
  EXPECT_THAT(code.Unknown({Sha256("a = 1\n")}), ElementsAre((folder / "other.py").string()));
  EXPECT_THAT(code.Unknown({Sha256("a = 1\n"), Sha256("a = 2\n")}), IsEmpty());
}

TEST(UserCode, IsEmptyForBuiltInTasks) {
  EnvConfig config;
  EXPECT_THAT(CodeOf(config).files(), IsEmpty());
  config.task = PickTaskConfig{};
  EXPECT_THAT(CodeOf(config).files(), IsEmpty());
}

}  // namespace
}  // namespace robocell::internal
