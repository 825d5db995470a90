#include "robocell/scenes/referral.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scenes/object_view.h"

namespace robocell {
namespace {

// Distances in metres. A relation holds clearly within the first number and clearly not beyond the
// second.
constexpr double kOnTop[] = {0.015, 0.05};    // between a bottom and the top it stands on
constexpr double kBesideGap[] = {0.1, 0.2};   // between boxes next to each other
constexpr double kNearby[] = {0.5, 0.8};      // between middles, for directions
constexpr double kSameLevel[] = {0.25, 0.4};  // between bottoms, for directions
constexpr double kSlope[] = {0.6, 1.4};       // of a direction: across over along
constexpr double kApart = 0.05;               // between the first and the second of an order
constexpr double kGroup = 1.5;                // from the object to all others of an order
constexpr size_t kMostExpressions = 24;

Eigen::Vector3d Middle(const ReferableObject& object) { return 0.5 * (object.low + object.high); }

Answer Within(double value, const double (&bounds)[2]) {
  if (value <= bounds[0]) return Answer::kYes;
  return value > bounds[1] ? Answer::kNo : Answer::kInDoubt;
}

// A conjunction: one clear no is enough.
Answer Both(std::initializer_list<Answer> answers) { return std::min(answers); }

// Horizontal unit vectors of a viewer.
struct Axes {
  explicit Axes(const Viewer& viewer) : ahead(viewer.forward.x(), viewer.forward.y(), 0) {
    if (ahead.norm() < 1e-9) ahead = Eigen::Vector3d::UnitX();
    ahead.normalize();
    left = Eigen::Vector3d::UnitZ().cross(ahead);
  }
  Eigen::Vector3d ahead, left;
};

double HalfAlong(const ReferableObject& object, const Eigen::Vector3d& direction) {
  return 0.5 * (object.high - object.low).dot(direction.cwiseAbs());
}

// Returns whether an object is from a landmark in a horizontal direction, on the same level.
Answer IsTowards(const ReferableObject& object, const ReferableObject& landmark,
                 const Eigen::Vector3d& direction, const Eigen::Vector3d& across) {
  const Eigen::Vector3d displacement = Middle(object) - Middle(landmark);
  const double along = displacement.dot(direction);
  if (along <= 0) return Answer::kNo;
  const double half = HalfAlong(object, direction) + HalfAlong(landmark, direction);
  const Answer is_past = along >= 0.8 * half ? Answer::kYes : Answer::kInDoubt;
  return Both({is_past, Within(std::abs(displacement.dot(across)) / along, kSlope),
               Within(displacement.head<2>().norm(), kNearby),
               Within(std::abs(object.low.z() - landmark.low.z()), kSameLevel)});
}

// Returns how far a box stands out of another one, horizontally; 0 or less inside.
double OverhangOf(const Eigen::Vector3d& point, const ReferableObject& box) {
  double most = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < 2; ++i)
    most = std::max({most, box.low[i] - point[i], point[i] - box.high[i]});
  return most;
}

double GapBetween(const ReferableObject& a, const ReferableObject& b) {
  Eigen::Vector2d gap;
  for (int i = 0; i < 2; ++i) gap[i] = std::max({0.0, a.low[i] - b.high[i], b.low[i] - a.high[i]});
  return gap.norm();
}

Answer IsOn(const ReferableObject& object, const ReferableObject& landmark) {
  static constexpr double kOver[] = {0, 0.02};
  const Answer is_over = Within(OverhangOf(Middle(object), landmark), kOver);
  // A board of a shelf, or the floor below a table: the box does not tell which of them it stands on.
  const bool is_within = object.low.z() < landmark.high.z() && object.high.z() > landmark.low.z();
  const Answer is_at_top = Within(std::abs(object.low.z() - landmark.high.z()), kOnTop);
  return Both({is_within ? std::max(is_at_top, Answer::kInDoubt) : is_at_top, is_over});
}

Answer IsIn(const ReferableObject& object, const ReferableObject& landmark) {
  const Eigen::Vector3d middle = Middle(object);
  const bool is_inside = OverhangOf(middle, landmark) < 0 && middle.z() > landmark.low.z() &&
                         middle.z() < landmark.high.z();
  if (!is_inside)
    return OverhangOf(middle, landmark) > 0.02 || middle.z() > landmark.high.z() + 0.05
               ? Answer::kNo
               : Answer::kInDoubt;
  return landmark.has_hollow ? Answer::kYes : Answer::kInDoubt;
}

Answer IsNextTo(const ReferableObject& object, const ReferableObject& landmark) {
  const bool overlaps = object.low.z() < landmark.high.z() && landmark.low.z() < object.high.z();
  const double gap = GapBetween(object, landmark);
  if (!overlaps || gap == 0) return overlaps ? Answer::kInDoubt : Answer::kNo;
  return Within(gap, kBesideGap);
}

bool Fits(const ReferableObject& object, const std::string& noun) {
  return std::ranges::find(object.nouns, noun) != object.nouns.end();
}

constexpr std::array kColourWords = {"black",  "white", "grey", "red",    "orange",
                                     "yellow", "green", "blue", "purple", "pink"};

// Returns the colours that some words name.
std::set<std::string_view> ColoursIn(std::string_view words) {
  std::set<std::string_view> colours;
  while (!words.empty()) {
    const size_t end = std::min(words.find(' '), words.size());
    const auto colour = std::ranges::find(kColourWords, words.substr(0, end));
    if (colour != kColourWords.end()) colours.insert(*colour);
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return colours;
}

// Returns the words of `noun` before `plain`, "red" of "red mug"; unset if it does not end so.
std::optional<std::string_view> BeforeNoun(std::string_view noun, std::string_view plain) {
  if (noun.size() <= plain.size() + 1 || !noun.ends_with(plain)) return std::nullopt;
  const std::string_view before = noun.substr(0, noun.size() - plain.size());
  if (before.back() != ' ') return std::nullopt;
  return before.substr(0, before.size() - 1);
}

// Returns whether people could call an object so. A tea box is a box, and a box may be a tea box; a
// red one is no blue one.
bool MayFit(const ReferableObject& object, const std::string& noun) {
  std::set<std::string_view> own;
  for (const std::string& each : object.nouns) own.merge(ColoursIn(each));
  return std::ranges::any_of(object.nouns, [&](const std::string& each) {
    if (each == noun || BeforeNoun(each, noun)) return true;
    const std::optional<std::string_view> said = BeforeNoun(noun, each);
    if (!said) return false;
    const std::set<std::string_view> colours = ColoursIn(*said);
    return own.empty() || colours.empty() ||
           std::ranges::any_of(colours, [&](const auto& colour) { return own.contains(colour); });
  });
}

// Returns the words in lower case, without an article: "RemoteControl" gives "remote control".
std::string Plain(const std::string& text) {
  std::string words;
  for (const char c : text) {
    const bool is_upper = c >= 'A' && c <= 'Z';
    if (is_upper && !words.empty() && words.back() >= 'a' && words.back() <= 'z') words += ' ';
    words += c == '_' ? ' ' : is_upper ? static_cast<char>(c - 'A' + 'a') : c;
  }
  for (const std::string_view article : {"the ", "a ", "an "}) {
    if (words.starts_with(article)) return words.substr(article.size());
  }
  return words;
}

// The colour of a shape in a word; "" for what people would call in different ways.
std::string ColourWord(const Vec4& rgba) {
  const auto [low, high] = std::minmax({rgba[0], rgba[1], rgba[2]});
  if (high < 0.15) return "black";
  if (high - low < 0.1) return low > 0.85 ? "white" : high < 0.7 && low > 0.3 ? "grey" : "";
  if ((high - low) / high < 0.5 || high < 0.4) return "";
  double hue = 0;
  if (high == rgba[0])
    hue = 60 * (rgba[1] - rgba[2]) / (high - low);
  else if (high == rgba[1])
    hue = 120 + 60 * (rgba[2] - rgba[0]) / (high - low);
  else
    hue = 240 + 60 * (rgba[0] - rgba[1]) / (high - low);
  if (hue < 0) hue += 360;
  struct Range {
    double from, to;
    const char* word;
  };
  static constexpr Range kWords[] = {{0, 12, "red"},       {348, 360, "red"},  {22, 42, "orange"},
                                     {48, 66, "yellow"},   {85, 155, "green"}, {200, 250, "blue"},
                                     {265, 295, "purple"}, {305, 335, "pink"}};
  for (const Range& range : kWords) {
    if (hue >= range.from && hue <= range.to) return range.word;
  }
  return "";
}

// The expressions for one object.
class Expressions {
 public:
  Expressions(std::span<const ReferableObject> objects, const ReferableObject& meant,
              const Viewer& viewer)
      : objects_(objects), meant_(meant), viewer_(viewer), axes_(viewer) {}

  std::vector<std::string> All() && {
    for (const std::string& noun : meant_.nouns) {
      if (IsUnique(meant_, noun)) Add("the " + noun);
    }
    for (const SeenRelation relation : {SeenRelation::kOn, SeenRelation::kIn}) AddRelated(relation);
    for (const SeenRelation relation :
         {SeenRelation::kLeftOf, SeenRelation::kRightOf, SeenRelation::kInFrontOf,
          SeenRelation::kBehind, SeenRelation::kNextTo})
      AddRelated(relation);
    const auto to_the_left = [this](const Eigen::Vector3d& at) { return at.dot(axes_.left); };
    const auto away = [this](const Eigen::Vector3d& at) {
      return (at - viewer_.position).head<2>().norm();
    };
    AddOrdered("leftmost", [&](const auto& at) { return -to_the_left(at); });
    AddOrdered("rightmost", to_the_left);
    AddOrdered("nearest", away);
    AddOrdered("farthest", [&](const auto& at) { return -away(at); });
    return std::move(found_);
  }

 private:
  void Add(const std::string& expression) {
    if (found_.size() < kMostExpressions && std::ranges::find(found_, expression) == found_.end())
      found_.push_back(expression);
  }
  // True if a noun could mean no other object.
  bool IsUnique(const ReferableObject& object, const std::string& noun) const {
    return std::ranges::none_of(objects_, [&](const ReferableObject& other) {
      return &other != &object && MayFit(other, noun);
    });
  }
  // Returns the plainest noun that only this landmark has; "" without one.
  std::string NounOf(const ReferableObject& landmark) const {
    for (const std::string& noun : landmark.nouns) {
      if (IsUnique(landmark, noun)) return noun;
    }
    return "";
  }
  void AddRelated(SeenRelation relation) {
    std::vector<const ReferableObject*> landmarks;
    for (const ReferableObject& other : objects_) {
      if (&other != &meant_ && Holds(relation, meant_, other, viewer_) == Answer::kYes)
        landmarks.push_back(&other);
    }
    std::ranges::stable_sort(landmarks, {}, [&](const ReferableObject* landmark) {
      return (Middle(*landmark) - Middle(meant_)).norm();
    });
    for (const ReferableObject* landmark : landmarks) {
      const std::string noun = NounOf(*landmark);
      if (noun.empty()) continue;
      for (const std::string& own : meant_.nouns) {
        const bool is_clear = std::ranges::all_of(objects_, [&](const ReferableObject& other) {
          return &other == &meant_ || &other == landmark || !MayFit(other, own) ||
                 Holds(relation, other, *landmark, viewer_) == Answer::kNo;
        });
        if (!is_clear) continue;
        Add(fmt::format("the {} {} the {}", own, WordsOf(relation), noun));
        break;
      }
    }
  }
  // `measure` of a place, m, is least for the object that is meant.
  template <class F>
  void AddOrdered(const char* word, const F& measure) {
    for (const std::string& noun : meant_.nouns) {
      int others = 0;
      const bool is_first = std::ranges::all_of(objects_, [&](const ReferableObject& other) {
        if (&other == &meant_ || !MayFit(other, noun)) return true;
        ++others;
        return (Middle(meant_) - Middle(other)).norm() <= kGroup &&
               measure(Middle(other)) - measure(Middle(meant_)) >= kApart;
      });
      if (!is_first || others == 0) continue;
      return Add(fmt::format("the {} {}", word, noun));
    }
  }

  std::span<const ReferableObject> objects_;
  const ReferableObject& meant_;
  Viewer viewer_;
  Axes axes_;
  std::vector<std::string> found_;
};

}  // namespace

Answer Holds(SeenRelation relation, const ReferableObject& object, const ReferableObject& landmark,
             const Viewer& viewer) {
  const Axes axes(viewer);
  switch (relation) {
    case SeenRelation::kOn:
      return IsOn(object, landmark);
    case SeenRelation::kIn:
      return IsIn(object, landmark);
    case SeenRelation::kLeftOf:
      return IsTowards(object, landmark, axes.left, axes.ahead);
    case SeenRelation::kRightOf:
      return IsTowards(object, landmark, -axes.left, axes.ahead);
    case SeenRelation::kInFrontOf:
      return IsTowards(object, landmark, -axes.ahead, axes.left);
    case SeenRelation::kBehind:
      return IsTowards(object, landmark, axes.ahead, axes.left);
    case SeenRelation::kNextTo:
      break;
  }
  return IsNextTo(object, landmark);
}

std::string WordsOf(SeenRelation relation) {
  static constexpr std::array kWords = {"on",          "in",     "left of", "right of",
                                        "in front of", "behind", "next to"};
  return kWords[static_cast<size_t>(relation)];
}

std::vector<ReferableObject> ReferableObjects(const Scene& scene,
                                              std::span<const ObjectWords> known,
                                              std::span<const Container> containers) {
  scene.SyncPoses();
  const mjModel* m = scene.model();
  std::vector<ReferableObject> objects;
  const auto add = [&](const ObjectWords& words, int body, const std::string& colour) {
    const std::vector<bool> own = internal::SubtreeMask(m, body);
    const auto box = BoxOf(scene, own);
    if (!box) return;
    ReferableObject object{.object = words.object, .nouns = {}, .low = box->low, .high = box->high};
    const auto add_noun = [&](const std::string& text) {
      const std::string noun = Plain(text);
      if (!noun.empty() && !Fits(object, noun)) object.nouns.push_back(noun);
    };
    add_noun(words.category);
    for (const std::string& each : words.words) add_noun(each);
    if (object.nouns.empty()) return;
    if (!colour.empty()) add_noun(colour + " " + object.nouns.front());
    object.has_hollow = std::ranges::any_of(containers, [&](const Container& container) {
      const int id = FindId(m, mjOBJ_BODY, container.body);
      return id >= 0 && own[static_cast<size_t>(id)];
    });
    objects.push_back(std::move(object));
  };
  const std::vector<std::string> present = scene.object_names();
  for (const SceneObject& object : scene.spec().objects) {
    if (std::ranges::find(present, object.name) == present.end()) continue;
    const auto given = std::ranges::find(known, object.name, &ObjectWords::object);
    const bool has_colour = object.mjcf_path.empty() && object.rgba;
    add(given == known.end() ? WordsOf(object) : *given,
        RequireId(m, mjOBJ_BODY, scene.compiled()->object(object.name).root_body, ""),
        has_colour ? ColourWord(*object.rgba) : "");
  }
  for (const ObjectWords& words : known) {
    const int body = FindId(m, mjOBJ_BODY, words.object);
    if (body > 0 &&
        std::ranges::find(objects, words.object, &ReferableObject::object) == objects.end())
      add(words, body, "");
  }
  return objects;
}

std::vector<std::string> ReferralsTo(std::span<const ReferableObject> objects,
                                     const std::string& object, const Viewer& viewer) {
  const auto meant = std::ranges::find(objects, object, &ReferableObject::object);
  if (meant != objects.end()) return Expressions(objects, *meant, viewer).All();
  std::vector<std::string> names;
  for (const ReferableObject& each : objects) names.push_back(each.object);
  throw NotFoundError(NoSuchName("", "object with words", object, names));
}

}  // namespace robocell
