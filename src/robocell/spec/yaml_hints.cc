#include "robocell/spec/yaml_hints.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "robocell/base/suggestions.h"
#include "robocell/spec/env_config.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/scene_spec.h"

namespace robocell::internal::yaml {
namespace {

constexpr size_t kShown = 60;  // longest piece of a file quoted in a hint

std::string Cut(const std::string& text) {
  return text.size() > kShown ? text.substr(0, kShown) + "..." : text;
}

std::string Joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

// Collects the scalars in a list, or the values of names.
std::vector<std::string> Scalars(const YAML::Node& node) {
  std::vector<std::string> out;
  for (const auto& entry : node) {
    const YAML::Node& value = node.IsMap() ? entry.second : entry;
    out.push_back(value.IsScalar() ? value.Scalar() : "...");
  }
  return out;
}

std::vector<std::string> Words(std::string text) {
  std::replace(text.begin(), text.end(), ',', ' ');
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

const std::vector<FileKind>& FileKinds() {
  static const std::vector<FileKind> kKinds = {
      {RobotConfig::kTypeName, "robot file", "Look at the robot with `robocell check FILE`",
       "docs/robots.md", FieldNames<RobotConfig>()},
      {RunConfig::kTypeName, "run file", "Make its dataset with `robocell generate FILE`",
       "docs/generate.md", FieldNames<RunConfig>()},
      {SceneSpec::kTypeName, "scene file", "Build it with Scene.build(SceneSpec.load(FILE))",
       "docs/scenes.md", FieldNames<SceneSpec>()},
      {EnvConfig::kTypeName, "environment file", "Load it with EnvConfig.load(FILE)",
       "docs/environments.md", FieldNames<EnvConfig>()},
  };
  return kKinds;
}

std::vector<std::string> Shared(const std::vector<std::string>& keys,
                                const std::vector<std::string>& fields) {
  std::vector<std::string> out;
  for (const std::string& key : keys) {
    if (std::find(fields.begin(), fields.end(), key) != fields.end()) out.push_back(key);
  }
  return out;
}

// Returns the kinds of files that have more of the keys than `type`, whose fields are given, and
// most of all: several if they share these keys. One of several keys proves nothing, nor does a key
// that most kinds have, such as the name.
std::vector<FileKind> OtherKinds(const std::vector<std::string>& keys, const std::string& type,
                                 const std::vector<std::string>& fields) {
  std::vector<FileKind> best;
  size_t most = Shared(keys, fields).size();
  for (const FileKind& kind : FileKinds()) {
    const size_t count = Shared(keys, kind.fields).size();
    if (kind.type == type || count < most || (best.empty() && count == most)) continue;
    if (count == 1 && keys.size() > 1) continue;
    if (count > most) best.clear();
    best.push_back(kind);
    most = count;
  }
  if (most == 1 && 2 * best.size() > FileKinds().size()) best.clear();
  return best;
}

}  // namespace

std::string WithArticle(std::string_view noun) {
  const bool vowel = std::string_view("AEIOUaeiou").find(noun.front()) != std::string_view::npos;
  return (vowel ? "an " : "a ") + std::string(noun);
}

std::string Short(const YAML::Node& node) {
  if (node.IsScalar()) return Cut(node.Scalar());
  if (node.IsSequence()) return Cut("[" + Joined(Scalars(node)) + "]");
  return "...";
}

std::string ListHint(const YAML::Node& node, size_t count) {
  if (const std::string quoted = QuotedListHint(node); !quoted.empty()) return quoted;
  std::vector<std::string> items;
  if (node.IsScalar()) items = Words(node.Scalar());
  if (node.IsMap()) items = Scalars(node);
  if (items.size() != count || count < 2) return "";
  return "; write " + Cut("[" + Joined(items) + "]");
}

std::string DashHint(const YAML::Node& node) {
  if (!node.IsMap()) return "";
  return node.Style() == YAML::EmitterStyle::Flow ? "; put brackets around it: [{...}]"
                                                  : "; begin each of its entries with a dash: `- `";
}

std::string NamesHint(const YAML::Node& node, EntryForm form) {
  const bool several = node.IsSequence() && node.size() > 0 && node[0].IsMap();
  if (several && node[0]["name"] && node[0]["name"].IsScalar()) {
    return fmt::format("; write `{0}:` instead of `- name: {0}`, without the dash",
                       Cut(node[0]["name"].Scalar()));
  }
  if (several) return "; write `name: {...}` for each, without dashes";
  const bool lists = form == EntryForm::kList;
  double number = 0;
  if (lists && node.IsScalar() && !YAML::convert<double>::decode(node, number)) {
    return "; write {arm: [0, 0.5]} with the name of the group in the place of `arm`, and its "
           "numbers";
  }
  if (lists && (node.IsSequence() || node.IsScalar())) {
    return fmt::format("; write {{arm: {}}} with the name of the group in the place of `arm`",
                       node.IsSequence() ? Short(node) : "[" + Short(node) + "]");
  }
  if (form == EntryForm::kScalar && (node.IsScalar() || node.IsSequence())) {
    const std::vector<std::string> values =
        node.IsScalar() ? std::vector<std::string>{Cut(node.Scalar())} : Scalars(node);
    if (values.empty()) return "";
    return fmt::format("; write {{arm: {}}} with the name of {} group in the place of `arm`",
                       values[0], values.size() > 1 ? "each" : "the");
  }
  return node.IsSequence() ? "; write {name: " + Short(node) + "}" : "";
}

std::string NumbersHint(const YAML::Node& node) {
  const std::vector<std::string> words = node.IsScalar() ? Words(node.Scalar()) : Words("");
  const auto is_number = [](const std::string& word) {
    return word.find_first_not_of("+-.0123456789eE") == std::string::npos;
  };
  if (words.size() < 2 || !std::all_of(words.begin(), words.end(), is_number)) return "";
  return "; write " + Cut("[" + Joined(words) + "]");
}

std::string TextHint(const YAML::Node& node) {
  YAML::Node text;
  if (node.size() == 1 && node.IsMap()) text.reset(node.begin()->second);
  if (node.size() == 1 && node.IsSequence()) text.reset(node[0]);
  return text.IsScalar() ? "; write `" + Cut(text.Scalar()) + "` alone" : "";
}

std::string QuotedListHint(const YAML::Node& node) {
  if (!node.IsScalar() || node.Tag() != "!") return "";
  const std::string& text = node.Scalar();
  const bool list = text.starts_with('[') && text.ends_with(']');
  const bool map = text.starts_with('{') && text.ends_with('}');
  return list || map ? "; write it without the quotes: " + Cut(text) : "";
}

std::string NoBlankHint(const std::string& text, const std::vector<std::string>& fields) {
  const size_t colon = text.find(':');
  if (colon == std::string::npos || colon + 1 == text.size()) return "";
  const std::string name = text.substr(0, colon);
  if (std::find(fields.begin(), fields.end(), name) == fields.end()) return "";
  return fmt::format("there is no blank after the `:`; write `{}: {}`", name,
                     Cut(text.substr(colon + 1)));
}

int TabbedLine(std::string_view text, int last) {
  size_t begin = 0;
  for (int line = 1; line <= last && begin < text.size(); ++line) {
    const size_t first = text.find_first_not_of(' ', begin);
    if (first != std::string_view::npos && text[first] == '\t') return line;
    const size_t end = text.find('\n', begin);
    if (end == std::string_view::npos) break;
    begin = end + 1;
  }
  return 0;
}

bool LooksLikeXml(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return text.starts_with("<?xml") || text.starts_with("<!--") || text.starts_with("<mujoco") ||
         text.starts_with("<robot");
}

FileKind FileKindOf(const std::string& type) {
  for (const FileKind& kind : FileKinds()) {
    if (kind.type == type) return kind;
  }
  return {type, type + " file", "", "docs/README.md", {}};
}

std::string OtherKindOfFile(const YAML::Node& root, const std::string& type,
                            const std::vector<std::string>& fields, const std::string& source) {
  std::vector<std::string> keys;
  for (const auto& entry : root) keys.push_back(entry.first.IsScalar() ? entry.first.Scalar() : "");
  const std::vector<FileKind> kinds = OtherKinds(keys, type, fields);
  if (kinds.empty()) return "";
  std::string names, uses;
  for (const FileKind& kind : kinds) {
    names += (names.empty() ? "" : " or ") + WithArticle(kind.what);
    uses += (uses.empty() ? " " : ". ") + kind.use;
    uses.replace(uses.find("FILE"), 4, source);
  }
  std::string wanted = WithArticle(FileKindOf(type).what);
  wanted.front() = 'A';
  return "this looks like " + names + ": it has " +
         ListNames(Shared(keys, kinds.front().fields), 5) + ". " + wanted + " is wanted here." +
         uses;
}

bool IsOtherKindOfText(std::string_view text, const std::string& type) {
  std::vector<std::string> keys;
  std::istringstream lines{std::string(text)};
  for (std::string line; std::getline(lines, line);) {
    const size_t colon = line.find(':');
    const bool is_field = line.find_first_of(" \t#-{}") != 0;
    if (is_field && colon != std::string::npos) keys.push_back(line.substr(0, colon));
  }
  return !OtherKinds(keys, type, FileKindOf(type).fields).empty();
}

}  // namespace robocell::internal::yaml
