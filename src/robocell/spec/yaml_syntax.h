// Explains a text that is not YAML in words about the text instead of the parser's, with the
// probable cause. Included by yaml*.cc and their tests only.
#pragma once

#include <string>
#include <string_view>

namespace YAML {
class ParserException;
struct Mark;
}  // namespace YAML

namespace robocell::internal::yaml {

// "f.yaml:3:1: not valid YAML: the `[` of line 2, column 8 is still open before this: ...".
std::string SyntaxError(std::string_view text, const std::string& source,
                        const YAML::ParserException& error);

// A bracket that is still open at the end of the text, the last one; 0 when there is none.
char UnclosedBracket(std::string_view text);

// As SyntaxError for a text in quotes that begins at `mark`; "" when its end is there, or when no
// quote is at `mark`. (The parser of yaml-cpp 0.7 takes the end of the file for the end of the
// quote.)
std::string UnclosedQuote(std::string_view text, const std::string& source, const YAML::Mark& mark);

// For a second document: what begins it, or what is not part of the first.
std::string SecondDocument(std::string_view text, const std::string& source,
                           const YAML::Mark& mark);

}  // namespace robocell::internal::yaml
