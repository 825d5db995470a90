#include "robocell/scenes/randomization.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <string>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/io_error.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

RandomizeConfig Read(const std::string& block) { return FromYamlUnchecked<RandomizeConfig>(block); }

Scene Cubes(const RandomizeConfig& config) {
  SceneSpec spec{.timestep = 0.002, .add_floor = true, .add_skybox = true};
  for (const char* name : {"red", "blue"}) {
    spec.objects.push_back({.name = name,
                            .shape = Shape::kBox,
                            .size = Vec3{0.02, 0.02, 0.02},
                            .rgba = Vec4{1, 0, 0, 1},
                            .mass = 0.1,
                            .friction = Vec3{1, 0.005, 0.0001},
                            .pos = Vec3{0, 0, 0.02}});
  }
  if (config.needs_studio()) AddStudio(spec);
  return Scene::Build(spec);
}

const RandomizeConfig& Wide() {
  static const RandomizeConfig config = Read(
      "lights: {number: {choice: [1, 2, 3]}, intensity: {uniform: [0.2, 0.6]}}\n"
      "sky: {uniform: [0.3, 1]}\n"
      "appearance: {objects: {colour: {uniform: [0, 1]}, texture: [wood, own]}, floor: {specular: "
      "0.3}}\n"
      "dynamics: {'*d': {mass: {scale: {log_uniform: [0.25, 4]}}}, objects: {friction: {uniform: "
      "[0.4, 1]}}}\n");
  return config;
}

TEST(Randomization, DrawsWithinTheRangesAndCoversThem) {
  const Scene scene = Cubes(Wide());
  Randomization randomization(Wide(), scene, {.place = "run 'a'"});
  randomization.Validate();
  double least = 1e9, most = 0, below_one = 0;
  constexpr int kStarts = 40;
  for (int i = 0; i < kStarts; ++i) {
    const RandomizedValues& values = randomization.Apply(Rng::Stream(1, i));
    EXPECT_FALSE(values.contains("blue/mass_scale")) << "only '*d' has it";
    const double mass = values.at("red/mass_scale").numbers.front();
    least = std::min(least, mass);
    most = std::max(most, mass);
    below_one += mass < 1 ? 1 : 0;
    for (const auto& [name, value] : values.entries()) {
      if (name.ends_with("/intensity")) {
        EXPECT_GE(value->numbers.front(), 0.2);
        EXPECT_LE(value->numbers.front(), 0.6);
      }
    }
    const int lights = static_cast<int>(values.at("light/number").numbers.front());
    EXPECT_TRUE(values.contains("light/" + std::to_string(lights - 1) + "/azimuth"));
    EXPECT_FALSE(values.contains("light/" + std::to_string(lights) + "/azimuth"));
  }
  EXPECT_GE(least, 0.25);
  EXPECT_LE(most, 4);
  EXPECT_LT(least, 0.4);
  EXPECT_GT(most, 2.5);
  EXPECT_NEAR(below_one / kStarts, 0.5, 0.25) << "a logarithm is uniform: half are below 1";
}

TEST(Randomization, PinningAValueChangesNoOther) {
  const Scene scene = Cubes(Wide());
  const RandomizedValues free = Randomization(Wide(), scene, {}).Apply(Rng::Stream(3));
  RandomizeConfig config = Wide();
  config.pinned["red/mass_scale"].numbers = {1.25};
  config.pinned["blue/friction_scale"].numbers = {0.5};
  const RandomizedValues pinned = Randomization(config, scene, {}).Apply(Rng::Stream(3));
  for (const auto& [name, value] : free.entries()) {
    if (name == "red/mass_scale")
      EXPECT_EQ(pinned.at(name).numbers.front(), 1.25);
    else
      EXPECT_EQ(pinned.at(name), *value) << name;
  }
  EXPECT_EQ(pinned.at("blue/friction_scale").numbers.front(), 0.5) << "pinned without a range";
}

TEST(Randomization, AllValuesOfAStartPinTheWholeStart) {
  const Scene scene = Cubes(Wide());
  Randomization drawn(Wide(), scene, {});
  RandomizeConfig again;
  again.pinned = drawn.Apply(Rng::Stream(5));
  std::vector<mjtNum> masses(scene.model()->body_mass,
                             scene.model()->body_mass + scene.model()->nbody);
  drawn.Restore();
  Randomization replayed(again, scene, {});
  EXPECT_EQ(replayed.Apply(Rng::Stream(77)).keys().size(), again.pinned.keys().size());
  EXPECT_TRUE(std::equal(masses.begin(), masses.end(), scene.model()->body_mass));
}

TEST(Randomization, WhatMeansNothingIsReportedWithTheTargets) {
  const auto validate = [&](const std::string& block, std::vector<std::string> others = {}) {
    const RandomizeConfig config = Read(block);
    const Scene scene = Cubes(config);
    Randomization(config, scene, {.place = "run 'a'"}).Validate(others);
  };
  ExpectThrow<NotFoundError>([&] { validate("dynamics: {reed: {mass: 0.2}}"); },
                             "Did you mean 'red'?");
  EXPECT_NO_THROW(validate("dynamics: {mug: {mass: 0.2}}", {"mug"})) << "another start has it";
  ExpectThrow<ArgumentError>([&] { validate("dynamics: {red: {gain: {scale: 2}}}"); },
                             "dynamics.red.gain: it has no servos");
  ExpectThrow<NotFoundError>([&] { validate("appearance: {red: {texture: [./nowhere/]}}"); },
                             "./nowhere/");
  ExpectThrow<NotFoundError>([&] { validate("clutter: {kinds: [mugg]}"); }, "Did you mean 'mug'?");
  ExpectThrow<NotFoundError>([&] { validate("pinned: {reed/mass: 1}"); }, "Did you mean 'red'?");
}

TEST(Randomization, ObjectsWithoutMassAreLeftOut) {
  const TempDir folder;
  AtomicWrite(folder / "ghost.xml",
              "<mujoco><worldbody><body name='ghost'><geom size='0.1' mass='0' contype='0' "
              "conaffinity='0'/></body></worldbody></mujoco>");
  const RandomizeConfig config =
      Read("dynamics: {objects: {mass: {scale: 2}, inertia: {scale: 2}}}");
  SceneSpec spec{.timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.objects.push_back(
      {.name = "ghost", .mjcf_path = (folder / "ghost.xml").string(), .fixed = true});
  ExpectThrow<ArgumentError>([&] { Randomization(config, Scene::Build(spec), {}).Validate(); },
                             "objects.mass: no target has mass");
  spec.objects.push_back({.name = "cup", .mjcf_path = "mug"});
  const Scene scene = Scene::Build(spec);
  Randomization randomization(config, scene, {});
  randomization.Validate();
  EXPECT_THAT(randomization.Apply(Rng::Stream(1)).keys(),
              ::testing::UnorderedElementsAre("cup/mass_scale", "cup/inertia_scale"));
}

TEST(Randomization, LooksWithoutAMaterialAreRefusedAtOnceAndLeftOutOfStarts) {
  const RandomizeConfig config = Read("appearance: {'b*': {specular: 0.5, colour: 0.5}}");
  SceneSpec spec{.timestep = 0.002, .add_floor = true, .add_skybox = true};
  for (int i = 0; i < 16; ++i) {
    spec.objects.push_back({.name = fmt::format("b{:02}", i),
                            .shape = Shape::kBox,
                            .size = Vec3{0.02, 0.02, 0.02},
                            .rgba = Vec4{1, 0, 0, 1},
                            .mass = 0.1,
                            .friction = Vec3{1, 0.005, 0.0001},
                            .pos = Vec3{0, 0, 0.1 * i}});
  }
  AddStudio(spec);
  const Scene scene = Scene::Build(spec);
  Randomization randomization(config, scene, {.place = "run 'a'"});
  ExpectThrow<ArgumentError>([&] { randomization.Validate(); }, "none are left for b14, b15");
  for (int i = 0; i < 2; ++i) {
    const RandomizedValues& values = randomization.Apply(Rng::Stream(1, i));
    EXPECT_TRUE(values.contains("b13/specular"));
    EXPECT_FALSE(values.contains("b14/specular")) << "what is not shown is not recorded";
    EXPECT_TRUE(values.contains("b15/colour"));
  }
}

TEST(Randomization, APinnedNumberOfLightsCounts) {
  RandomizeConfig config = Read(
      "lights: {intensity: {uniform: [0.2, 0.6]}}\n"
      "pinned: {light/number: 3, light/3/intensity: 0.5}");
  const Scene scene = Cubes(config);
  const RandomizedValues values = Randomization(config, scene, {}).Apply(Rng::Stream(1));
  EXPECT_TRUE(values.contains("light/2/azimuth"));
  EXPECT_FALSE(values.contains("light/3/intensity"));
}

TEST(Randomization, TexturesThatAreNoImagesAreReportedBeforeAnyStart) {
  const TempDir folder;
  AtomicWrite(folder / "oak.png", "no image");
  const RandomizeConfig config = Read("appearance: {red: {texture: [oak.png]}}");
  const Scene scene = Cubes(config);
  ExpectThrow<IoError>(
      [&] { Randomization(config, scene, {.directory = folder.path()}).Validate(); }, "oak.png");
}

TEST(Randomization, PinnedClutterIsRecordedAsItIsPlaced) {
  RandomizeConfig config = Read("clutter: {kinds: [mug, nut]}\npinned: {clutter/0/kind: box}");
  config.pinned["clutter/number"].numbers = {2.7};  // refused in files
  const Clutter clutter = DrawClutter(config, {}, Rng::Stream(2));
  EXPECT_EQ(clutter.values.at("clutter/number").numbers.front(), clutter.objects.size());
  EXPECT_EQ(clutter.kinds.front(), "box");
  EXPECT_THAT(ClutterKinds(config), ::testing::Contains("box")) << "a run keeps its model";
  config.pinned["clutter/9/kind"].word = "nut";
  const Scene scene = Cubes(config);
  EXPECT_FALSE(Randomization(config, scene, {})
                   .Apply(Rng::Stream(1), clutter.values)
                   .contains("clutter/9/kind"));
}

TEST(Randomization, ClutterIsOfOtherKindsThanTheTasks) {
  const RandomizeConfig config = Read("clutter: {number: {choice: [4]}, kinds: [mug, nut, box]}");
  for (int i = 0; i < 10; ++i) {
    const Clutter clutter = DrawClutter(config, {"mug"}, Rng::Stream(2, i));
    ASSERT_EQ(clutter.objects.size(), 4u);
    EXPECT_EQ(clutter.objects[3].name, "clutter_3");
    EXPECT_THAT(clutter.kinds, ::testing::Not(::testing::Contains("mug")));
    EXPECT_EQ(clutter.values.at("clutter/0/kind").word, clutter.kinds.front());
  }
  EXPECT_TRUE(DrawClutter(config, {"mug", "nut", "box"}, Rng::Stream(2)).objects.empty());
}

}  // namespace
}  // namespace robocell::internal
