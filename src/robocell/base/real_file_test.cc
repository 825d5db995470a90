#include "robocell/base/real_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/hash.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class RealFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    AtomicWrite(temp / "file", "abc");
    fs::create_symlink(temp / "file", temp / "link");
    fs::create_directory_symlink(temp.path(), temp / "folder_link");
    fs::create_symlink("/dev/zero", temp / "endless");
    ASSERT_EQ(::mkfifo((temp / "pipe").c_str(), 0600), 0);
    fs::create_directory(temp / "folder");
  }
  TempDir temp;
};

TEST_F(RealFileTest, ReplacingAFileChangesItsIdentity) {
  const std::string before = FileIdentity(temp / "file");
  EXPECT_EQ(FileIdentity(temp / "file"), before);
  AtomicWrite(temp / "file", "abd");
  EXPECT_NE(FileIdentity(temp / "file"), before);
  EXPECT_EQ(FileIdentity(temp / "none"), (temp / "none").string());
}

TEST_F(RealFileTest, AFileIsReadAndHashedLikeAnyOther) {
  EXPECT_EQ(ReadRealFile(temp / "file"), "abc");
  EXPECT_EQ(Sha256RealFile(temp / "file"), Sha256File(temp / "file"));
  const std::string large(200'000, 'x');
  AtomicWrite(temp / "large", large);
  EXPECT_EQ(ReadRealFile(temp / "large"), large);
  EXPECT_EQ(Sha256RealFile(temp / "large"), Sha256(large));
}

TEST_F(RealFileTest, RejectsPathsThatAreNotFiles) {
  fs::create_symlink(temp / "none", temp / "dangling");
  for (const auto& [name, what] : std::map<std::string, std::string>{
           {"endless", "a link to '/dev/zero'"},
           {"dangling", "a link to '" + (temp / "none").string() + "', where there is nothing"},
           {"folder_link", "a link to '" + temp.path().string() + "'"},
           {"pipe", "a pipe"},
           {"folder", "a folder"}}) {
    const std::filesystem::path path = temp / name;
    EXPECT_EQ(WhatIsAt(path), what);
    const std::string text = "cannot read '" + path.string() + "': it is " + what +
                             ", not a file. Remove it, or put the file itself there";
    ExpectThrow<IoError>([&] { ReadRealFile(path); }, text);
    ExpectThrow<IoError>([&] { Sha256RealFile(path); }, text);
    ExpectThrow<IoError>([&] { RequireReadable(path); }, text);
    EXPECT_FALSE(CanReadFile(path));
  }
}

TEST_F(RealFileTest, RejectsANulByteInAPath) {
  const fs::path cut = (temp / "file").native() + '\0' + "x";
  ExpectThrow<ArgumentError>([&] { ReadRealFile(cut); }, "file\\0x' contains a NUL byte");
  ExpectThrow<ArgumentError>([&] { AtomicWrite(cut, "other"); }, "contains a NUL byte");
  EXPECT_EQ(ReadFile(temp / "file"), "abc");
}

TEST_F(RealFileTest, FollowsALinkToAFile) {
  fs::create_symlink(temp / "link", temp / "link_to_link");
  for (const char* name : {"link", "link_to_link"}) {
    EXPECT_EQ(WhatIsAt(temp / name).substr(0, 9), "a link to");
    EXPECT_EQ(ReadRealFile(temp / name), "abc");
    EXPECT_EQ(Sha256RealFile(temp / name), Sha256File(temp / "file"));
    EXPECT_EQ(RequireReadable(temp / name), temp / name);
  }
}

TEST_F(RealFileTest, WritingFollowsNoLink) {
  for (const char* name : {"link", "pipe", "folder"}) {
    EXPECT_THROW(RealFile(temp / name, O_WRONLY | O_CREAT | O_TRUNC, "write"), IoError) << name;
  }
  EXPECT_EQ(ReadFile(temp / "file"), "abc");
}

TEST_F(RealFileTest, AMissingFileErrorHasTheReasonOfTheSystem) {
  EXPECT_EQ(WhatIsAt(temp / "none"), "nothing");
  ExpectThrow<IoError>([&] { ReadRealFile(temp / "none"); }, "none': No such file or directory");
}

TEST_F(RealFileTest, MoreThanTheLimitIsNotRead) {
  fs::resize_file(temp / "file", uint64_t{1} << 40);  // needs no space
  ExpectThrow<IoError>([&] { ReadRealFile(temp / "file"); },
                       "it has 1099511627776 bytes, 67108864 are the most that is read");
}

TEST_F(RealFileTest, FoldersAreFoldersOrMissing) {
  RequireRealFolder(temp / "folder");
  RequireRealFolder(temp / "none");
  const std::string text =
      ExpectThrow<IoError>([&] { RequireRealFolder(temp / "folder_link"); },
                           "it is a link to '" + temp.path().string() + "', not a folder");
  EXPECT_THAT(text, HasSubstr("Remove it, or put the folder itself there"));
  EXPECT_THROW(RequireRealFolder(temp / "file"), IoError);
}

}  // namespace
}  // namespace robocell::internal
