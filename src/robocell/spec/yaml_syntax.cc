#include "robocell/spec/yaml_syntax.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>

#include "robocell/spec/yaml_hints.h"

namespace robocell::internal::yaml {
namespace {

constexpr std::string_view kBlank = " \t\r";

// Lines and columns count from 0, like the parser's.
struct TextPlace {
  int line = 0, column = 0;
};

std::vector<std::string_view> LinesOf(std::string_view text) {
  std::vector<std::string_view> lines;
  while (true) {
    const size_t end = text.find('\n');
    lines.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return lines;
    text.remove_prefix(end + 1);
  }
}

std::string_view Trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
  const size_t last = text.find_last_not_of(kBlank);
  return text.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

int Indent(std::string_view line) {
  return static_cast<int>(std::min(line.find_first_not_of(' '), line.size()));
}

std::string At(const std::string& source, TextPlace place, std::string_view what) {
  return fmt::format("{}:{}:{}: not valid YAML: {}", source, place.line + 1, place.column + 1,
                     what);
}

// --- Brackets ------------------------------------------------------------------------------------

struct OpenBracket {
  char bracket = 0;
  TextPlace at;
};

char ClosingOf(char bracket) { return bracket == '[' ? ']' : '}'; }

// Finds the brackets that are open at a place. Quoted texts, comments and brackets within a text
// outside of brackets do not count.
class BracketScan {
 public:
  BracketScan(const std::vector<std::string_view>& lines, TextPlace end) {
    for (int i = 0; i <= end.line && i < static_cast<int>(lines.size()); ++i) {
      line_ = i;
      Scan(i == end.line ? lines[i].substr(0, std::min<size_t>(end.column, lines[i].size()))
                         : lines[i]);
    }
  }
  const std::vector<OpenBracket>& open() const { return open_; }

 private:
  void Scan(std::string_view line) {
    bool token_may_begin = true, after_blank = true;
    for (size_t i = 0; i < line.size(); ++i) {
      const char c = line[i];
      const bool blank = kBlank.find(c) != std::string_view::npos;
      if (quote_) {
        if (c == '\\' && quote_ == '"') ++i;
        if (c == quote_) quote_ = 0;
      } else if (c == '#' && after_blank) {
        return;
      } else if ((c == '"' || c == '\'') && token_may_begin) {
        quote_ = c;
      } else if ((c == '[' || c == '{') && (token_may_begin || !open_.empty())) {
        open_.push_back({c, {line_, static_cast<int>(i)}});
        token_may_begin = true;
      } else if ((c == ']' || c == '}') && !open_.empty()) {
        open_.pop_back();
      } else if (c == ':' || c == ',' || c == '-' || c == '?') {
        token_may_begin = true;  // when a blank follows
      } else if (!blank) {
        token_may_begin = false;
      }
      after_blank = blank;
    }
  }

  std::vector<OpenBracket> open_;
  char quote_ = 0;
  int line_ = 0;
};

std::string StillOpen(const OpenBracket& open, bool at_end) {
  const char closing = ClosingOf(open.bracket);
  return fmt::format("the `{}` of line {}, column {} is still open {}: {} `{}`{} is missing",
                     open.bracket, open.at.line + 1, open.at.column + 1,
                     at_end ? "at the end of the file" : "before this", at_end ? "its" : "a",
                     closing, at_end ? "" : ", or a comma between its entries,");
}

// --- Fields and lists in lines of their own ------------------------------------------------------

// Returns the previous line with content; -1 if there is none.
int LineAbove(const std::vector<std::string_view>& lines, int line) {
  for (int i = std::min<int>(line, static_cast<int>(lines.size())) - 1; i >= 0; --i) {
    const std::string_view text = Trimmed(lines[i]);
    if (!text.empty() && text.front() != '#') return i;
  }
  return -1;
}

// Returns "has no `: `; write `name: value`" for a line that is not a field; "" for a field.
std::string NoField(std::string_view line) {
  const std::string_view text = Trimmed(line);
  const size_t colon = text.find(':');
  if (colon == std::string_view::npos) return "has no `: `; write `name: value`";
  const bool blank = colon + 1 == text.size() || text[colon + 1] == ' ';
  return blank ? "" : "has no blank after its `:`; write `name: value`";
}

std::string_view LineAt(const std::vector<std::string_view>& lines, TextPlace at) {
  return at.line < static_cast<int>(lines.size()) ? lines[static_cast<size_t>(at.line)] : "";
}

std::string_view Before(std::string_view line, TextPlace at) {
  return line.substr(0, std::min(static_cast<size_t>(at.column), line.size()));
}

// Explains a `: ` where no name can end.
std::string ColonOutOfPlace(const std::vector<std::string_view>& lines, TextPlace at) {
  const std::string_view line = LineAt(lines, at);
  if (Before(line, at).find(": ") != std::string_view::npos)
    return "a second `: ` in one line; a text that holds `: ` must be in quotes, and every field "
           "in a separate line or in {...}";
  const int above = LineAbove(lines, at.line);
  if (above < 0) return "there is no name before this `:`";
  const std::string_view other = lines[static_cast<size_t>(above)];
  if (const std::string why = NoField(other); !why.empty())
    return fmt::format("this line seems to go on with line {}, which {} there", above + 1, why);
  if (Indent(line) > Indent(other))
    return fmt::format(
        "this line is indented further than line {}, which has a value already; "
        "fields of one element begin in the same column",
        above + 1);
  return "this `:` follows no name; a text that holds `: ` must be in quotes";
}

// Explains a line that is not part of what stands above it.
std::string OutOfPlace(const std::vector<std::string_view>& lines, TextPlace at) {
  const std::string_view line = LineAt(lines, at);
  if (!Trimmed(Before(line, at)).empty())
    return "the value before this is complete; a text that begins with a quote, `[` or `{` and "
           "goes on after its end must be in quotes as a whole";
  if (Trimmed(line).starts_with("- "))
    return "a list entry does not fit here: the entries of a list begin in the same column, below "
           "the name of their list";
  if (const std::string why = NoField(line); !why.empty()) return "this line " + why;
  return "the line is indented like nothing above it: fields of one element begin in the same "
         "column, what belongs to a field further to the right";
}

// Returns true if a bracket directly follows a colon: a text to the parser, not a value.
bool IsBehindColon(const std::vector<std::string_view>& lines, TextPlace bracket) {
  const std::string_view line = LineAt(lines, bracket);
  const auto column = static_cast<size_t>(bracket.column);
  return column > 0 && column < line.size() && line[column - 1] == ':' &&
         (line[column] == '[' || line[column] == '{');
}

std::string Brackets(const std::vector<std::string_view>& lines, TextPlace at) {
  const BracketScan scan(lines, at);
  std::vector<TextPlace> brackets = {at};
  for (const OpenBracket& open : scan.open()) brackets.push_back(open.at);
  for (const TextPlace& bracket : brackets) {
    if (!IsBehindColon(lines, bracket)) continue;
    return fmt::format("there is no blank between the `:` and the `{}` of line {}, column {}",
                       LineAt(lines, bracket).substr(static_cast<size_t>(bracket.column), 1),
                       bracket.line + 1, bracket.column + 1);
  }
  const std::string_view line = LineAt(lines, at);
  const bool at_end = LineAbove(lines, static_cast<int>(lines.size())) <= at.line &&
                      Trimmed(line.substr(Before(line, at).size())).empty();
  if (!scan.open().empty()) return StillOpen(scan.open().back(), at_end);
  // In a text without a last line feed the parser's place may be the beginning of the last line.
  const BracketScan whole(lines, {static_cast<int>(lines.size()), 0});
  if (!whole.open().empty()) return StillOpen(whole.open().back(), true);
  return fmt::format(
      "this `{}` closes nothing: what it is to close was not opened, or is closed "
      "already",
      line.substr(Before(line, at).size(), 1));
}

using Explain = std::string (*)(const std::vector<std::string_view>&, TextPlace);

template <char c>
std::string BeginsWithSign(const std::vector<std::string_view>&, TextPlace) {
  return fmt::format("a text that begins with `{}` must be in quotes", c);
}

// Beginnings of the parser's messages, and our explanation of each.
const std::vector<std::pair<std::string_view, Explain>>& Explanations() {
  using Lines = std::vector<std::string_view>;
  static const std::vector<std::pair<std::string_view, Explain>> kExplanations = {
      {"end of map flow", Brackets},
      {"end of sequence flow", Brackets},
      {"illegal flow end", Brackets},
      {"end of map", OutOfPlace},
      {"end of sequence", OutOfPlace},
      {"illegal map value", ColonOutOfPlace},
      {"illegal map key",
       [](const Lines&, TextPlace) -> std::string {
         return "a name cannot stand here; every field stands in a separate line or in {...}";
       }},
      {"illegal block entry",
       [](const Lines&, TextPlace) -> std::string {
         return "a list entry `- ` cannot stand here: entries stand in separate lines, below "
                "the name of their list; or write [a, b]";
       }},
      {"illegal document indicator",
       [](const Lines&, TextPlace) -> std::string {
         return "`---` within quotes: the quote above has no end";
       }},
      {"illegal EOF in scalar",
       [](const Lines&, TextPlace) -> std::string {
         return "the file ends within quotes: the quote above has no end";
       }},
      {"unknown escape character",
       [](const Lines&, TextPlace) -> std::string {
         return "a backslash in double quotes begins a special character; write it twice, or use "
                "single quotes";
       }},
      {"bad character found while scanning hex",
       [](const Lines&, TextPlace) -> std::string {
         return "\\x, \\u and \\U in double quotes want the number of a character; write the "
                "backslash twice, or use single quotes";
       }},
      {"invalid unicode",
       [](const Lines&, TextPlace) -> std::string {
         return "\\u and \\U in double quotes want the number of a character; write the backslash "
                "twice, or use single quotes";
       }},
      {"unexpected character in block scalar",
       [](const Lines&, TextPlace) -> std::string {
         return "after `|` or `>` the line ends, and the text follows in indented lines; a text "
                "that begins with one must be in quotes";
       }},
      {"the referenced anchor",
       [](const Lines&, TextPlace) -> std::string {
         return "`*` refers to a value that is marked with `&` above, and there is none; a text "
                "that begins with `*` must be in quotes";
       }},
      {"alias not found", BeginsWithSign<'*'>},
      {"illegal character found while scanning alias", BeginsWithSign<'*'>},
      {"anchor not found", BeginsWithSign<'&'>},
      {"illegal character found while scanning anchor", BeginsWithSign<'&'>},
      {"cannot assign multiple anchors", BeginsWithSign<'&'>},
      {"end of verbatim tag", BeginsWithSign<'!'>},
      {"tag handle", BeginsWithSign<'!'>},
      {"illegal character found while scanning tag", BeginsWithSign<'!'>},
      {"cannot assign multiple tags", BeginsWithSign<'!'>},
  };
  return kExplanations;
}

std::string Explanation(const std::string& message, const std::vector<std::string_view>& lines,
                        TextPlace at) {
  for (const auto& [beginning, explain] : Explanations()) {
    if (message.starts_with(beginning)) return explain(lines, at);
  }
  const std::string_view line = LineAt(lines, at);
  if (message == "unknown token" && at.column < static_cast<int>(line.size()))
    return fmt::format("a text that begins with `{}` must be in quotes", line[at.column]);
  return "the text cannot be read from here on; are brackets, quotes and indentation right?";
}

}  // namespace

char UnclosedBracket(std::string_view text) {
  const std::vector<std::string_view> lines = LinesOf(text);
  const BracketScan scan(lines, {static_cast<int>(lines.size()), 0});
  return scan.open().empty() ? '\0' : scan.open().back().bracket;
}

std::string SyntaxError(std::string_view text, const std::string& source,
                        const YAML::ParserException& error) {
  const std::vector<std::string_view> lines = LinesOf(text);
  const TextPlace at{std::max(error.mark.line, 0), std::max(error.mark.column, 0)};
  if (const int tabbed = TabbedLine(text, at.line + 1))
    return At(source, {tabbed - 1, 0}, "the line is indented with a tab; use spaces");
  return At(source, at, Explanation(error.msg, lines, at));
}

std::string UnclosedQuote(std::string_view text, const std::string& source,
                          const YAML::Mark& mark) {
  size_t at = 0;
  for (int line = 0; line < mark.line; ++line) {
    at = text.find('\n', at);
    if (at++ == std::string_view::npos) return "";
  }
  at += static_cast<size_t>(mark.column);
  if (at >= text.size() || (text[at] != '"' && text[at] != '\'')) return "";
  const char quote = text[at];
  for (size_t i = at + 1; i < text.size(); ++i) {
    if (text[i] == quote) return "";  // or the first of two, which has another one behind it
    if (text[i] == '\\' && quote == '"') ++i;
  }
  return At(source, {mark.line, mark.column},
            fmt::format("the quote `{}` that begins here has no end", quote));
}

std::string SecondDocument(std::string_view text, const std::string& source,
                           const YAML::Mark& mark) {
  const std::vector<std::string_view> lines = LinesOf(text);
  const bool marked = LineAt(lines, {mark.line, 0}).starts_with("---");
  return fmt::format("{}:{}:{}: {}", source, mark.line + 1, mark.column + 1,
                     marked ? "a second document starts here; a spec file has one"
                            : "this does not belong to what stands above, which is complete: are "
                              "indentation and dashes right? (A spec file has one document)");
}

}  // namespace robocell::internal::yaml
