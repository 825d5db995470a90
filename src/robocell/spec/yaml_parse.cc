// Parses text to a tree, and rejects text before the spec is read.
#include <fmt/format.h>

#include <sstream>
#include <string>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/parser.h>

#include "robocell/spec/spec_file.h"
#include "robocell/spec/yaml_hints.h"
#include "robocell/spec/yaml_reader.h"
#include "robocell/spec/yaml_syntax.h"

namespace robocell::internal::yaml {
namespace {

constexpr int kMostDepth = 64;  // no spec file is deeper

// yaml-cpp's parser recurses, so depth is rejected before it runs. Counts the brackets of flow
// collections, indentation, and the marks of nested block entries.
bool TooDeep(std::string_view text) {
  int depth = 0;
  size_t indent = 0;
  bool line_start = true;
  for (const char c : text) {
    if (c == '\n') {
      line_start = true;
      indent = 0;
    } else if (line_start && (c == ' ' || c == '-' || c == '?' || c == ':')) {
      if (++indent > 4 * kMostDepth) return true;
    } else {
      line_start = false;
      if (c == '[' || c == '{') ++depth;
      if ((c == ']' || c == '}') && depth > 0) --depth;
      if (depth > kMostDepth) return true;
    }
  }
  return false;
}

// Rejects a second document as soon as it starts: some broken texts, such as ", 1", are documents
// without end to yaml-cpp 0.7. Also rejects quotes without an end, which yaml-cpp takes for texts.
class OneDocument : public YAML::EventHandler {
 public:
  OneDocument(std::string_view text, const std::string& source) : text_(text), source_(source) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (documents_++ > 0) throw SpecError(SecondDocument(text_, source_, mark));
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                const std::string&) override {
    if (const std::string error = UnclosedQuote(text_, source_, mark); !error.empty())
      throw SpecError(error);
  }
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}

 private:
  std::string_view text_;
  const std::string& source_;
  int documents_ = 0;
};

void RequireOneDocument(const std::string& text, const std::string& source) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  OneDocument handler(text, source);
  while (parser.HandleNextDocument(handler)) continue;
}

// A shell that splits a list at blanks passes only its beginning.
void RequireWholeValue(const std::string& text, size_t equals) {
  const std::string value = text.substr(equals + 1);
  const char open = UnclosedBracket(value);
  if (open == '\0') return;
  const char close = open == '[' ? ']' : '}';
  throw SpecError(fmt::format(
      "--set {0}: its `{1}` is not closed: `{2}` is missing. An option with blanks stands in "
      "quotes: --set '{3}={1}...{2}'",
      text, open, close, text.substr(0, equals)));
}

}  // namespace

YAML::Node ParseText(std::string_view text, const std::string& source) {
  if (text.size() > kMostSpecBytes) {
    throw SpecError(source + ": is larger than 16 MB, which no spec file is");
  }
  RequireText(text, source);
  if (LooksLikeXml(text)) {
    throw SpecError(source +
                    ": this is XML, a model file; a YAML file is wanted here, for a robot one that "
                    "names the model in its field `model`. How to write one: docs/robots.md");
  }
  if (TooDeep(text)) {
    throw SpecError(fmt::format("{}: is nested more than {} levels deep", source, kMostDepth));
  }
  const std::string document(text);
  try {
    RequireOneDocument(document, source);
    return YAML::Load(document);
  } catch (const YAML::ParserException& e) {
    throw SpecError(SyntaxError(document, source, e));
  } catch (const YAML::Exception& e) {
    throw SpecError(source + ": not valid YAML: " + e.what());
  }
}

Override ParseOverride(const std::string& text) {
  const size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw ArgumentError("--set " + text +
                        ": write it as path.to.field=value, for example task.lift_height=0.05");
  }
  RequireWholeValue(text, equals);
  return {text.substr(0, equals), text,
          ParseText(std::string_view(text).substr(equals + 1), "--set " + text)};
}

}  // namespace robocell::internal::yaml
