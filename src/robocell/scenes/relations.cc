#include "robocell/scenes/relations.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <sstream>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/registry.h"
#include "robocell/base/suggestions.h"
#include "robocell/scenes/built_in_relations.h"

namespace robocell {
namespace {

Registry<RelationKind>& Relations() {
  static Registry<RelationKind> registry("relation", internal::BuiltInRelations());
  return registry;
}

std::optional<double> NumberOf(const std::string& word) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

[[noreturn]] void Refuse(const std::string& text, const std::string& why) {
  throw ArgumentError(fmt::format("'{}' {}", text, why));
}

// Returns "A next_to B [the largest gap in metres]".
std::string FormOf(const std::string& name, const RelationKind& kind) {
  std::string form = "A " + name;
  if (kind.reference != RelationReference::kNone) form += " B";
  if (!kind.defaults.empty()) form += " [" + kind.numbers_text + "]";
  if (kind.reference == RelationReference::kOrNumbers)
    form += ", or A " + name + " " + kind.numbers_text;
  return form;
}

}  // namespace

StatedRelation ParseRelation(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  if (words.size() < 2) {
    Refuse(text, fmt::format("is no relation: write SUBJECT RELATION [REFERENCE] [NUMBERS], such "
                             "as \"mug inside tray\"; relations: {}",
                             ListNames(RelationNames(), 20)));
  }
  StatedRelation stated{.subject = words[0], .relation = words[1]};
  const std::optional<RelationKind> known = Relations().Get(stated.relation);
  if (!known)
    Refuse(text, "is no relation: " + NoSuchName("", "relation", stated.relation, RelationNames()));
  const RelationKind& kind = *known;
  const std::string form = "; write: " + FormOf(stated.relation, kind);
  for (size_t i = 2; i < words.size(); ++i) {
    if (words[i] == ">=" || words[i] == "<=") continue;
    if (const auto number = NumberOf(words[i])) {
      if (!std::isfinite(*number) ||
          (kind.reference != RelationReference::kOrNumbers && *number < 0))
        Refuse(text, fmt::format("has the number {}, which must be finite and at least 0{}",
                                 words[i], form));
      stated.numbers.push_back(*number);
    } else if (stated.reference.empty() && stated.numbers.empty()) {
      stated.reference = words[i];
    } else {
      Refuse(text, fmt::format("has the word '{}' too many{}", words[i], form));
    }
  }
  const size_t given = stated.numbers.size();
  if (kind.reference == RelationReference::kNone && !stated.reference.empty())
    Refuse(text, fmt::format("has a reference, '{}', which '{}' does not take{}", stated.reference,
                             stated.relation, form));
  if (kind.reference == RelationReference::kRequired && stated.reference.empty())
    Refuse(text, "lacks the name of what it relates to" + form);
  if (kind.reference == RelationReference::kOrNumbers && stated.reference.empty()) {
    if (given != static_cast<size_t>(kind.numbers_instead))
      Refuse(text, fmt::format("has {}, not {}{}", Counted(static_cast<int64_t>(given), "number"),
                               kind.numbers_instead, form));
    if (!(stated.numbers.back() > 0))
      Refuse(text, fmt::format("has the radius {}, which must be above 0{}", stated.numbers.back(),
                               form));
    return stated;
  }
  if (given > kind.defaults.size())
    Refuse(text, fmt::format("has {} too many{}",
                             Counted(static_cast<int64_t>(given - kind.defaults.size()), "number"),
                             form));
  for (size_t i = given; i < kind.defaults.size(); ++i) stated.numbers.push_back(kind.defaults[i]);
  if (kind.subject == RelationSubject::kJoint && !stated.numbers.empty() && stated.numbers[0] > 1)
    Refuse(text, fmt::format("has the share {}, and shares of a joint's range go from 0 to 1{}",
                             stated.numbers[0], form));
  if (stated.subject == stated.reference) Refuse(text, "relates an object to itself" + form);
  return stated;
}

std::string TextOf(const StatedRelation& stated) {
  std::string text = stated.subject + " " + stated.relation;
  if (!stated.reference.empty()) text += " " + stated.reference;
  for (const double number : stated.numbers) text += fmt::format(" {:g}", number);
  return text;
}

std::unique_ptr<BoundRelation> BindRelation(const Scene& scene, const StatedRelation& stated) {
  return FindRelation(stated.relation).bind(scene, stated);
}

std::string WordsOf(const StatedRelation& stated, const std::string& subject,
                    const std::string& reference) {
  return fmt::format(fmt::runtime(FindRelation(stated.relation).words), subject,
                     stated.reference.empty() ? "goal" : reference);
}

void RegisterRelation(const std::string& name, RelationKind kind) {
  if (!kind.bind) throw ArgumentError(fmt::format("relation '{}' needs a function `bind`", name));
  Relations().Register(name, std::move(kind), /*replace=*/false);
}

RelationKind FindRelation(const std::string& name) { return Relations().Find(name); }

std::vector<std::string> RelationNames() { return Relations().names(); }

}  // namespace robocell
