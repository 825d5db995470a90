#include "robocell/base/mapped_file.h"

#include <gtest/gtest.h>

#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

TEST(MappedFile, ShowsTheBytesOfAFileOfAnySize) {
  const TempDir temp;
  for (const size_t size : {0, 1, 4096, 1000000}) {
    std::string bytes(size, 'a');
    if (size) bytes.back() = 'z';
    AtomicWrite(temp / "file", bytes);
    EXPECT_EQ(MappedFile(temp / "file").bytes(), bytes);
  }
}

TEST(MappedFile, KeepsWhatItShowsWhenTheFileIsReplacedOrMoved) {
  const TempDir temp;
  AtomicWrite(temp / "file", "before");
  MappedFile first(temp / "file");
  AtomicWrite(temp / "file", "after");
  const MappedFile moved(std::move(first));
  std::filesystem::remove(temp / "file");
  EXPECT_EQ(moved.bytes(), "before");
}

TEST(MappedFile, NamesWhatCannotBeRead) {
  const TempDir temp;
  ExpectThrow<IoError>([&] { MappedFile(temp / "gone"); }, "gone': No such file or directory");
  ExpectThrow<IoError>([&] { MappedFile{temp.path()}; }, "cannot read");
}

}  // namespace
}  // namespace robocell
