#include "robocell/scenes/relations.h"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>
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

// Returns "A next_to B [<= the largest gap in metres]".
std::string FormOf(const std::string& name, const RelationKind& kind) {
  std::string form = "A " + name;
  if (kind.reference != RelationReference::kNone) form += " B";
  if (!kind.defaults.empty()) {
    const std::string space = kind.comparison.empty() ? "" : " ";
    form += " [" + kind.comparison + space + kind.numbers_text + "]";
  }
  if (kind.reference == RelationReference::kOrNumbers)
    form += ", or A " + name + " " + kind.numbers_text;
  return form;
}

struct Word {
  std::string text;
  bool is_quoted = false;
};

// Splits a sentence at its spaces, but not within quotes.
std::vector<Word> WordsIn(const std::string& text) {
  std::vector<Word> words;
  for (size_t at = 0; at < text.size();) {
    const auto is_space = [&](size_t i) {
      return std::isspace(static_cast<unsigned char>(text[i])) != 0;
    };
    if (is_space(at)) {
      ++at;
    } else if (text[at] == '\'' || text[at] == '"') {
      const size_t end = text.find(text[at], at + 1);
      if (end == std::string::npos) Refuse(text, "lacks the quote at the end of a name");
      words.push_back({text.substr(at + 1, end - at - 1), true});
      at = end + 1;
    } else {
      size_t end = at;
      while (end < text.size() && !is_space(end)) ++end;
      words.push_back({text.substr(at, end - at)});
      at = end;
    }
  }
  return words;
}

// Returns a name as a sentence has it.
std::string Quoted(const std::string& name) {
  const bool is_plain = !name.empty() && name.find_first_of(" \t\n'\"") == std::string::npos &&
                        !NumberOf(name) && name != ">=" && name != "<=";
  if (is_plain) return name;
  const char* quote = name.find('\'') == std::string::npos ? "'" : "\"";
  return quote + name + quote;
}

}  // namespace

StatedRelation ParseRelation(const std::string& text) {
  const std::vector<Word> words = WordsIn(text);
  if (words.size() < 2) {
    Refuse(text, fmt::format("is no relation: write SUBJECT RELATION [REFERENCE] [NUMBERS], such "
                             "as \"mug inside tray\"; relations: {}",
                             ListNames(RelationNames(), 20)));
  }
  StatedRelation stated{.subject = words[0].text, .relation = words[1].text};
  const std::optional<RelationKind> known = Relations().Get(stated.relation);
  if (!known)
    Refuse(text, "is no relation: " + NoSuchName("", "relation", stated.relation, RelationNames()));
  const RelationKind& kind = *known;
  const std::string form = "; write: " + FormOf(stated.relation, kind);
  for (size_t i = 2; i < words.size(); ++i) {
    const auto& [word, is_quoted] = words[i];
    if (!is_quoted && (word == ">=" || word == "<=")) {
      // The other way round it would be another goal.
      if (word != kind.comparison)
        Refuse(text, fmt::format("has '{}', and '{}' {}{}", word, stated.relation,
                                 kind.comparison.empty() ? "takes no comparison"
                                                         : "takes '" + kind.comparison + "' only",
                                 form));
      if (i + 1 == words.size() || words[i + 1].is_quoted || !NumberOf(words[i + 1].text))
        Refuse(text, fmt::format("has '{}' without a number after it{}", word, form));
      continue;
    }
    const auto number = is_quoted ? std::nullopt : NumberOf(word);
    if (number) {
      if (!std::isfinite(*number) ||
          (kind.reference != RelationReference::kOrNumbers && *number < 0))
        Refuse(text,
               fmt::format("has the number {}, which must be finite and at least 0{}", word, form));
      stated.numbers.push_back(*number);
    } else if (stated.reference.empty() && stated.numbers.empty()) {
      stated.reference = word;
    } else {
      Refuse(text, fmt::format("has the word '{}' too many{}", word, form));
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
  if (kind.is_share && (!(stated.numbers[0] > 0) || stated.numbers[0] > 1))
    Refuse(text, fmt::format("has the share {}, and {} is above 0 and at most 1{}",
                             stated.numbers[0], kind.numbers_text, form));
  if (stated.subject == stated.reference) Refuse(text, "relates an object to itself" + form);
  return stated;
}

std::string TextOf(const StatedRelation& stated) {
  std::string text = Quoted(stated.subject) + " " + stated.relation;
  if (!stated.reference.empty()) text += " " + Quoted(stated.reference);
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
  try {
    (void)fmt::format(fmt::runtime(kind.words), "mug", "tray");
  } catch (const fmt::format_error& error) {
    throw ArgumentError(fmt::format(
        "relation '{}': the words \"{}\" are no instruction ({}); write {{0}} for the subject and "
        "{{1}} for the reference, such as \"put the {{0}} on the {{1}}\"",
        name, kind.words, error.what()));
  }
  Relations().Register(name, std::move(kind), /*replace=*/false);
}

RelationKind FindRelation(const std::string& name) { return Relations().Find(name); }

std::vector<std::string> RelationNames() { return Relations().names(); }

}  // namespace robocell
