#include "robocell/base/fingerprint.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

// What `xxhsum -H2` prints.
TEST(Fingerprint, IsTheOneThatOthersCompute) {
  EXPECT_EQ(Fingerprint(""), "99aa06d3014798d86001c324468d497f");
  EXPECT_EQ(Fingerprint("abc"), "06b05ab6733a618578af5f94892f3950");
}

TEST(Fingerprint, OfAFileIsThatOfItsBytesHoweverManyBlocksItHas) {
  const TempDir temp;
  for (const size_t size : {0, 1, 262144, 262145, 3000000}) {
    std::string bytes(size, 'a');
    for (size_t i = 0; i < size; i += 7) bytes[i] = static_cast<char>(i);
    AtomicWrite(temp / "file", bytes);
    EXPECT_EQ(FingerprintFile(temp / "file"), Fingerprint(bytes)) << size;
  }
}

TEST(Fingerprint, OfWhatCannotBeReadNamesIt) {
  const TempDir temp;
  ExpectThrow<IoError>([&] { FingerprintFile(temp / "gone"); }, "gone': No such file or directory");
  ExpectThrow<IoError>([&] { FingerprintFile(temp.path()); }, "Is a directory");
}

}  // namespace
}  // namespace robocell
