#include "robocell/spec/yaml_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "robocell/spec/field_places.h"
#include "robocell/spec/render_quality.h"
#include "robocell/spec/spec_file.h"

namespace robocell::internal::yaml {
namespace {

constexpr size_t kLongestShown = 60;     // longest piece of a file quoted in a message
constexpr size_t kMostValues = 200'000;  // a spec has hundreds; only aliases get that far
constexpr size_t kMostIndices = 2'000'000;

std::string Quoted(const YAML::Node& node) {
  std::string text = node.Scalar();
  if (text.size() > kLongestShown) text = text.substr(0, kLongestShown) + "...";
  return "'" + text + "'";
}

bool ParseDouble(const std::string& text, double& out) {
  if (text == ".nan" || text == ".NaN" || text == "nan") return out = std::nan(""), true;
  if (text == ".inf" || text == ".Inf" || text == "inf") return out = INFINITY, true;
  if (text == "-.inf" || text == "-.Inf" || text == "-inf") return out = -INFINITY, true;
  const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-';
  const char* begin = text.c_str() + (plus ? 1 : 0);
  const char* end = text.c_str() + text.size();
  const auto [rest, error] = std::from_chars(begin, end, out);
  return error == std::errc() && rest == end;
}

// Parses 1/480 or 500/33: numbers without an exact decimal.
bool ParseFraction(const std::string& text, double& out) {
  const size_t bar = text.find('/');
  if (bar == std::string::npos) return false;
  double num = 0, den = 0;
  if (!ParseDouble(text.substr(0, bar), num) || !ParseDouble(text.substr(bar + 1), den))
    return false;
  out = num / den;
  return den != 0 && std::isfinite(out);
}

bool ParseInt(const std::string& text, int64_t& out) {
  const char* end = text.c_str() + text.size();
  const auto [rest, error] = std::from_chars(text.c_str(), end, out);
  return error == std::errc() && rest == end;
}

bool IsWhole(const std::string& text) {
  const size_t digits = text.starts_with('-') ? 1 : 0;
  return text.size() > digits && text.find_first_not_of("0123456789", digits) == std::string::npos;
}

// Returns "; write 1000" for 1e3 or 1000.0.
std::string WholeNumberHint(const std::string& text) {
  double value = 0;
  if (!ParseDouble(text, value) || std::floor(value) != value || std::abs(value) > 1e15) return "";
  return fmt::format("; write {:.0f}", value);
}

// Returns true if `path` is `root` itself or a part of it.
bool IsAtOrBelow(std::string_view path, std::string_view root) {
  if (root.empty()) return true;
  if (!path.starts_with(root)) return false;
  return path.size() == root.size() || path[root.size()] == '.' || path[root.size()] == '[';
}

}  // namespace

Reader::Reader(std::string source, std::string directory)
    : source_(std::move(source)), directory_(std::move(directory)) {}

Reader::~Reader() = default;

void Reader::RememberEmpty(const YAML::Node& key, const YAML::Node& value) {
  constexpr size_t kMost = 64;  // each is read soon
  if (!value.IsNull() || value.Mark().line == key.Mark().line) return;
  if (empty_.size() == kMost) empty_.erase(empty_.begin());
  empty_.emplace_back(value, key.Mark());
}

// The parser places a missing value at the next token of the file.
YAML::Mark Reader::MarkOf(const YAML::Node& node) const {
  if (node.IsNull()) {
    for (auto it = empty_.rbegin(); it != empty_.rend(); ++it)
      if (it->first.is(node)) return it->second;
  }
  return node.Mark();
}

std::string Reader::At(const YAML::Node& node) const {
  const std::string& path = problems_.path();
  const YAML::Mark mark = MarkOf(node);
  const bool made_up = mark.is_null();  // stands for a missing value
  for (auto it = overrides_.rbegin(); it != overrides_.rend(); ++it) {
    // In an empty file only the overridden fields exist; other missing fields are missing in the
    // file.
    const bool made_for_it = made_up && !path.empty() && IsAtOrBelow(it->path, path);
    if (IsAtOrBelow(path, it->path) || made_for_it) {
      return "--set " + it->text;
    }
  }
  if (made_up) return source_;
  return fmt::format("{}:{}:{}", source_, mark.line + 1, mark.column + 1);
}

void Reader::Mark(const YAML::Node& node) {
  const std::string at = At(node);
  if (++values_ > kMostValues) {
    throw SpecError(
        fmt::format("{}: more than {} values, counting aliases where they are used; "
                    "no spec needs that many",
                    at, kMostValues));
  }
  (*sources_)[problems_.path()] = at;
}

void Reader::Fail(const YAML::Node& node, const std::string& message) {
  problems_.AddFromSource(At(node), message);
}

void Reader::FailKind(const YAML::Node& node, const std::string& expected,
                      const std::string& hint) {
  const std::string found = node.IsNull()       ? "nothing"
                            : node.IsScalar()   ? Quoted(node)
                            : node.IsSequence() ? "a list"
                                                : "names with values";
  Fail(node,
       "expected " + expected + ", found " + found + (hint.empty() ? QuotedListHint(node) : hint));
}

void Reader::FailNoFields(const YAML::Node& root, const char* type, const std::string& example) {
  FailKind(root, "the fields of " + WithArticle(type) + ", for example `" + example + ": ...`");
}

void Reader::FailNotFields(const YAML::Node& node, const char* type, const std::string& hint) {
  FailKind(node, "the fields of " + WithArticle(type), hint);
}

void Reader::FailField(const YAML::Node& key, const std::string& name, const YAML::Node& value,
                       const char* type, const std::vector<std::string>& names,
                       const char* when_nested, const std::string& more) {
  const Problems::Scope scope(problems_, name);
  if (when_nested != nullptr && value.IsMap() && NearestNames(name, names, 1).empty()) {
    return Fail(key, when_nested);
  }
  if (const std::string hint = NoBlankHint(name, names); !hint.empty()) return Fail(key, hint);
  std::string hint = more;
  if (hint.empty()) hint = PlaceHint(type, name);
  if (hint.empty() && IsOneOf("start", root_fields_)) hint = StartHint(name);
  if (hint.empty()) hint = TopLevelHint(name);
  Fail(key, NoSuchName(WithArticle(type), "field", name, names) + hint);
}

std::string Reader::TopLevelHint(const std::string& name) const {
  if (problems_.path() == name || !std::count(root_fields_.begin(), root_fields_.end(), name))
    return "";
  return fmt::format(" `{}` is a field of the whole file: write it at the top level, not indented",
                     name);
}

bool Reader::Fits(const YAML::Node& node, ReadInto read, void* out) const {
  Reader trial(source_, directory_);
  read(trial, node, out);
  return trial.problems().empty();
}

std::string Reader::FieldsHint(const YAML::Node& node, const char* fits,
                               const std::vector<std::string>& names) {
  if (fits == nullptr) return "; its fields: " + ListNames(names);
  return "; write {" + std::string(fits) + ": " + Short(node) + "}";
}

bool Reader::IsListOf(const YAML::Node& node, size_t count, const char* items) {
  const std::string want = "a list of " + std::to_string(count) + items;
  if (!node.IsSequence()) {
    FailKind(node, want, ListHint(node, count));
    return false;
  }
  if (node.size() == count) return true;
  Fail(node, "expected " + want + ", found a list of " + std::to_string(node.size()));
  return false;
}

std::optional<size_t> Reader::ReadOneOf(const YAML::Node& node,
                                        const std::vector<std::string>& names) {
  std::string text;
  if (!ReadScalar(node, "one of " + ListNames(names), text)) return {};
  const auto known = std::find(names.begin(), names.end(), text);
  if (known != names.end()) return known - names.begin();
  Fail(node, "'" + text + "' is not one of " + ListNames(names) + "." + DidYouMean(text, names));
  return {};
}

void Reader::ForEachKey(const YAML::Node& node, const OnKey& f, const IsStrange& strange) {
  std::set<std::string> seen;
  Stray stray(node);
  YAML::Node last;
  for (const auto& entry : node) {
    std::string name;
    if (!ReadScalar(entry.first, "a name", name)) continue;
    if (stray.IsPartOfLast(entry.first, entry.second, strange(name))) {
      ReportStray(last, stray);
      continue;
    }
    last.reset(entry.first);
    stray.SetLast(entry.first, entry.second, problems_.list().size());
    RememberEmpty(entry.first, entry.second);
    if (seen.insert(name).second) {
      f(entry.first, name, entry.second);
    } else {
      const Problems::Scope scope(problems_, name);
      Fail(entry.first, "'" + name + "' is given twice");
    }
  }
  for (const std::string& name : OverriddenKeys()) {
    const YAML::Node empty(YAML::NodeType::Map);
    if (seen.insert(name).second) f(empty, name, empty);
  }
}

void Reader::ReadAt(const YAML::Node& node, std::string_view key, ReadInto read, void* out) {
  const Problems::Scope scope(problems_, key);
  ReadHere(node, read, out);
}

void Reader::ReadItem(const YAML::Node& node, size_t i, ReadInto read, void* out) {
  const Problems::Scope scope(problems_, i);
  ReadHere(node, read, out);
}

void Reader::ReadHere(const YAML::Node& node, ReadInto read, void* out) {
  const YAML::Node value = Effective(node);
  Mark(value);
  read(*this, value, out);
}

void Reader::ReadKind(const YAML::Node& node, KindSpec& out, const std::string& implied,
                      const NamedReader& more) {
  const KindRegistry& registry = out.registry();
  const char* key = registry.key();
  std::string kind = implied;
  const YAML::Node given = node[key];
  if (given.IsDefined() || IsOneOf(key, OverriddenKeys())) {
    const size_t before = problems_.list().size();
    ReadAt(given.IsDefined() ? given : YAML::Node(YAML::NodeType::Map), key, kind);
    if (problems_.list().size() != before) return;
  }
  if (!registry.Has(kind)) {
    const Problems::Scope scope(problems_, key);
    return Fail(
        given.IsDefined() ? given : node,
        fmt::format("{} A {} of your own is registered before: import its module, or name "
                    "it with --import",
                    NoSuchName("", registry.noun(), kind, registry.kinds()), registry.noun()));
  }
  if (kind != out.kind()) out.SetKind(kind);
  KindFields& fields = out.fields();
  const std::vector<KindFieldRef> refs = fields.refs();
  std::vector<std::string> known = fields.names();
  known.insert(known.begin(), key);
  if (!more.name.empty()) known.push_back(more.name);
  const auto read = [&](const YAML::Node& at, const std::string& name, const YAML::Node& value) {
    if (name == key) return;
    if (more.read && name == more.name) return more.read(value);
    const auto field = std::ranges::find(refs, name, &KindFieldRef::name);
    if (field == refs.end()) {
      const std::string other = registry.KindWith(name);
      const std::string hint = other.empty()
                                   ? KindKeyHint(key, name)
                                   : fmt::format(" It is a field of `{}: {}`", key, other);
      return FailField(at, name, value, fields.type_name().c_str(), known, nullptr, hint);
    }
    std::visit([&](auto* to) { ReadExplainedValue(value, name, field->doc, *to); }, field->value);
  };
  ForEachKey(node, read, [&](const std::string& name) { return IsNoField(name, known); });
}

void Reader::Read(const YAML::Node& node, TaskSpec& out) {
  if (!node.IsMap()) {
    const std::string kind = node.IsScalar() ? node.Scalar() : out.kind();
    return FailNotFields(node, "task", "; write {kind: " + kind + "}");
  }
  ReadKind(node, out, out.kind(), {});
}

void Reader::Read(const YAML::Node& node, SceneSourceSpec& out) {
  if (!node.IsMap()) {
    const std::string kind = node.IsScalar() ? node.Scalar() : out.kind();
    return FailNotFields(node, "scene source", "; write {source: " + kind + "}");
  }
  // Files give enough information.
  const bool files = node["files"].IsDefined() || IsOneOf("files", OverriddenKeys());
  const auto read_houses = [&](const YAML::Node& value) {
    ReadExplainedValue(value, "houses", SceneSourceSpec::kHousesDoc, out.houses);
  };
  ReadKind(node, out, files ? FilesScenes::kKind : out.kind(), {"houses", read_houses});
}

void Reader::ReadExplained(const YAML::Node& node, const std::string& name, const char* doc,
                           ReadInto read, void* out) {
  const size_t before = problems_.list().size();
  ReadAt(node, name, read, out);
  ExplainField(name, doc, before);
}

std::optional<Vec4> Reader::ReadWxyz(const YAML::Node& node, const std::string& name) {
  Vec4 wxyz{};
  const size_t before = problems_.list().size();
  ReadAt(node, name, wxyz);
  const bool good = problems_.list().size() == before;
  const Problems::Scope scope(problems_, "quat");
  Mark(node);
  return good ? std::optional(NormalizedFromWxyz(wxyz)) : std::nullopt;
}

bool Reader::IsNoField(const std::string& name, const std::vector<std::string>& fields) {
  return !IsOneOf(name, fields) && name != "quat_wxyz" && NearestNames(name, fields, 1).empty();
}

std::string Reader::MeantField(const YAML::Node& node, const std::string& name,
                               const std::vector<std::string>& fields) {
  const std::vector<std::string> near = NearestNames(name, fields, 1);
  if (near.empty() || (node.IsMap() && node[near.front()])) return "";
  return near.front();
}

void Reader::ForgetProblemsOf(const std::string& field, size_t first_problem) {
  if (problems_.list().size() == first_problem) return;
  problems_.Truncate(first_problem);
  unread_.push_back(JoinPath(problems_.path(), field));
}

void Reader::MarkMap(const char* field) {
  (*sources_)[JoinPath(problems_.path(), field) + std::string(kAnyKey)] = "";
}

void Reader::ReportStray(const YAML::Node& key, const Stray& stray) {
  problems_.Truncate(stray.problems());
  const Problems::Scope scope(problems_, key.Scalar());
  Fail(key, stray.Text());
}

void Reader::ExplainField(std::string_view name, std::string_view doc, size_t first_problem) {
  const Problems::Scope scope(problems_, name);
  problems_.Amend(first_problem, [&](Problem& p) {
    if (p.path == problems_.path() && p.message.starts_with("expected ") && !doc.empty()) {
      const bool ended = p.message.ends_with('.') || p.message.ends_with('?');
      p.message += (ended ? " " : ". ") + std::string(doc);
    }
  });
}

YAML::Node Reader::Effective(const YAML::Node& node) {
  YAML::Node effective = node;
  for (Override& o : overrides_) {  // the last one wins
    if (o.path != problems_.path()) continue;
    o.used = true;
    effective.reset(o.value);
  }
  return effective;
}

std::vector<std::string> Reader::OverriddenKeys() const {
  std::vector<std::string> keys;
  const std::string& here = problems_.path();
  const size_t skip = here.empty() ? 0 : here.size() + 1;
  for (const Override& o : overrides_) {
    if (!IsAtOrBelow(o.path, here) || o.path.size() <= skip) continue;
    if (skip > 0 && o.path[here.size()] != '.') continue;
    keys.push_back(o.path.substr(skip, o.path.find_first_of(".[", skip) - skip));
  }
  return keys;
}

namespace {

// Converts "streams.0.camera" to "streams[0].camera".
std::string WithIndicesInBrackets(const std::string& path) {
  std::string out;
  for (size_t from = 0; from < path.size();) {
    const size_t dot = std::min(path.find('.', from), path.size());
    const std::string key = path.substr(from, dot - from);
    const bool index = !key.empty() && key.find_first_not_of("0123456789") == std::string::npos;
    out += index ? "[" + key + "]" : (out.empty() ? "" : ".") + key;
    from = dot + 1;
  }
  return out;
}

}  // namespace

void Reader::ReportUnusedOverrides() {
  for (const Override& o : overrides_) {
    const auto is_reported = [&](const Problem& p) { return p.source == "--set " + o.text; };
    const auto& list = problems_.list();
    if (o.used || std::any_of(list.begin(), list.end(), is_reported)) continue;
    const std::string in_brackets = WithIndicesInBrackets(o.path);
    problems_.AddFromSource(
        "--set " + o.text,
        "'" + o.path + "' leads to nothing in " + source_ +
            (in_brackets == o.path ? "; set the value around it as a whole"
                                   : "; entries of lists have brackets: " + in_brackets));
  }
}

void Reader::AppendUnread(const Problems& found) {
  const std::vector<Problem> read = problems_.list();
  for (const Problem& p : found.list()) {
    // A value that could not be read keeps its default, and its problem is reported once. The same
    // holds for a list with such a value in it.
    const auto unread = [&](const Problem& q) {
      const bool in_list = q.path.starts_with(p.path + "[") && !p.path.empty();
      return !q.path.empty() && (in_list || IsAtOrBelow(p.path, q.path));
    };
    const auto misspelt = [&](const std::string& path) { return IsAtOrBelow(p.path, path); };
    if (std::any_of(read.begin(), read.end(), unread)) continue;
    if (std::any_of(unread_.begin(), unread_.end(), misspelt)) continue;
    problems_.AddProblem(p);
  }
}

bool Reader::ReadScalar(const YAML::Node& node, const std::string& expected, std::string& out) {
  if (!node.IsScalar()) return FailKind(node, expected), false;
  out = node.Scalar();
  return true;
}

void Reader::Read(const YAML::Node& node, bool& out) {
  std::string text;
  if (!ReadScalar(node, "true or false", text)) return;
  if (text == "true" || text == "True") {
    out = true;
  } else if (text == "false" || text == "False") {
    out = false;
  } else {
    FailKind(node, "true or false");
  }
}

template <class Int>
void Reader::ReadWhole(const YAML::Node& node, Int& out) {
  using Limits = std::numeric_limits<Int>;
  std::string text;
  if (!ReadScalar(node, "a whole number", text)) return;
  int64_t wide = 0;
  const bool parsed = ParseInt(text, wide);
  if (parsed && wide >= Limits::min() && wide <= Limits::max()) {
    out = static_cast<Int>(wide);
  } else if (IsWhole(text)) {
    FailKind(node, text.starts_with('-')
                       ? fmt::format("a whole number not below {}", Limits::min())
                       : fmt::format("a whole number of at most {}", Limits::max()));
  } else {
    FailKind(node, "a whole number", WholeNumberHint(text));
  }
}

void Reader::Read(const YAML::Node& node, int64_t& out) { ReadWhole(node, out); }
void Reader::Read(const YAML::Node& node, int& out) { ReadWhole(node, out); }

void Reader::Read(const YAML::Node& node, double& out) {
  std::string text;
  if (!ReadScalar(node, "a number", text)) return;
  if (!ParseDouble(text, out) && !ParseFraction(text, out))
    FailKind(node, "a number", NumbersHint(node));
}

void Reader::Read(const YAML::Node& node, std::string& out) {
  if (node.IsScalar())
    out = node.Scalar();
  else
    FailKind(node, "a text", TextHint(node));
}

void Reader::Read(const YAML::Node& node, NameList& out) {
  const size_t problems_before = problems_.list().size();
  out.names.clear();
  const auto expand = [&](const YAML::Node& item) {
    std::string text;
    if (!ReadScalar(item, "a name, a list of names, or a range like joint1..joint7", text)) return;
    const auto add = [&](const std::string& name) {
      Problems::Scope scope(problems_, out.names.size());
      Mark(item);
      out.names.push_back(name);
    };
    if (!QuotedListHint(item).empty()) return FailKind(item, "a name, or a list of names");
    if (item.Tag() == "!") return add(text);  // quoted text is never a range
    if (text.find(", ") != std::string::npos)
      return FailKind(item, "a name, or a list of names", "; write [" + text + "]");
    try {
      for (const std::string& name : NameList::Expand(text).names) add(name);
    } catch (const ArgumentError& e) {
      Fail(item, e.what());
    }
  };
  if (node.IsSequence()) {
    for (const YAML::Node& item : node) expand(item);
  } else {
    expand(node);
  }
  // An incomplete list is not compared with others.
  if (problems_.list().size() > problems_before) out.names.clear();
}

void Reader::Read(const YAML::Node& node, IndexList& out) {
  out.values.clear();
  const auto expand = [&](const YAML::Node& item) {
    std::string text;
    if (!ReadScalar(item, "whole numbers: a list, or a range like 0..3", text)) return;
    const size_t dots = text.find("..");
    int64_t from = 0, to = 0;
    const bool ok = dots == std::string::npos ? ParseInt(text, from) && ((to = from), true)
                                              : ParseInt(text.substr(0, dots), from) &&
                                                    ParseInt(text.substr(dots + 2), to);
    if (!ok || to < from || from < -1'000'000'000 || to > 1'000'000'000) {
      return FailKind(item, "whole numbers: a list, or a rising range like 0..3");
    }
    indices_ += static_cast<size_t>(to - from + 1);
    if (indices_ > kMostIndices) {
      return Fail(item, fmt::format("more than {} numbers; give a smaller range", kMostIndices));
    }
    for (int64_t k = from; k <= to; ++k) out.values.push_back(static_cast<int>(k));
  };
  if (node.IsSequence()) {
    for (const YAML::Node& item : node) expand(item);
  } else {
    expand(node);
  }
}

Vec4 Reader::NormalizedFromWxyz(const Vec4& q) {
  // Numbers copied from a file have few digits; the validation reports a clearly wrong length.
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const double scale = std::abs(norm - 1) < 1e-3 ? 1 / norm : 1;
  return {q[1] * scale, q[2] * scale, q[3] * scale, q[0] * scale};
}

namespace {

// A pose in YAML: {pos: [..], euler: [..]} or quat, quat_wxyz.
struct PoseFields {
  Vec3 pos = {};
  Vec3 euler = {};
  Vec4 quat = kIdentityQuat;

  static constexpr const char* kTypeName = "Pose";
  template <class V>
  static void Fields(V&& v) {
    v("pos", &PoseFields::pos, "");
    v("euler", &PoseFields::euler, "");
    v("quat", &PoseFields::quat, "");
  }
  void Validate(Problems& problems) const { ValidatePlacement(euler, quat, problems); }
};

struct IndexedElement {
  std::string body = {};
  int index = 0;

  static constexpr const char* kTypeName = "unnamed element";
  template <class V>
  static void Fields(V&& v) {
    v("body", &IndexedElement::body, "");
    v("index", &IndexedElement::index, "", Bound::kNonNegative);
  }
};

}  // namespace

void Reader::Read(const YAML::Node& node, Pose& out) {
  PoseFields fields;
  const size_t before = problems_.list().size();
  Read(node, fields);
  if (problems_.list().size() == before) ValidateFields(fields, problems_);
  if (problems_.list().size() == before) {
    out = PlacementPose(fields.pos, fields.euler, fields.quat);
  }
}

void Reader::Read(const YAML::Node& node, RendererConfig& out) {
  if (node.IsScalar()) return Read(node, out.backend);
  if (!node.IsMap()) {
    return FailKind(node, "the name of a back end, or {backend: soft, quality: standard}");
  }
  ReadFields(node, out);
}

void Reader::Read(const YAML::Node& node, RenderQuality& out) {
  if (node.IsScalar()) {
    const std::vector<std::string> names = RenderQualities();
    if (const auto which = ReadOneOf(node, names)) out = NamedQuality(names[*which]);
    return;
  }
  if (!node.IsMap()) return FailKind(node, "fast, standard, high, or fields with values");
  ReadFields(node, out);
}

void Reader::Read(const YAML::Node& node, AttachTarget& out) {
  out = {};
  if (node.IsScalar()) return ReadAttachWord(node, out);
  if (!node.IsMap() || node.size() != 1) {
    return FailKind(node, "world, root, shared_base, or {site: name}");
  }
  Read(node.begin()->first, out.kind);
  Read(node.begin()->second, out.name);
}

void Reader::ReadAttachWord(const YAML::Node& node, AttachTarget& out) {
  const std::vector<std::string> kinds = ValueNames<AttachKind>();
  if (std::find(kinds.begin(), kinds.end(), node.Scalar()) != kinds.end()) {
    return Read(node, out.kind);
  }
  FailKind(
      node, "world, root, shared_base, or {site: name}",
      fmt::format("; write {{site: {0}}} if it is a site, or {{body: {0}}}, {{frame: {0}}}.{1}",
                  Short(node), DidYouMean(node.Scalar(), {"world", "root", "shared_base"})));
}

void Reader::Read(const YAML::Node& node, ElementRef& out) {
  out = {};
  if (node.IsScalar()) return Read(node, out.name);
  if (!node.IsMap() || node.size() == 0) {
    return FailKind(node, "a name, {site: name} or {geom: {body: name, index: 0}}");
  }
  const std::vector<std::string> kinds = ValueNames<ElementKind>();
  const auto names_kind = [&](const auto& entry) {
    return entry.first.IsScalar() && std::ranges::count(kinds, entry.first.Scalar()) > 0;
  };
  if (std::count_if(node.begin(), node.end(), names_kind) > 1) {
    return FailKind(node, "one element, as a name or {site: name}",
                    fmt::format("; write one of them: {{{}: {}}}", node.begin()->first.Scalar(),
                                Short(node.begin()->second)));
  }
  YAML::Node where = node;
  if (node.size() == 1) {
    Read(node.begin()->first, out.kind.emplace());
    where.reset(node.begin()->second);
    if (where.IsScalar()) return Read(where, out.name);
  }
  IndexedElement indexed;
  Read(where, indexed);
  out.body = indexed.body;
  out.index = indexed.index;
}

void Reader::Read(const YAML::Node& node, RandomNumber& out) {
  if (node.IsScalar()) return Read(node, out.value.emplace());
  if (!node.IsMap())
    return FailKind(node, "a number, {uniform: [a, b]}, {log_uniform: [a, b]} or {choice: [...]}");
  ReadFields(node, out);
}

void Reader::Read(const YAML::Node& node, RandomProperty& out) {
  if (node.IsScalar()) return Read(node, out.value.emplace());
  if (!node.IsMap()) {
    return FailKind(node,
                    "a number, {uniform: [a, b]}, {choice: [...]}, or {scale: {uniform: [a, b]}}");
  }
  ReadFields(node, out);
}

void Reader::Read(const YAML::Node& node, RandomizedValue& out) {
  double number = 0;
  if (node.IsMap()) return ReadFields(node, out);
  if (node.IsSequence() || (node.IsScalar() && YAML::convert<double>::decode(node, number)))
    return Read(node, out.numbers);
  Read(node, out.word);
}

void Reader::Read(const YAML::Node& node, RobotSource& out) {
  if (node.IsScalar()) out.file = node.Scalar();
  Read(node, out.config);
}

void Reader::Read(const YAML::Node& node, RobotConfig& out) {
  if (node.IsScalar()) return ReadRobotFile(node, out);
  if (!node.IsMap()) return FailKind(node, "a robot file, or the fields of a RobotConfig");
  ReadFields(node, out);
}

void Reader::ReadRobotFile(const YAML::Node& node, RobotConfig& out) {
  namespace fs = std::filesystem;
  const std::string file = (fs::path(directory_) / node.Scalar()).string();
  Reader robot(file, fs::path(file).parent_path().string());
  const std::string below = problems_.path() + ".";
  for (Override& o : overrides_) {
    if (!o.path.starts_with(below)) continue;
    o.used = true;
    robot.AddOverride({o.path.substr(below.size()), o.text, o.value});
  }
  try {
    robot.ReadDocument(ParseText(ReadSpecFile(file, RobotConfig::kTypeName), file), out);
  } catch (const Error& e) {
    return Fail(node, e.what());
  }
  problems_.AppendBelow(robot.problems());
  for (const auto& [path, at] : *robot.sources_) {
    const std::string here = JoinPath(problems_.path(), path);
    (*sources_)[path.empty() ? here + std::string(kOwnFile) : here] = at;
  }
}

}  // namespace robocell::internal::yaml
