#include "robocell/scenes/randomization.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/scenes/catalogue.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

constexpr double kSeeds = 4294967296.0;  // of textures

double Draw(const RandomNumber& number, Rng rng) {
  if (number.value) return *number.value;
  if (number.uniform) return rng.Uniform((*number.uniform)[0], (*number.uniform)[1]);
  if (number.log_uniform) {
    const auto [low, high] = *number.log_uniform;
    return std::clamp(std::exp(rng.Uniform(std::log(low), std::log(high))), low, high);
  }
  return number.choice.empty() ? 0 : rng.Choice(number.choice);
}

RandomNumber Uniform(double low, double high) { return {.uniform = Vec2{low, high}}; }
RandomNumber Always(double value) { return {.value = value}; }

// The property that the last entry with it gives a target.
template <class T>
using ByTarget = std::map<std::string, T>;

}  // namespace

// Collects the values of one start.
class Randomization::Drawing {
 public:
  Drawing(const Rng& stream, const RandomizedValues& pinned) : stream_(stream), pinned_(pinned) {}

  // Returns the number, which is pinned or drawn from its own stream.
  double Number(const std::string& name, const RandomNumber& number) {
    RandomizedValue& value = values_[name];
    if (const RandomizedValue* pin = pinned_.find(name)) {
      value = *pin;
      return pin->numbers.empty() ? 0 : pin->numbers.front();
    }
    value.numbers = {Draw(number, stream_.Fork(name))};
    return value.numbers.front();
  }
  void Maybe(const std::string& name, const robocell::Maybe<RandomNumber>& number) {
    if (number) Number(name, *number);
  }
  void Colour(const std::string& name, const RandomNumber& part) {
    RandomizedValue& value = values_[name];
    if (const RandomizedValue* pin = pinned_.find(name)) return void(value = *pin);
    const Rng stream = stream_.Fork(name);
    value.numbers.clear();
    for (const char* channel : {"red", "green", "blue"})
      value.numbers.push_back(Draw(part, stream.Fork(channel)));
  }
  void Property(const std::string& name, const RandomProperty& property) {
    Number(property.is_scale() ? name + "_scale" : name, property.number());
  }
  void Word(const std::string& name, const std::vector<std::string>& words) {
    RandomizedValue& value = values_[name];
    if (const RandomizedValue* pin = pinned_.find(name)) return void(value = *pin);
    Rng rng = stream_.Fork(name);
    value.word = rng.Choice(words);
  }
  // Returns all values, with those that are pinned without a distribution if they are of something
  // that is there.
  template <class IsThere>
  RandomizedValues Take(const IsThere& is_there) {
    for (const auto& [name, value] : pinned_.entries()) {
      if (is_there(name)) values_[name] = *value;
    }
    return std::move(values_);
  }

 private:
  Rng stream_;
  const RandomizedValues& pinned_;
  RandomizedValues values_;
};

Randomization::Randomization(RandomizeConfig config, const Scene& scene, const Options& options)
    : config_(std::move(config)), options_(options), model_(scene, options.directory) {}

void Randomization::Validate(const std::vector<std::string>& others) {
  const auto where = [&](const char* field) { return options_.place + ": randomize." + field; };
  for (const std::string& name : model_.targets().names()) {
    if (name == "light" || name == "sky" || name == "clutter") {
      throw ArgumentError(fmt::format(
          "{}: '{}' is the name of an object, robot, body or geom, and begins the names of other "
          "values; give it another name",
          where("appearance"), name));
    }
  }
  for (const auto& [pattern, look] : config_.appearance.entries()) {
    model_.targets().RequireMatch(pattern, others, where("appearance"));
    TexturesOf(look->texture);
  }
  for (const auto& [pattern, physics] : config_.dynamics.entries()) {
    const auto require = [&](const std::string& target, const char* field, bool has,
                             const char* what) {
      if (has || pattern.find_first_of("*?") != std::string::npos) return;
      throw ArgumentError(fmt::format("{}.{}.{}: '{}' has no {}; leave it out", where("dynamics"),
                                      pattern, field, target, what));
    };
    if (pattern == "objects" || pattern == "robots") continue;
    model_.targets().RequireMatch(pattern, others, where("dynamics"));
    for (const std::string& name : model_.targets().Matching(pattern)) {
      const RandomizedTarget& target = model_.targets().At(name, where("dynamics"));
      if (physics->mass || physics->inertia)
        require(name, "mass", !target.bodies.empty(), "mass: it is a geom of the world");
      if (physics->damping) require(name, "damping", !target.dofs.empty(), "hinges or slides");
      if (physics->gain) require(name, "gain", !target.servos.empty(), "servos");
    }
  }
  for (const std::string& name : config_.pinned.keys()) {
    const size_t slash = name.rfind('/');
    if (slash == std::string::npos || name.starts_with("light/") || name.starts_with("sky/") ||
        name.starts_with("clutter/"))
      continue;
    if (const std::string of = name.substr(0, slash); !model_.targets().Has(of))
      model_.targets().RequireMatch(of, others, where("pinned") + "." + name);
  }
  for (const std::string& kind : ClutterKinds(config_)) {
    if (IsObjectKind(kind)) continue;
    std::vector<std::string> known = ObjectKinds();
    for (const auto& [category, kinds] : ObjectCategories()) known.push_back(category);
    throw NotFoundError(NoSuchName(where("clutter"), "kind", kind, known));
  }
  if (config_.sky && !model_.has_sky()) {
    throw NotFoundError(where("sky") +
                        ": the scene has no sky; add one (add_skybox), or leave it out");
  }
}

// Returns the words to choose from: folders are replaced by their files.
std::vector<std::string> Randomization::TexturesOf(const std::vector<std::string>& named) const {
  std::vector<std::string> words;
  for (const std::string& name : named) {
    const bool is_file = name.ends_with(".png");
    if (name.find('/') == std::string::npos && !is_file) {
      words.push_back(name);
      continue;
    }
    const fs::path path = fs::path(options_.directory) / name;
    std::error_code error;
    if (is_file && fs::is_regular_file(path, error)) {
      words.push_back(name);
      continue;
    }
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(path, error)) {
      if (entry.path().extension() == ".png")
        files.push_back((fs::path(name) / entry.path().filename()).lexically_normal().string());
    }
    if (files.empty()) {
      throw NotFoundError(fmt::format(
          "{}: randomize.appearance: '{}' is not a PNG file, and not a folder with PNG files; "
          "names start at the folder of the file that says so, '{}'",
          options_.place, name, options_.directory));
    }
    std::ranges::sort(files);
    words.insert(words.end(), files.begin(), files.end());
  }
  return words;
}

// Returns the number of lights that shine.
int Randomization::DrawLights(Drawing& drawing) const {
  if (!config_.lights) return model_.own_lights();
  const RandomLights& lights = *config_.lights;
  drawing.Maybe("light/ambient", lights.ambient);
  int count = model_.own_lights();
  if (lights.number)
    count = static_cast<int>(std::lround(drawing.Number("light/number", *lights.number)));
  const bool is_new = lights.number.has_value();
  for (int i = 0; i < count; ++i) {
    const std::string name = fmt::format("light/{}/", i);
    const auto number = [&](const char* what, const robocell::Maybe<RandomNumber>& given,
                            const RandomNumber& otherwise) {
      if (given || is_new) drawing.Number(name + what, given ? *given : otherwise);
    };
    number("azimuth", lights.azimuth, Uniform(-180, 180));
    number("elevation", lights.elevation, Uniform(30, 85));
    number("intensity", lights.intensity, Always(0.4));
    if (lights.colour) drawing.Colour(name + "colour", *lights.colour);
  }
  return count;
}

namespace {

// Returns N for "light/N/intensity"; unset for other names.
std::optional<int> LightOf(const std::string& name) {
  constexpr std::string_view kLight = "light/";
  int number = 0;
  if (!name.starts_with(kLight)) return std::nullopt;
  const char* end = name.data() + name.size();
  const auto [after, error] = std::from_chars(name.data() + kLight.size(), end, number);
  if (error != std::errc() || after == end || *after != '/') return std::nullopt;
  return number;
}

}  // namespace

void Randomization::DrawLooks(Drawing& drawing) {
  ByTarget<RandomLook> looks;
  for (const auto& [pattern, given] : config_.appearance.entries()) {
    for (const std::string& name : model_.targets().Matching(pattern)) {
      RandomLook& look = looks[name];
      if (given->colour) look.colour = given->colour;
      if (given->specular) look.specular = given->specular;
      if (given->shininess) look.shininess = given->shininess;
      if (given->reflectance) look.reflectance = given->reflectance;
      if (!given->texture.empty()) look.texture = given->texture;
    }
  }
  for (const auto& [target, look] : looks) {
    if (look.colour) {
      const bool is_scale = look.colour->is_scale();
      drawing.Colour(target + (is_scale ? "/colour_scale" : "/colour"), look.colour->number());
    }
    if (look.specular) drawing.Property(target + "/specular", *look.specular);
    if (look.shininess) drawing.Property(target + "/shininess", *look.shininess);
    if (look.reflectance) drawing.Property(target + "/reflectance", *look.reflectance);
    if (look.texture.empty()) continue;
    drawing.Word(target + "/texture", TexturesOf(look.texture));
    drawing.Number(target + "/texture_seed", Uniform(0, kSeeds));
  }
}

void Randomization::DrawDynamics(Drawing& drawing) {
  ByTarget<RandomDynamics> all;
  for (const auto& [pattern, given] : config_.dynamics.entries()) {
    for (const std::string& name : model_.targets().Matching(pattern)) {
      RandomDynamics& physics = all[name];
      if (given->mass) physics.mass = given->mass;
      if (given->inertia) physics.inertia = given->inertia;
      if (given->friction) physics.friction = given->friction;
      if (given->damping) physics.damping = given->damping;
      if (given->gain) physics.gain = given->gain;
    }
  }
  for (const auto& [name, physics] : all) {
    const RandomizedTarget& target = model_.targets().At(name, options_.place);
    const bool has_mass = !target.bodies.empty();
    if (physics.mass && has_mass) drawing.Property(name + "/mass", *physics.mass);
    if (physics.inertia && has_mass) drawing.Property(name + "/inertia", *physics.inertia);
    if (physics.friction) drawing.Property(name + "/friction", *physics.friction);
    if (physics.damping && !target.dofs.empty())
      drawing.Property(name + "/damping", *physics.damping);
    if (physics.gain && !target.servos.empty()) drawing.Property(name + "/gain", *physics.gain);
  }
}

const RandomizedValues& Randomization::Apply(const Rng& stream, const RandomizedValues& clutter) {
  Drawing drawing(stream, config_.pinned);
  int lights = DrawLights(drawing);
  if (const RandomizedValue* number = config_.pinned.find("light/number");
      number && !number->numbers.empty())
    lights = static_cast<int>(std::lround(number->numbers.front()));
  if (config_.sky) {
    drawing.Colour("sky/horizon", *config_.sky);
    drawing.Colour("sky/zenith", *config_.sky);
  }
  DrawLooks(drawing);
  DrawDynamics(drawing);
  drawing.Maybe("action_delay", config_.action_delay);
  values_ = drawing.Take([&](const std::string& name) {
    if (const auto light = LightOf(name)) return *light < lights;
    const size_t slash = name.rfind('/');
    const bool is_of_target = slash != std::string::npos && !name.starts_with("light/") &&
                              !name.starts_with("sky/") && !name.starts_with("clutter/");
    return !is_of_target || model_.targets().Has(name.substr(0, slash));
  });
  for (const auto& [name, value] : clutter.entries()) values_[name] = *value;
  // A seed that no texture uses would be a value that explains nothing.
  std::erase_if(values_.entries(), [&](const auto& entry) {
    if (!entry.first.ends_with("/texture_seed")) return false;
    const std::string texture = entry.first.substr(0, entry.first.size() - 5);
    const RandomizedValue* word = values_.find(texture);
    const std::vector<std::string> made = MadeTextures();
    return !word || std::ranges::find(made, word->word) == made.end();
  });
  for (auto& [name, value] : values_.entries()) {
    if (name.ends_with("/texture_seed"))
      for (double& seed : value->numbers) seed = std::floor(seed);
  }
  model_.Apply(values_);
  return values_;
}

std::vector<std::string> ClutterKinds(const RandomizeConfig& config) {
  return config.clutter ? KindsToDraw(config.clutter->kinds) : std::vector<std::string>();
}

Clutter DrawClutter(const RandomizeConfig& config, const std::vector<std::string>& needed,
                    const Rng& stream) {
  Clutter clutter;
  if (!config.clutter) return clutter;
  std::vector<std::string> kinds = ClutterKinds(config);
  std::erase_if(kinds, [&](const std::string& kind) {
    return std::ranges::find(needed, kind) != needed.end();
  });
  const auto pin = [&](const std::string& name) { return config.pinned.find(name); };
  const RandomNumber usual{.choice = {1, 2, 3}};
  double number =
      Draw(config.clutter->number ? *config.clutter->number : usual, stream.Fork("clutter/number"));
  if (const RandomizedValue* pinned = pin("clutter/number"); pinned && !pinned->numbers.empty())
    number = std::clamp(pinned->numbers.front(), 0.0, static_cast<double>(RandomClutter::kMost));
  if (kinds.empty()) number = 0;
  clutter.values["clutter/number"].numbers = {number};
  for (int i = 0; i < static_cast<int>(number); ++i) {
    const std::string name = fmt::format("clutter/{}/kind", i);
    Rng rng = stream.Fork(name);
    std::string kind = rng.Choice(kinds);
    if (const RandomizedValue* pinned = pin(name); pinned && !pinned->word.empty())
      kind = pinned->word;
    clutter.values[name].word = kind;
    clutter.kinds.push_back(kind);
    clutter.objects.push_back(MakeCatalogueObject(kind, fmt::format("clutter_{}", i), rng));
  }
  return clutter;
}

}  // namespace robocell::internal
