#include "robocell/base/shell_word.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

namespace robocell {
namespace {

TEST(ShellWord, PlainOnesStayAsTheyAre) {
  EXPECT_EQ(ShellWord("out/pick_v1-2.0"), "out/pick_v1-2.0");
  EXPECT_EQ(ShellWord(""), "''");
  EXPECT_EQ(ShellWord("two words"), "'two words'");
}

// The shell is the oracle.
TEST(ShellWord, TheShellReadsWhatWasMeant) {
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
}  // namespace robocell
