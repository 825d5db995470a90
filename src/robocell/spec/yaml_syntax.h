// Explains why a text is not YAML, in words about the text instead of the parser's, with the
// probable cause. Included by yaml*.cc and their tests only.
#pragma once

#include <string>
#include <string_view>

namespace YAML {
class ParserException;
struct Mark;
}  // namespace YAML

namespace robocell::internal::yaml {

// Returns "f.yaml:3:1: not valid YAML: the `[` of line 2, column 8 is still open before this: ...".
std::string SyntaxError(std::string_view text, const std::string& source,
                        const YAML::ParserException& error);

// Returns the last bracket that is still open at the end of the text; 0 if there is none.
char UnclosedBracket(std::string_view text);

// Like SyntaxError for a quoted text that begins at `mark`; "" if it has an end, or if no quote is
// at `mark`. (The parser of yaml-cpp 0.7 takes the end of the file for the end of the quote.)
std::string UnclosedQuote(std::string_view text, const std::string& source, const YAML::Mark& mark);

// Returns the beginning of a second document, or the text that is not part of the first one.
std::string SecondDocument(std::string_view text, const std::string& source,
                           const YAML::Mark& mark);

}  // namespace robocell::internal::yaml
