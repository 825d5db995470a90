// Text to tree, and what is refused before the spec is looked at.
#include <fmt/format.h>

#include "robocell/spec/spec_file.h"
#include "robocell/spec/yaml_reader.h"

namespace robocell::yaml {
namespace {

constexpr size_t kMostBytes = 1 << 24;  // no spec file is bigger
constexpr int kMostDepth = 64;          // or deeper

// yaml-cpp's parser recurses: refuse depth before it runs. Counts the brackets of flow collections;
// indentation; and the marks of nested block entries.
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

}  // namespace

YAML::Node ParseText(std::string_view text, const std::string& source) {
  if (text.size() > kMostBytes) {
    throw SpecError(source + ": is larger than 16 MB, which no spec file is");
  }
  RequireText(text, source);
  if (TooDeep(text)) {
    throw SpecError(fmt::format("{}: is nested more than {} levels deep", source, kMostDepth));
  }
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(std::string(text));
    if (documents.size() > 1) {
      const YAML::Mark mark = documents[1].Mark();
      throw SpecError(fmt::format("{}:{}:{}: a second document starts here; a spec file has one",
                                  source, mark.line + 1, mark.column + 1));
    }
    return documents.empty() ? YAML::Node(YAML::NodeType::Null) : documents.front();
  } catch (const YAML::ParserException& e) {
    throw SpecError(fmt::format("{}:{}:{}: not valid YAML: {}", source, e.mark.line + 1,
                                e.mark.column + 1, e.msg));
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
  return {text.substr(0, equals), text,
          ParseText(std::string_view(text).substr(equals + 1), "--set " + text)};
}

}  // namespace robocell::yaml
