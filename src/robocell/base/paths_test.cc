#include "robocell/base/paths.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

// temp/root is the root, temp/outside is not in it.
class ConfinedPathTest : public ::testing::Test {
 protected:
  ConfinedPathTest() {
    fs::create_directories(root() / "assets");
    fs::create_directory(outside());
  }
  fs::path root() const { return temp_.path() / "root"; }
  fs::path outside() const { return temp_.path() / "outside"; }
  void ExpectRefused(std::string_view relative, const std::string& reason) {
    const std::string message =
        ExpectThrow<ArgumentError>([&] { ConfinedPath(root(), relative); }, reason);
    EXPECT_NE(message.find("inside '" + root().native() + "'"), std::string::npos) << message;
  }

 private:
  TempDir temp_;
};

TEST_F(ConfinedPathTest, PathsInsideAreJoined) {
  EXPECT_EQ(ConfinedPath(root(), "assets/link.stl"), root() / "assets/link.stl");
  EXPECT_EQ(ConfinedPath(root(), "./assets//x"), root() / "assets/x");
  EXPECT_EQ(ConfinedPath("models", "arm/arm.xml"), "models/arm/arm.xml");
  EXPECT_EQ(ConfinedPath("/not/there", "x"), "/not/there/x");
}

TEST_F(ConfinedPathTest, AcceptsUnusualNames) {
  for (const std::string name : {"with space", "'\"", "$(touch x)", "`x`", "..x", "x..", "...",
                                 "\u00e4\u6f22\U0001F916", "-rf", "a\\..\\b", "%2e%2e", "a\nb"}) {
    EXPECT_EQ(ConfinedPath(root(), name), root() / name);
  }
}

TEST_F(ConfinedPathTest, RejectsPathsThatLeaveTheRoot) {
  ExpectRefused("../outside/x",
                "path '../outside/x' contains '..'; it must lead to a place inside");
  ExpectRefused("assets/../../outside", "contains '..'");
  ExpectRefused("assets/..", "contains '..'");
  ExpectRefused("..", "contains '..'");
  ExpectRefused("/etc/passwd", "path '/etc/passwd' is absolute");
  ExpectRefused("", "path '' is empty");
  ExpectRefused(std::string_view("a\0b", 3), "path 'a\\0b' contains a NUL byte");
  std::string deep;
  while (deep.size() < 4096) deep += "a/";
  ExpectRefused(deep, "path '...' has 4096 bytes, more than the 4095 of a path; it must lead to");
}

TEST(RequireNoNul, RejectsTextWithANulByte) {
  RequireNoNul("model", "a b/\u00fc.xml");
  ExpectThrow<ArgumentError>([] { RequireNoNul("model", std::string_view("a\0b", 3)); },
                             "model 'a\\0b' contains a NUL byte, where the system would end it");
}

TEST_F(ConfinedPathTest, RejectsLinksThatLeaveTheRoot) {
  fs::create_symlink(outside(), root() / "absolute");
  fs::create_symlink("../outside", root() / "relative");
  fs::create_symlink("absolute/deeper", root() / "twice");
  fs::create_symlink("/not/there/at/all", root() / "dangling");
  const std::string to = "leads to '" + fs::canonical(outside()).native();
  ExpectRefused("absolute", to + "' through a symbolic link");
  ExpectRefused("absolute/x", to + "/x' through");
  ExpectRefused("relative/x", to + "/x' through");
  ExpectRefused("twice", to + "/deeper' through");
  ExpectRefused("dangling", "leads to '/not/there/at/all' through a symbolic link");
}

TEST_F(ConfinedPathTest, FollowsLinksInsideTheRoot) {
  fs::create_symlink("assets", root() / "link");
  fs::create_symlink("../root/assets", root() / "around");
  fs::create_symlink(root() / "assets", root() / "absolute");
  fs::create_symlink(root(), outside() / "root_by_another_name");
  EXPECT_EQ(ConfinedPath(root(), "link/x"), root() / "link/x");
  EXPECT_EQ(ConfinedPath(root(), "around/x"), root() / "around/x");
  EXPECT_EQ(ConfinedPath(root(), "absolute/x"), root() / "absolute/x");
  const fs::path other = outside() / "root_by_another_name";
  EXPECT_EQ(ConfinedPath(other, "absolute/x"), other / "absolute/x");
}

TEST_F(ConfinedPathTest, RejectsLinkCycles) {
  fs::create_symlink("b", root() / "a");
  fs::create_symlink("a", root() / "b");
  ExpectRefused("a/x", "goes through too many symbolic links");
}

TEST_F(ConfinedPathTest, AFolderWithThePrefixOfTheRootIsOutside) {
  fs::create_directory(root().native() + "_2");
  fs::create_symlink("../root_2", root() / "sibling");
  ExpectRefused("sibling/x", "root_2/x' through a symbolic link");
}

TEST(FileName, AcceptsValidNames) {
  for (const std::string name : {"a", "wrist camera", "\u00e4", ".hidden", "..x", "$(x)", "-n"}) {
    EXPECT_TRUE(ValidFileName(name)) << name;
  }
  EXPECT_TRUE(ValidFileName(std::string(255, 'x')));
}

TEST(FileName, RejectsInvalidNamesWithTheReason) {
  const auto refuse = [](std::string_view name) {
    EXPECT_FALSE(ValidFileName(name));
    RequireFileName("camera", name);
  };
  ExpectThrow<ArgumentError>([&] { refuse(""); }, "camera name '' is empty, but it becomes a file");
  ExpectThrow<ArgumentError>([&] { refuse(".."); }, "camera name '..' means a folder");
  ExpectThrow<ArgumentError>([&] { refuse("."); }, "means a folder");
  ExpectThrow<ArgumentError>([&] { refuse("a/b"); }, "camera name 'a/b' contains '/'");
  ExpectThrow<ArgumentError>([&] { refuse("a\nb"); }, "contains a control character");
  ExpectThrow<ArgumentError>([&] { refuse({"a\0b", 3}); }, "contains a control character");
  ExpectThrow<ArgumentError>([&] { refuse(std::string(256, 'x')); }, "is longer than 255 bytes");
}

}  // namespace

namespace {

TEST(ShellWord, LeavesPlainWordsUnquoted) {
  EXPECT_EQ(ShellWord("out/pick_v1-2.0"), "out/pick_v1-2.0");
  EXPECT_EQ(ShellWord(""), "''");
  EXPECT_EQ(ShellWord("two words"), "'two words'");
}

// The shell is the oracle.
TEST(ShellWord, TheShellReadsTheOriginalText) {
  for (const std::string text :
       {"a b", "it's", "$(date)", "\"x\"", "`x`", "a\\b", "\xce\xa9", "*"}) {
    FILE* shell = popen(("printf %s " + ShellWord(text)).c_str(), "r");
    ASSERT_NE(shell, nullptr);
    std::string read;
    for (int c = 0; (c = fgetc(shell)) != EOF;) read += static_cast<char>(c);
    EXPECT_EQ(pclose(shell), 0);
    EXPECT_EQ(read, text);
  }
}

}  // namespace
}  // namespace robocell::internal
