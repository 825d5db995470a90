// Tests the messages about a text that is not YAML. The parser's own words must not appear.
#include "robocell/spec/yaml_syntax.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "robocell/spec/robot_config.h"
#include "robocell/spec/testing/messages.h"

namespace robocell::internal {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::ParseError;
using ::testing::StartsWith;

struct BrokenText {
  const char* text;
  const char* error;  // the beginning of its message, without the file
};

const std::vector<BrokenText>& BrokenTexts() {
  static const std::vector<BrokenText> kTexts = {
      // Brackets
      {"name: a\nmodel: [b\n",
       "3:1: not valid YAML: the `[` of line 2, column 8 is still open at the end of the file: its "
       "`]` is missing"},
      {"name: a\nbase: {kind: mocap\n",
       "3:1: not valid YAML: the `{` of line 2, column 7 is still open at the end of the file"},
      {"name: a\nhome: [0, 1",
       "2:1: not valid YAML: the `[` of line 2, column 7 is still open at the end of the file"},
      {"name: a\nhome: [0, 1\nmodel: b\n",
       "3:6: not valid YAML: the `[` of line 2, column 7 is still open before this: a `]`, or a "
       "comma between its entries, is missing"},
      {"name: a\nhome: {arm: [0, 1, 2}\nmodel: b\n",
       "2:21: not valid YAML: the `[` of line 2, column 13 is still open before this: a `]`, or"},
      {"name: a\nbase: {kind: mocap size: [1, 2, 3]}\n",
       "2:24: not valid YAML: the `{` of line 2, column 7 is still open before this: a `}`, or"},
      {"name: it's [a # ] {\nmodel: 'b]{'\nhome: {\"]\": [1\n",
       "4:1: not valid YAML: the `[` of line 3, column 13 is still open"},
      {"name: a\nhome: [0, 1]]\n", "2:13: not valid YAML: this `]` closes nothing"},
      {"name: [left] arm\n", "1:14: not valid YAML: the value before this is complete"},
      // Quotes
      {"name: \"a\nmodel: b\n", "1:7: not valid YAML: the quote `\"` that begins here has no end"},
      {"name: a\nmodel: 'b\n", "2:8: not valid YAML: the quote `'` that begins here has no end"},
      {"name: 'a' b\n", "1:11: not valid YAML: the value before this is complete; a text that"},
      {"name: 'a\n---\nb'\n", "2:1: not valid YAML: `---` within quotes: the quote above has no"},
      {"name: \"C:\\dir\"\n",
       "1:12: not valid YAML: a backslash in double quotes begins a special"},
      {"name: \"\\xzz\"\n", "1:12: not valid YAML: \\x, \\u and \\U in double quotes want the"},
      // Indentation
      {"base:\n    kind: mocap\n  size: [1, 2, 3]\n",
       "3:3: not valid YAML: the line is indented like nothing above it: fields of one element "
       "begin "
       "in the same column"},
      {"base:\n  kind: mocap\n    size: [1, 2, 3]\n",
       "3:9: not valid YAML: this line is indented further than line 2, which has a value already"},
      {"name: a\n- b\n", "2:1: not valid YAML: a list entry does not fit here"},
      {"edits:\n  - body: a\n - body: b\n", "3:2: not valid YAML: a list entry does not fit here"},
      {"edits:\n  - body: a\n  pos: [0, 0, 0]\n", "3:3: not valid YAML: the line is indented like"},
      {"base:\n  kind: mocap\n\tsize: [1, 2]\n",
       "3:1: not valid YAML: the line is indented with a tab; use spaces"},
      // Colons and dashes
      {"name: a\nmodel b\nbase: c\n",
       "3:5: not valid YAML: this line seems to go on with line 2, which has no `: `; write `name: "
       "value` there"},
      {"name: a\n\nmodel:b\n# c\nbase: c\n",
       "3:1: not valid YAML: this line has no blank after its `:`; write `name: value`"},
      {"name:a\nmodel: b\n",
       "2:6: not valid YAML: this line seems to go on with line 1, which has no blank after its"},
      {"root_body: menagerie: panda\n",
       "1:21: not valid YAML: a second `: ` in one line; a text that holds `: ` must be in quotes"},
      {"name: - a\n", "1:7: not valid YAML: a list entry `- ` cannot stand here"},
      {"- a\nname: b\n", "2:1: this does not belong to what stands above, which is complete"},
      {"name: a\n---\nname: b\n", "2:1: a second document starts here; a spec file has one"},
      // Signs
      {"name: @a\n", "1:7: not valid YAML: a text that begins with `@` must be in quotes"},
      {"name: %a\n", "1:7: not valid YAML: a text that begins with `%` must be in quotes"},
      {"name: & b\n", "1:8: not valid YAML: a text that begins with `&` must be in quotes"},
      {"name: * b\n", "1:8: not valid YAML: a text that begins with `*` must be in quotes"},
      {"name: *b\n", "1:7: not valid YAML: `*` refers to a value that is marked with `&` above"},
      {"name: !<a\n", "1:10: not valid YAML: a text that begins with `!` must be in quotes"},
      {"name: |x\n  a\n", "1:8: not valid YAML: after `|` or `>` the line ends"},
  };
  return kTexts;
}

TEST(YamlSyntax, ReportsProblemAndPlace) {
  for (const BrokenText& broken : BrokenTexts()) {
    EXPECT_THAT(ParseError<RobotConfig>(broken.text),
                StartsWith(std::string("f.yaml:") + broken.error))
        << broken.text;
  }
}

// Tries every prefix of a file, and every file without one of its characters.
TEST(YamlSyntax, HidesMessagesOfTheParser) {
  const std::string text =
      "name: 'it''s'\nmodel: \"a\\\"b\"\nhome: {arm: [0, 1], b: {c: [d]}}\nedits:\n  - body: a\n"
      "    pos: [0, 0, 0]\n  - {geom: {body: b, index: 3}}\n# c: 'd\nname2: |\n  'tis \"so\n";
  std::vector<std::string> texts;
  for (size_t i = 0; i < text.size(); ++i) {
    texts.push_back(text.substr(0, i));
    texts.push_back(text.substr(0, i) + text.substr(i + 1));
    texts.push_back(text.substr(0, i) + " " + text.substr(i));
  }
  for (const std::string& broken : texts) {
    EXPECT_THAT(ParseError<RobotConfig>(broken),
                Not(AnyOf(HasSubstr("illegal"), HasSubstr("not found"), HasSubstr("yaml-cpp"))))
        << broken;
  }
}

TEST(YamlSyntax, AcceptsClosedQuotes) {
  for (const char* name : {"'a'", "\"a\"", "'it''s'", "\"a \\\" b\"", "'a\n  b'", "it's", "a 'b",
                           "|\n  'a", "'\\'", "\"\\\\\""}) {
    EXPECT_THAT(ParseError<RobotConfig>(fmt::format("model: b\nname: {}\n", name)),
                Not(HasSubstr("not valid YAML")))
        << name;
  }
}

}  // namespace
}  // namespace robocell::internal
