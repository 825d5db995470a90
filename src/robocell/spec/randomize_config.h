// RandomizeConfig: `randomize:` of a run file or an environment: what varies between episodes beside
// the starts of the task: lights, looks, masses, friction, damping, gains, delays and clutter.
//
//   randomize:
//     lights: {number: {choice: [1, 2, 3]}, intensity: {uniform: [0.2, 0.6]}}
//     sky: {uniform: [0.3, 1]}
//     appearance: {floor: {texture: [wood, checker]}, objects: {colour: {scale: {uniform: [0.7, 1.3]}}}}
//     dynamics: {objects: {mass: {scale: {log_uniform: [0.5, 2]}}}, robots: {damping: {scale: 1.2}}}
//     pinned: {light/0/intensity: 0.4}
//
// Values have names, such as `cube/mass_scale`: an episode records them (docs/randomize.md), and
// `pinned` fixes them. scenes/randomization.h draws them, scenes/randomized_model.h applies them.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/types.h"

namespace robocell {

// How often values are drawn.
enum class RandomizeEvery { kEpisode, kScene };
template <>
struct EnumNames<RandomizeEvery> {
  static constexpr std::array kNames = {std::pair{RandomizeEvery::kEpisode, "episode"},
                                        std::pair{RandomizeEvery::kScene, "scene"}};
};

// A number, or the distribution that it is drawn from. In YAML a plain number is `value`.
struct RandomNumber {
  std::optional<double> value = {};
  std::optional<Vec2> uniform = {};
  std::optional<Vec2> log_uniform = {};
  std::vector<double> choice = {};

  static constexpr const char* kTypeName = "RandomNumber";
  template <class V>
  static void Fields(V&& v) {
    v("value", &RandomNumber::value, "Always this number.");
    v("uniform", &RandomNumber::uniform, "Drawn evenly between these two.");
    v("log_uniform", &RandomNumber::log_uniform,
      "Drawn between these two such that its logarithm is uniform: for factors.", Bound::kPositive);
    v("choice", &RandomNumber::choice, "One of these, each as likely.");
  }
  void Validate(Problems& problems) const;

  bool empty() const { return !value && !uniform && !log_uniform && choice.empty(); }
  // Return the smallest and largest number that can be drawn.
  double lowest() const;
  double highest() const;
  // Returns "0.2 to 0.6, uniform", for listings.
  std::string Text() const;
};

// The same for a property that an element has already: absolute, or with `scale` a factor of the
// element's own value.
struct RandomProperty {
  std::optional<double> value = {};
  std::optional<Vec2> uniform = {};
  std::optional<Vec2> log_uniform = {};
  std::vector<double> choice = {};
  Maybe<RandomNumber> scale = {};

  static constexpr const char* kTypeName = "RandomProperty";
  template <class V>
  static void Fields(V&& v) {
    v("value", &RandomProperty::value, "Always this number.");
    v("uniform", &RandomProperty::uniform, "Drawn evenly between these two.");
    v("log_uniform", &RandomProperty::log_uniform,
      "Drawn between these two such that its logarithm is uniform.", Bound::kPositive);
    v("choice", &RandomProperty::choice, "One of these, each as likely.");
    v("scale", &RandomProperty::scale,
      "Factor of the element's own value; instead of the others: {scale: {uniform: [0.8, 1.2]}}.");
  }
  void Validate(Problems& problems) const;

  bool is_scale() const { return scale.has_value(); }
  // Returns the distribution, of the value or of the factor.
  RandomNumber number() const;
  // Returns "x 0.8 to 1.2, uniform".
  std::string Text() const;
};

// Lights. The scene's own ones are varied, or with `number` replaced by so many others.
struct RandomLights {
  Maybe<RandomNumber> number = {};
  Maybe<RandomNumber> azimuth = {};
  Maybe<RandomNumber> elevation = {};
  Maybe<RandomNumber> intensity = {};
  Maybe<RandomNumber> colour = {};
  Maybe<RandomNumber> ambient = {};

  static constexpr int kMost = 4;  // lights of the built-in model `studio`

  static constexpr const char* kTypeName = "RandomLights";
  template <class V>
  static void Fields(V&& v) {
    v("number", &RandomLights::number,
      "Number of lights, 0 to 4, which replace those of the scene. Unset: the scene's lights, each "
      "varied by itself.");
    v("azimuth", &RandomLights::azimuth,
      "Direction from which a light comes, degrees about z from the x axis. Unset: the scene's "
      "own; anywhere for those of `number`.");
    v("elevation", &RandomLights::elevation,
      "Angle above the horizon from which a light comes, degrees. Unset: the scene's own; 30 to 85 "
      "for those of `number`.");
    v("intensity", &RandomLights::intensity,
      "Brightness of a light, 0 to 1. Unset: the scene's own; 0.4 for those of `number`.");
    v("colour", &RandomLights::colour,
      "Factor of red, green and blue each, drawn one by one. Unset: 1.");
    v("ambient", &RandomLights::ambient,
      "Brightness of the light without a direction, 0 to 1. Unset: the scene's own.");
  }
  void Validate(Problems& problems) const;
};

// The look of a target: an object, a robot, or a body or geom of the scene.
struct RandomLook {
  Maybe<RandomProperty> colour = {};
  Maybe<RandomProperty> specular = {};
  Maybe<RandomProperty> shininess = {};
  Maybe<RandomProperty> reflectance = {};
  std::vector<std::string> texture = {};

  static constexpr const char* kTypeName = "RandomLook";
  template <class V>
  static void Fields(V&& v) {
    v("colour", &RandomLook::colour,
      "Red, green and blue, each drawn by itself, 0 to 1; with `scale` factors of each part's own "
      "colour.");
    v("specular", &RandomLook::specular, "Strength of highlights, 0 to 1.");
    v("shininess", &RandomLook::shininess, "Sharpness of highlights, 0 to 1.");
    v("reflectance", &RandomLook::reflectance,
      "Share of light that planes and boxes mirror, 0 to 1; drawn with `quality: high`.");
    v("texture", &RandomLook::texture,
      "One of these: checker, stripes, dots, noise, marble, wood, bricks, gradient; own (as it "
      "is); or a PNG file, or one of the PNG files of a folder.");
  }
  void Validate(Problems& problems) const;
  bool empty() const {
    return !colour && !specular && !shininess && !reflectance && texture.empty();
  }
};

// The physics of a target.
struct RandomDynamics {
  Maybe<RandomProperty> mass = {};
  Maybe<RandomProperty> inertia = {};
  Maybe<RandomProperty> friction = {};
  Maybe<RandomProperty> damping = {};
  Maybe<RandomProperty> gain = {};

  static constexpr const char* kTypeName = "RandomDynamics";
  template <class V>
  static void Fields(V&& v) {
    v("mass", &RandomDynamics::mass,
      "Mass of the whole target, kg. Its inertia changes by the same factor.");
    v("inertia", &RandomDynamics::inertia,
      "Further factor of the rotational inertia: {scale: ...}.");
    v("friction", &RandomDynamics::friction,
      "Sliding friction of its geoms; `scale` is a factor of all three kinds of friction. In a "
      "contact the engine uses the larger friction of the two geoms.");
    v("damping", &RandomDynamics::damping, "Damping of its hinges and slides, N m s/rad or N s/m.");
    v("gain", &RandomDynamics::gain,
      "Factor of stiffness and damping of its servos: {scale: ...}.");
  }
  void Validate(Problems& problems) const;
};

// Objects of the catalogue that the task does not need.
struct RandomClutter {
  Maybe<RandomNumber> number = {};
  NameList kinds = {};

  static constexpr int kMost = 20;

  static constexpr const char* kTypeName = "RandomClutter";
  template <class V>
  static void Fields(V&& v) {
    v("number", &RandomClutter::number, "Number of objects, 0 to 20. Unset: 1 to 3.");
    v("kinds", &RandomClutter::kinds,
      "Kinds and categories of the catalogue. Unset: the default kinds. Kinds of the task's own "
      "objects are left out.");
  }
  void Validate(Problems& problems) const;
};

// A value by its name: numbers, or a word for a texture. In YAML a number, a list or a word.
struct RandomizedValue {
  std::vector<double> numbers = {};
  std::string word = {};

  static constexpr const char* kTypeName = "RandomizedValue";
  template <class V>
  static void Fields(V&& v) {
    v("numbers", &RandomizedValue::numbers, "The number, or red, green and blue.");
    v("word", &RandomizedValue::word, "The texture.");
  }
  void Validate(Problems& problems) const;
};
using RandomizedValues = Map<RandomizedValue>;

struct RandomizeConfig {
  RandomizeEvery every = RandomizeEvery::kEpisode;
  Maybe<RandomLights> lights = {};
  Maybe<RandomNumber> sky = {};
  Map<RandomLook> appearance = {};
  Map<RandomDynamics> dynamics = {};
  Maybe<RandomNumber> action_delay = {};
  Maybe<RandomClutter> clutter = {};
  RandomizedValues pinned = {};

  static constexpr const char* kTypeName = "RandomizeConfig";
  template <class V>
  static void Fields(V&& v) {
    v("every", &RandomizeConfig::every,
      "When values are drawn: for each episode, or once for each scene.");
    v("lights", &RandomizeConfig::lights, "Lights: number, direction, brightness, colour.");
    v("sky", &RandomizeConfig::sky,
      "Red, green and blue of the sky at the horizon and at the zenith, each drawn by itself, 0 to "
      "1. Unset: the scene's own.");
    v("appearance", &RandomizeConfig::appearance,
      "Looks by target: an object, a robot, a body or geom of the scene (`table`, `floor`), with * "
      "and ? for any part of a name; `objects` and `robots` are all of them. A later entry "
      "replaces the same property of an earlier one.");
    v("dynamics", &RandomizeConfig::dynamics, "Physics by target, named in the same way.");
    v("action_delay", &RandomizeConfig::action_delay,
      "Time after which an action takes effect, seconds; at most one policy step.");
    v("clutter", &RandomizeConfig::clutter,
      "Further objects on the support, none of which the task needs. Runs only.");
    v("pinned", &RandomizeConfig::pinned,
      "Values by their names, as episodes record them, that are not drawn: {cube/mass_scale: "
      "1.2}.");
  }
  void Validate(Problems& problems) const;

  // Returns true if scenes need the lights and materials of the model `studio`.
  bool needs_studio() const;
};

// Returns one line for each thing that varies: "light intensity: 0.2 to 0.6, uniform".
std::vector<std::string> Describe(const RandomizeConfig& config);

// The textures that are made, not read: names for RandomLook::texture.
std::vector<std::string> MadeTextures();
inline constexpr const char* kOwnTexture = "own";

}  // namespace robocell
