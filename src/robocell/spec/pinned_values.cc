#include "robocell/spec/pinned_values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <system_error>
#include <vector>

#include "robocell/base/suggestions.h"

namespace robocell::internal {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr double kSmallestMass = 1e-9;  // as in `dynamics`
constexpr double kMostSeed = 4294967295.0;

// What a value is, by the last part of its name.
struct Range {
  std::string_view name;
  size_t count = 1;  // of numbers; 0 for a word
  double low = 0, high = kUnbounded;
  bool is_whole = false;
  bool is_look = false;
};

constexpr std::array kOfTargets = {
    Range{.name = "colour", .count = 3, .high = 1, .is_look = true},
    Range{.name = "colour_scale", .count = 3, .is_look = true},
    Range{.name = "specular", .high = 1, .is_look = true},
    Range{.name = "specular_scale", .is_look = true},
    Range{.name = "shininess", .high = 1, .is_look = true},
    Range{.name = "shininess_scale", .is_look = true},
    Range{.name = "reflectance", .high = 1, .is_look = true},
    Range{.name = "reflectance_scale", .is_look = true},
    Range{.name = "texture", .count = 0, .is_look = true},
    Range{.name = "texture_seed", .high = kMostSeed, .is_whole = true, .is_look = true},
    Range{.name = "mass", .low = kSmallestMass},
    Range{.name = "mass_scale", .low = kSmallestMass},
    Range{.name = "inertia_scale", .low = kSmallestMass},
    Range{.name = "friction"},
    Range{.name = "friction_scale"},
    Range{.name = "damping"},
    Range{.name = "damping_scale"},
    Range{.name = "gain_scale"}};
constexpr std::array kOfLights = {
    Range{.name = "azimuth", .low = -360, .high = 360}, Range{.name = "elevation", .high = 90},
    Range{.name = "intensity", .high = 1}, Range{.name = "colour", .count = 3, .high = 1}};
constexpr std::array kOthers = {
    Range{.name = "light/number", .high = RandomLights::kMost, .is_whole = true},
    Range{.name = "light/ambient", .high = 1},
    Range{.name = "sky/horizon", .count = 3, .high = 1},
    Range{.name = "sky/zenith", .count = 3, .high = 1},
    Range{.name = "action_delay"},
    Range{.name = "clutter/number", .high = RandomClutter::kMost, .is_whole = true}};
constexpr std::array kOfClutter = {Range{.name = "kind", .count = 0}};

const Range* Find(const auto& ranges, std::string_view name) {
  const auto found = std::ranges::find(ranges, name, &Range::name);
  return found == ranges.end() ? nullptr : &*found;
}

// Returns "azimuth" for "light/0/azimuth" and `most` = 4; empty for names of another form.
std::string_view AfterIndex(std::string_view name, std::string_view begin, int most) {
  if (!name.starts_with(begin)) return {};
  name.remove_prefix(begin.size());
  int index = -1;
  const char* end = name.data() + name.size();
  const auto [after, error] = std::from_chars(name.data(), end, index);
  if (error != std::errc() || after == end || *after != '/' || index < 0 || index >= most)
    return {};
  return name.substr(static_cast<size_t>(after - name.data()) + 1);
}

bool IsOfTarget(std::string_view name) {
  return name.find('/') != std::string_view::npos && !name.starts_with("light/") &&
         !name.starts_with("sky/") && !name.starts_with("clutter/");
}

const Range* RangeOf(std::string_view name) {
  if (IsOfTarget(name)) return Find(kOfTargets, name.substr(name.rfind('/') + 1));
  if (const Range* other = Find(kOthers, name)) return other;
  // A scene may have more lights of its own than the studio.
  constexpr int kMany = 1000;
  if (const auto property = AfterIndex(name, "light/", kMany); !property.empty())
    return Find(kOfLights, property);
  return Find(kOfClutter, AfterIndex(name, "clutter/", RandomClutter::kMost));
}

std::vector<std::string> KnownNames(std::string_view name) {
  std::vector<std::string> known;
  if (IsOfTarget(name)) {
    const std::string target(name.substr(0, name.rfind('/') + 1));
    for (const Range& each : kOfTargets) known.push_back(target + std::string(each.name));
    return known;
  }
  for (const Range& each : kOthers) known.emplace_back(each.name);
  for (const Range& each : kOfLights) known.push_back("light/0/" + std::string(each.name));
  known.emplace_back("clutter/0/kind");
  known.emplace_back("TARGET/mass_scale");
  return known;
}

std::string FormOf(const Range& range) {
  if (range.count == 0) return "a word";
  const std::string kind = range.is_whole ? "a whole number" : "a number";
  const std::string within = range.high == kUnbounded
                                 ? fmt::format("of at least {:g}", range.low)
                                 : fmt::format("between {:g} and {:.10g}", range.low, range.high);
  return range.count == 1 ? fmt::format("{} {}", kind, within)
                          : fmt::format("red, green and blue, each {} {}", kind, within);
}

bool IsSound(const Range& range, const RandomizedValue& value) {
  if (range.count == 0) return value.numbers.empty() && !value.word.empty();
  return value.word.empty() && value.numbers.size() == range.count &&
         std::ranges::all_of(value.numbers, [&](double x) {
           return x >= range.low && x <= range.high && (!range.is_whole || x == std::floor(x));
         });
}

}  // namespace

bool IsLookName(std::string_view name) {
  const Range* range = IsOfTarget(name) ? RangeOf(name) : nullptr;
  return range && range->is_look;
}

void ValidateTexture(const std::string& texture, std::string_view field, Problems& problems) {
  std::vector<std::string> known = MadeTextures();
  known.emplace_back(kOwnTexture);
  const bool is_file = texture.find('/') != std::string::npos || texture.ends_with(".png");
  if (is_file || std::ranges::find(known, texture) != known.end()) return;
  problems.AddAt(std::string(field),
                 NoSuchName("", "texture", texture, known) +
                     ". A folder of PNG files is written with a slash: ./textures/");
}

void ValidatePinned(const RandomizeConfig& config, Problems& problems) {
  Problems::Scope scope(problems, "pinned");
  for (const auto& [name, value] : config.pinned.entries()) {
    if (value->numbers.empty() == value->word.empty()) continue;  // reported by itself
    const Range* range = RangeOf(name);
    if (!range && RangeOf(name + "_scale")) {
      problems.AddAt(name, fmt::format("is a factor: write '{}_scale'", name));
    } else if (!range) {
      problems.AddAt(name, NoSuchName("", "randomized value", name, KnownNames(name)));
    } else if (!IsSound(*range, *value)) {
      problems.AddAt(name, fmt::format("must be {}; is {}", FormOf(*range),
                                       value->word.empty()
                                           ? fmt::format("[{:g}]", fmt::join(value->numbers, ", "))
                                           : "'" + value->word + "'"));
    } else if (range->name == "texture") {
      ValidateTexture(value->word, name, problems);
    } else if (name.starts_with("clutter/") && !config.clutter) {
      problems.AddAt(
          name, "the block has no clutter: leave the value out, or in a run add `clutter: {}`");
    }
  }
}

std::optional<double> LongestDelay(const RandomizeConfig& config) {
  const RandomizedValue* pinned = config.pinned.find("action_delay");
  if (pinned && !pinned->numbers.empty()) return pinned->numbers.front();
  if (config.action_delay) return config.action_delay->highest();
  return std::nullopt;
}

}  // namespace robocell::internal
