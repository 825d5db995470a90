#include "robocell/base/folder_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(FolderNames, AreSortedAndWithoutTheFolder) {
  const TempDir folder;
  for (const char* name : {"b", "a", ".hidden"}) AtomicWrite(folder / name, "");
  EXPECT_THAT(FolderNames(folder.path()), ElementsAre(".hidden", "a", "b"));
  EXPECT_EQ(FolderNamesIfAny(folder.path()), FolderNames(folder.path()));
}

TEST(FolderNames, OfWhatCannotBeListedAreNoneOrAnErrorOfOurs) {
  const TempDir folder;
  AtomicWrite(folder / "file", "");
  for (const char* name : {"missing", "file"}) {
    EXPECT_THAT(FolderNamesIfAny(folder / name), IsEmpty());
    ExpectThrow<IoError>([&] { FolderNames(folder / name); }, "cannot list");
  }
}

}  // namespace
}  // namespace robocell
