#include "robocell/spec/randomize_config.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <type_traits>

#include "robocell/base/suggestions.h"
#include "robocell/spec/pinned_values.h"
#include "robocell/spec/validate.h"

namespace robocell {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

constexpr const char* kForms =
    "write a number, {uniform: [a, b]}, {log_uniform: [a, b]} or {choice: [a, b, c]}";

int CountOf(const RandomNumber& number) {
  return int{number.value.has_value()} + int{number.uniform.has_value()} +
         int{number.log_uniform.has_value()} + int{!number.choice.empty()};
}

void ValidateRanges(const RandomNumber& number, Problems& problems) {
  if (number.uniform) ValidateRange(*number.uniform, "uniform", problems);
  if (number.log_uniform) ValidateRange(*number.log_uniform, "log_uniform", problems);
}

// Reports a distribution that can give a number outside of [low, high].
void ValidateWithin(const RandomNumber& number, double low, double high, std::string_view what,
                    Problems& problems) {
  if (number.empty() || CountOf(number) > 1) return;  // reported by itself
  if (number.lowest() >= low && number.highest() <= high) return;
  const std::string allowed = high == kUnbounded ? fmt::format("at least {:g}", low)
                                                 : fmt::format("between {:g} and {:g}", low, high);
  problems.Add(fmt::format("{} is {}, and this can give {:g}", what, allowed,
                           number.lowest() < low ? number.lowest() : number.highest()));
}

template <class T>
void ValidateWithin(const Maybe<T>& number, const char* field, double low, double high,
                    Problems& problems) {
  if (!number) return;
  Problems::Scope scope(problems, field);
  if constexpr (std::is_same_v<T, RandomProperty>) {
    if (number->is_scale()) {
      Problems::Scope scale(problems, "scale");
      return ValidateWithin(*number->scale, 0, kUnbounded, "a factor", problems);
    }
    ValidateWithin(number->number(), low, high, field, problems);
  } else {
    ValidateWithin(*number, low, high, field, problems);
  }
}

// Reports a distribution of counts that gives broken numbers.
void ValidateWhole(const Maybe<RandomNumber>& number, const char* field, int most,
                   Problems& problems) {
  if (!number) return;
  ValidateWithin(number, field, 0, most, problems);
  std::vector<double> all = number->choice;
  if (number->value) all.push_back(*number->value);
  const bool is_whole = std::ranges::all_of(all, [](double n) { return n == std::floor(n); });
  if (!is_whole || number->uniform || number->log_uniform) {
    problems.AddAt(field, fmt::format("is a count: write {{choice: [0, 1, 2]}}, or one whole "
                                      "number, 0 to {}",
                                      most));
  }
}

// Reports an absolute value where only a factor of the own one makes sense.
void RequireScale(const Maybe<RandomProperty>& property, const char* field, const char* why,
                  Problems& problems) {
  if (!property || property->is_scale()) return;
  problems.AddAt(field, fmt::format("is a factor, because {}: write {{scale: {{uniform: [0.8, "
                                    "1.2]}}}}",
                                    why));
}

void Add(std::vector<std::string>& lines, const std::string& what,
         const Maybe<RandomNumber>& number) {
  if (number) lines.push_back(what + ": " + number->Text());
}

void Add(std::vector<std::string>& lines, const std::string& what,
         const Maybe<RandomProperty>& property) {
  if (property) lines.push_back(what + ": " + property->Text());
}

}  // namespace

void RandomNumber::Validate(Problems& problems) const {
  if (CountOf(*this) != 1) {
    problems.Add(fmt::format(
        "{}; {}", empty() ? "is empty" : "has several distributions; keep one of them", kForms));
  }
  ValidateRanges(*this, problems);
}

double RandomNumber::lowest() const {
  if (value) return *value;
  if (uniform) return (*uniform)[0];
  if (log_uniform) return (*log_uniform)[0];
  return choice.empty() ? 0 : *std::ranges::min_element(choice);
}

double RandomNumber::highest() const {
  if (value) return *value;
  if (uniform) return (*uniform)[1];
  if (log_uniform) return (*log_uniform)[1];
  return choice.empty() ? 0 : *std::ranges::max_element(choice);
}

std::string RandomNumber::Text() const {
  if (value) return fmt::format("{:g}", *value);
  if (uniform) return fmt::format("{:g} to {:g}, uniform", (*uniform)[0], (*uniform)[1]);
  if (log_uniform) {
    return fmt::format("{:g} to {:g}, log-uniform", (*log_uniform)[0], (*log_uniform)[1]);
  }
  return fmt::format("one of {:g}", fmt::join(choice, ", "));
}

void RandomProperty::Validate(Problems& problems) const {
  const int own = CountOf({value, uniform, log_uniform, choice});
  if (own + int{is_scale()} != 1) {
    problems.Add(fmt::format(
        "{}; {}, or the same as {{scale: ...}}, a factor of the own value",
        own + int{is_scale()} == 0 ? "is empty" : "has several distributions; keep one of them",
        kForms));
  }
  ValidateRanges({value, uniform, log_uniform, choice}, problems);
}

RandomNumber RandomProperty::number() const {
  return scale ? *scale : RandomNumber{value, uniform, log_uniform, choice};
}

std::string RandomProperty::Text() const { return (is_scale() ? "x " : "") + number().Text(); }

void RandomLights::Validate(Problems& problems) const {
  ValidateWhole(number, "number", kMost, problems);
  ValidateWithin(azimuth, "azimuth", -360, 360, problems);
  ValidateWithin(elevation, "elevation", 0, 90, problems);
  ValidateWithin(intensity, "intensity", 0, 1, problems);
  ValidateWithin(colour, "colour", 0, 1, problems);
  ValidateWithin(ambient, "ambient", 0, 1, problems);
}

void RandomLook::Validate(Problems& problems) const {
  ValidateWithin(colour, "colour", 0, 1, problems);
  ValidateWithin(specular, "specular", 0, 1, problems);
  ValidateWithin(shininess, "shininess", 0, 1, problems);
  ValidateWithin(reflectance, "reflectance", 0, 1, problems);
  for (size_t i = 0; i < texture.size(); ++i)
    internal::ValidateTexture(texture[i], fmt::format("texture[{}]", i), problems);
}

void RandomDynamics::Validate(Problems& problems) const {
  constexpr double kSmallest = 1e-9;
  ValidateWithin(mass, "mass", kSmallest, kUnbounded, problems);
  RequireScale(inertia, "inertia", "each body has three moments of inertia", problems);
  ValidateWithin(friction, "friction", 0, kUnbounded, problems);
  ValidateWithin(damping, "damping", 0, kUnbounded, problems);
  RequireScale(gain, "gain", "servos differ in size", problems);
  // The engine needs positive masses and inertias.
  for (const auto& [property, field] : {std::pair{&mass, "mass"}, std::pair{&inertia, "inertia"}}) {
    if (*property && (*property)->is_scale() && (*property)->scale->lowest() <= 0 &&
        CountOf(*(*property)->scale) == 1)
      problems.AddAt(field, "its factor is above 0");
  }
}

void RandomClutter::Validate(Problems& problems) const {
  ValidateWhole(number, "number", kMost, problems);
}

void RandomizedValue::Validate(Problems& problems) const {
  if (numbers.empty() == word.empty())
    problems.Add("is a number, a list of numbers or a word, as an episode records it");
}

void RandomizeConfig::Validate(Problems& problems) const {
  if (sky) ValidateWithin(sky, "sky", 0, 1, problems);
  ValidateWithin(action_delay, "action_delay", 0, kUnbounded, problems);
  for (const auto& [target, look] : appearance.entries()) {
    if (!look->empty()) continue;
    Problems::Scope scope(problems, "appearance");
    problems.AddAt(target, "is empty; give it a colour, a texture, or leave it out");
  }
  internal::ValidatePinned(*this, problems);
}

bool RandomizeConfig::needs_studio() const {
  // Pinned values may be of looks too, and of lights; those of physics end otherwise.
  const auto is_shown = [](const std::string& name) {
    constexpr std::string_view kPhysics[] = {"/mass",          "/mass_scale",     "/inertia_scale",
                                             "/friction",      "/friction_scale", "/damping",
                                             "/damping_scale", "/gain_scale"};
    return name != "action_delay" && !name.starts_with("clutter/") &&
           std::ranges::none_of(kPhysics,
                                [&](std::string_view end) { return name.ends_with(end); });
  };
  return (lights && lights->number) || !appearance.empty() ||
         std::ranges::any_of(pinned.keys(), is_shown);
}

std::vector<std::string> Describe(const RandomizeConfig& config) {
  std::vector<std::string> lines;
  if (config.lights) {
    const RandomLights& lights = *config.lights;
    Add(lines, "number of lights", lights.number);
    Add(lines, "light azimuth, degrees", lights.azimuth);
    Add(lines, "light elevation, degrees", lights.elevation);
    Add(lines, "light intensity", lights.intensity);
    Add(lines, "light colour", lights.colour);
    Add(lines, "ambient light", lights.ambient);
  }
  Add(lines, "sky", config.sky);
  for (const auto& [target, look] : config.appearance.entries()) {
    Add(lines, target + ": colour", look->colour);
    Add(lines, target + ": specular", look->specular);
    Add(lines, target + ": shininess", look->shininess);
    Add(lines, target + ": reflectance", look->reflectance);
    if (!look->texture.empty())
      lines.push_back(target + ": texture: one of " + ListNames(look->texture));
  }
  for (const auto& [target, physics] : config.dynamics.entries()) {
    Add(lines, target + ": mass", physics->mass);
    Add(lines, target + ": inertia", physics->inertia);
    Add(lines, target + ": friction", physics->friction);
    Add(lines, target + ": damping", physics->damping);
    Add(lines, target + ": gain", physics->gain);
  }
  Add(lines, "action delay, s", config.action_delay);
  if (config.clutter) {
    const std::string number =
        config.clutter->number ? config.clutter->number->Text() : std::string("one of 1, 2, 3");
    lines.push_back("clutter objects: " + number);
  }
  if (!config.pinned.empty()) lines.push_back("pinned: " + ListNames(config.pinned.keys()));
  return lines;
}

std::vector<std::string> MadeTextures() {
  return {"checker", "stripes", "dots", "noise", "marble", "wood", "bricks", "gradient"};
}

}  // namespace robocell
