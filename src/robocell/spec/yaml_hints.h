// Guesses what the writer of a YAML file meant when a value has the wrong form or the file is of
// another kind. Included by yaml*.cc and their tests only.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace YAML {
class Node;
}

namespace robocell::internal::yaml {

// Returns the noun with its article: "a robot file", "an environment file".
std::string WithArticle(std::string_view noun);

// Formats the node as it could stand in a line of YAML, shortened: "[0, 0, 0.1]".
std::string Short(const YAML::Node& node);

// Returns "; write [0, 0, 0.1]" for numbers given as one text ("0 0 0.1") or with names ({x: 0, y:
// 0, z: 0.1}) where a list of `count` is expected; else "".
std::string ListHint(const YAML::Node& node, size_t count);

// Explains how to write an entry of a list, for names with values in its place.
std::string DashHint(const YAML::Node& node);

// The form of the values of a map.
enum class EntryForm { kScalar, kList, kOther };
// Explains how to write names with values, for a list or a single value in their place.
std::string NamesHint(const YAML::Node& node, EntryForm form);

// Returns "; write [0, 0, 0.1]" for several numbers in one text ("0 0 0.1"); else "".
std::string NumbersHint(const YAML::Node& node);

// Returns "; write `x` alone" for a text that was written as an entry, {kind: x}, or as a list of
// one; else "".
std::string TextHint(const YAML::Node& node);

// Returns "; write it without the quotes" for a text that is a list but for its quotes; else "".
std::string QuotedListHint(const YAML::Node& node);

// Returns "there is no blank after ..." for a text like `joints:[a, b]` that begins with one of the
// fields and a colon; else "".
std::string NoBlankHint(const std::string& text, const std::vector<std::string>& fields);

// Returns the first line, from 1, up to line `last` that is indented with a tab; 0 if there is
// none.
int TabbedLine(std::string_view text, int last);

// Returns true if a text is a model file (XML) rather than YAML.
bool LooksLikeXml(std::string_view text);

// A kind of file: its name, its type, its use.
struct FileKind {
  std::string type;  // "RobotConfig"
  std::string what;  // "robot file"
  std::string use;   // "Look at it with `robocell check FILE`"
  std::string page;  // "docs/robots.md"
  std::vector<std::string> fields;
};

// Returns the kind of file of a `type`; one named after the type if it is none of the main kinds.
FileKind FileKindOf(const std::string& type);

// Returns the actual kind of the file and how to use it if the document's fields belong to another
// kind of file than that of `type`; else "".
std::string OtherKindOfFile(const YAML::Node& root, const std::string& type,
                            const std::vector<std::string>& fields, const std::string& source);

// Returns true if a text's fields, those at the beginning of its lines, belong to another kind of
// file than that of `type`.
bool IsOtherKindOfText(std::string_view text, const std::string& type);

}  // namespace robocell::internal::yaml
