#include "robocell/scenes/randomization.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/base/name_pattern.h"
#include "robocell/base/suggestions.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/made_texture.h"
#include "robocell/spec/pinned_values.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

bool IsTextureFile(std::string_view word) { return word.ends_with(".png"); }

std::string FileOfTexture(const std::string& directory, const std::string& word) {
  return (fs::path(directory) / word).lexically_normal().string();
}

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

double MassOf(const mjModel* m, const RandomizedTarget& target) {
  double mass = 0;
  for (const int b : target.bodies) mass += m->body_mass[b];
  return mass;
}

bool HasMaterial(const RandomLook& look) {
  const bool can_be_own = std::ranges::find(look.texture, kOwnTexture) != look.texture.end();
  return look.specular || look.shininess || look.reflectance ||
         (!look.texture.empty() && !can_be_own);
}

// Returns the targets whose drawn look needs a material of the studio.
std::vector<std::string> TargetsWithMaterial(const RandomizedValues& values) {
  std::set<std::string> targets;
  for (const auto& [name, value] : values.entries()) {
    const size_t slash = name.rfind('/');
    if (!IsLookName(name)) continue;
    const std::string_view property = std::string_view(name).substr(slash + 1);
    if (property.starts_with("colour") || property == "texture_seed" ||
        (property == "texture" && value->word == kOwnTexture))
      continue;
    targets.insert(name.substr(0, slash));
  }
  return {targets.begin(), targets.end()};
}

// Returns the lights of a pinned or drawn number.
int CountOf(double number, int most) {
  return static_cast<int>(std::lround(std::clamp(number, 0.0, static_cast<double>(most))));
}

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
  std::set<std::string> with_material;
  for (const auto& [pattern, look] : config_.appearance.entries()) {
    model_.targets().RequireMatch(pattern, others, where("appearance"));
    for (const std::string& word : TexturesOf(look->texture)) {
      if (IsTextureFile(word)) RequirePng(FileOfTexture(options_.directory, word));
    }
    if (!HasMaterial(*look)) continue;
    for (const std::string& name : model_.targets().Matching(pattern)) with_material.insert(name);
  }
  for (const std::string& name : config_.pinned.keys()) {
    const RandomizedValue& value = config_.pinned.at(name);
    if (IsLookName(name) && name.ends_with("/texture") && IsTextureFile(value.word))
      RequirePng(FileOfTexture(options_.directory, value.word));
    if (name.starts_with("clutter/") && name.ends_with("/kind") && !IsObjectKind(value.word))
      throw NotFoundError(
          NoSuchName(where("pinned") + "." + name, "kind", value.word, ObjectKinds()));
  }
  if (const std::vector<std::string> without =
          model_.WithoutMaterials({with_material.begin(), with_material.end()});
      !without.empty()) {
    throw ArgumentError(fmt::format(
        "{}: there are materials for 14 solid parts, and for 6 planes and meshes with texture "
        "coordinates, and none are left for {}. Give looks to fewer targets, or `colour` alone, "
        "which needs none",
        where("appearance"), ListNames(without)));
  }
  for (const auto& [pattern, physics] : config_.dynamics.entries()) {
    model_.targets().RequireMatch(pattern, others, where("dynamics"));
    const std::vector<std::string> names = model_.targets().Matching(pattern);
    // A name needs the property, and a group of targets one that has it, perhaps in another start.
    const bool is_group = IsNamePattern(pattern) || pattern == "objects" || pattern == "robots";
    if (names.empty() || (is_group && !others.empty())) continue;
    const std::string& key = pattern;
    const auto require = [&](bool is_given, const char* field, const char* what, const auto& has) {
      if (!is_given) return;
      for (const std::string& name : names) {
        if (has(model_.targets().At(name, where("dynamics")))) return;
      }
      throw ArgumentError(fmt::format("{}.{}.{}: {} {}; leave it out", where("dynamics"), key,
                                      field, is_group ? "no target has" : "it has no", what));
    };
    const auto has_mass = [&](const RandomizedTarget& target) {
      return MassOf(model_.model(), target) > 0;
    };
    require(physics->mass.has_value(), "mass", "mass", has_mass);
    require(physics->inertia.has_value(), "inertia", "mass", has_mass);
    require(physics->damping.has_value(), "damping", "hinges or slides",
            [](const RandomizedTarget& target) { return !target.dofs.empty(); });
    require(physics->gain.has_value(), "gain", "servos",
            [](const RandomizedTarget& target) { return !target.servos.empty(); });
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

// Folders are listed once, so that all draws choose from the same files.
const std::vector<std::string>& Randomization::TexturesOf(const std::vector<std::string>& named) {
  const auto [known, is_new] = textures_.try_emplace(named);
  if (is_new) {
    try {
      known->second = TextureWords(named, options_.directory, options_.place);
    } catch (...) {
      textures_.erase(known);
      throw;
    }
  }
  return known->second;
}

// Returns the number of lights that shine.
int Randomization::DrawLights(Drawing& drawing) const {
  const RandomizedValue* pinned = config_.pinned.find("light/number");
  const bool is_pinned = pinned && !pinned->numbers.empty();
  int count =
      is_pinned ? CountOf(pinned->numbers.front(), RandomLights::kMost) : model_.own_lights();
  if (!config_.lights) return count;
  const RandomLights& lights = *config_.lights;
  drawing.Maybe("light/ambient", lights.ambient);
  if (lights.number)
    count = CountOf(drawing.Number("light/number", *lights.number), RandomLights::kMost);
  const bool is_new = lights.number || is_pinned;
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
    const bool has_mass = MassOf(model_.model(), target) > 0;
    if (physics.mass && has_mass) drawing.Property(name + "/mass", *physics.mass);
    if (physics.inertia && has_mass) drawing.Property(name + "/inertia", *physics.inertia);
    if (physics.friction) drawing.Property(name + "/friction", *physics.friction);
    if (physics.damping && !target.dofs.empty())
      drawing.Property(name + "/damping", *physics.damping);
    if (physics.gain && !target.servos.empty()) drawing.Property(name + "/gain", *physics.gain);
  }
}

// Starts have other objects than the validated one: a look without room is left out of the start and
// of its values, and the run goes on.
void Randomization::DropLooksWithoutMaterial() {
  const std::vector<std::string> without = model_.WithoutMaterials(TargetsWithMaterial(values_));
  if (without.empty()) return;
  std::erase_if(values_.entries(), [&](const auto& entry) {
    const std::string& name = entry.first;
    const size_t slash = name.rfind('/');
    return IsLookName(name) && !std::string_view(name).substr(slash + 1).starts_with("colour") &&
           std::ranges::find(without, name.substr(0, slash)) != without.end();
  });
  LogWarn(fmt::format(
      "{}: no materials are left for the looks of {}, which keep their own; give looks to fewer "
      "targets, or `colour` alone",
      options_.place, ListNames(without)));
}

const RandomizedValues& Randomization::Apply(const Rng& stream, const RandomizedValues& clutter) {
  model_.Restore();
  Drawing drawing(stream, config_.pinned);
  const int lights = DrawLights(drawing);
  if (config_.sky) {
    drawing.Colour("sky/horizon", *config_.sky);
    drawing.Colour("sky/zenith", *config_.sky);
  }
  DrawLooks(drawing);
  DrawDynamics(drawing);
  drawing.Maybe("action_delay", config_.action_delay);
  values_ = drawing.Take([&](const std::string& name) {
    if (const auto light = LightOf(name)) return *light < lights;
    if (name.starts_with("clutter/"))
      return false;  // `clutter` has those of objects that are there
    const size_t slash = name.rfind('/');
    const bool is_of_target =
        slash != std::string::npos && !name.starts_with("light/") && !name.starts_with("sky/");
    return !is_of_target || model_.targets().Has(name.substr(0, slash));
  });
  for (const auto& [name, value] : clutter.entries()) values_[name] = *value;
  DropLooksWithoutMaterial();
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
  if (!config.clutter) return {};
  std::vector<std::string> kinds = KindsToDraw(config.clutter->kinds);
  for (const auto& [name, value] : config.pinned.entries()) {
    if (name.starts_with("clutter/") && name.ends_with("/kind") &&
        std::ranges::find(kinds, value->word) == kinds.end())
      kinds.push_back(value->word);
  }
  return kinds;
}

std::vector<std::string> TextureWords(const std::vector<std::string>& named,
                                      const std::string& directory, const std::string& place) {
  std::vector<std::string> words;
  for (const std::string& name : named) {
    if (name.find('/') == std::string::npos && !IsTextureFile(name)) {
      words.push_back(name);
      continue;
    }
    const fs::path path = fs::path(directory) / name;
    std::error_code error;
    if (IsTextureFile(name) && fs::is_regular_file(path, error)) {
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
          place, name, directory));
    }
    std::ranges::sort(files);
    words.insert(words.end(), files.begin(), files.end());
  }
  return words;
}

std::vector<std::string> TextureFiles(const RandomizeConfig& config, const std::string& directory,
                                      const std::string& place) {
  std::set<std::string> words;
  for (const auto& [pattern, look] : config.appearance.entries()) {
    for (const std::string& word : TextureWords(look->texture, directory, place))
      words.insert(word);
  }
  for (const auto& [name, value] : config.pinned.entries()) {
    if (IsLookName(name)) words.insert(value->word);
  }
  std::vector<std::string> files;
  for (const std::string& word : words) {
    if (IsTextureFile(word)) files.push_back(FileOfTexture(directory, word));
  }
  return files;
}

Clutter DrawClutter(const RandomizeConfig& config, const std::vector<std::string>& needed,
                    const Rng& stream) {
  Clutter clutter;
  if (!config.clutter) return clutter;
  std::vector<std::string> kinds = KindsToDraw(config.clutter->kinds);
  std::erase_if(kinds, [&](const std::string& kind) {
    return std::ranges::find(needed, kind) != needed.end();
  });
  const auto pin = [&](const std::string& name) { return config.pinned.find(name); };
  const RandomNumber usual{.choice = {1, 2, 3}};
  double number =
      Draw(config.clutter->number ? *config.clutter->number : usual, stream.Fork("clutter/number"));
  if (const RandomizedValue* pinned = pin("clutter/number"); pinned && !pinned->numbers.empty())
    number = pinned->numbers.front();
  const int count = kinds.empty() ? 0 : CountOf(number, RandomClutter::kMost);
  clutter.values["clutter/number"].numbers = {static_cast<double>(count)};
  for (int i = 0; i < count; ++i) {
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
