// RequireSound of scene_annotations.h.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

// A number of annotations: how to set it, how it is called, and what it may be.
struct Number {
  std::string name;
  std::function<void(SceneAnnotations&, double)> set;
  bool may_be_infinite = false;
  bool may_be_negative = true;
};

// One of each entry, all sound.
SceneAnnotations Sound() {
  return {.supports = {{.face = {Pose(), 0.3, 0.4, 0.02}, .body = "table", .free_area = 0.1}},
          .containers = {{.body = "tray", .half_extents = {0.1, 0.1, 0.1}}},
          .articulations = {{.joint = "hinge", .range = {0, 1}}},
          .rooms = {{.name = "hall", .outline = {{0, 0}, {1, 0}, {1, 1}}}},
          .free_floor = {{.half_x = 1, .half_y = 1}},
          .lights = {{.name = "lamp"}}};
}

std::vector<Number> Numbers() {
  using A = SceneAnnotations;
  std::vector<Number> numbers = {
      {"supports[0].face.half_x", [](A& a, double v) { a.supports[0].face.half_x = v; }},
      {"supports[0].face.half_y", [](A& a, double v) { a.supports[0].face.half_y = v; }},
      {"supports[0].face.thickness", [](A& a, double v) { a.supports[0].face.thickness = v; }},
      {"supports[0].free_area", [](A& a, double v) { a.supports[0].free_area = v; }},
      {"free_floor[0].half_x", [](A& a, double v) { a.free_floor[0].half_x = v; }},
      {"free_floor[0].half_y", [](A& a, double v) { a.free_floor[0].half_y = v; }}};
  for (int i = 0; i < 3; ++i) {
    numbers.push_back({"containers[0].half_extents",
                       [i](A& a, double v) { a.containers[0].half_extents[i] = v; }});
  }
  for (Number& size : numbers) size.may_be_negative = false;
  for (int i = 0; i < 2; ++i) {
    numbers.push_back(
        {"articulations[0].range", [i](A& a, double v) { a.articulations[0].range[i] = v; }, true});
    numbers.push_back({"rooms[0].outline", [i](A& a, double v) { a.rooms[0].outline[2][i] = v; }});
  }
  numbers.push_back(
      {"articulations[0].start", [](A& a, double v) { a.articulations[0].start = v; }});
  numbers.push_back({"rooms[0].floor_height", [](A& a, double v) { a.rooms[0].floor_height = v; }});
  for (int i = 0; i < 3; ++i) {
    numbers.push_back(
        {"containers[0].opening", [i](A& a, double v) { a.containers[0].opening[i] = v; }});
    numbers.push_back(
        {"articulations[0].axis", [i](A& a, double v) { a.articulations[0].axis[i] = v; }});
    numbers.push_back(
        {"articulations[0].anchor", [i](A& a, double v) { a.articulations[0].anchor[i] = v; }});
    numbers.push_back({"lights[0].position", [i](A& a, double v) { a.lights[0].position[i] = v; }});
    numbers.push_back(
        {"lights[0].direction", [i](A& a, double v) { a.lights[0].direction[i] = v; }});
  }
  return numbers;
}

// Each component of each number, with each value that a file may bring.
TEST(SoundAnnotations, EachNumberThatCannotBeIsNamed) {
  const double infinity = HUGE_VAL;
  EXPECT_NO_THROW(RequireSound(Sound(), "scene 4"));
  int rejected = 0;
  for (const Number& number : Numbers()) {
    for (const double value : {std::nan(""), infinity, -infinity, -1.0, 0.0}) {
      SceneAnnotations known = Sound();
      number.set(known, value);
      const bool is_sound = !std::isnan(value) &&
                            (std::isfinite(value) || number.may_be_infinite) &&
                            (value >= 0 || number.may_be_negative);
      SCOPED_TRACE(fmt::format("{} = {}", number.name, value));
      if (is_sound) {
        EXPECT_NO_THROW(RequireSound(known, "scene 4"));
        continue;
      }
      ++rejected;
      ExpectThrow<ArgumentError>([&] { RequireSound(known, "scene 4"); },
                                 fmt::format("scene 4: {} is {}; it must be ", number.name, value));
    }
  }
  EXPECT_GT(rejected, 80);
}

TEST(SoundAnnotations, TheWrongEntryOfSeveralIsNamed) {
  SceneAnnotations known = Sound();
  known.supports.push_back(known.supports[0]);
  known.supports[1].face.half_x = -1;
  ExpectThrow<ArgumentError>([&] { RequireSound(known, "scene 4"); },
                             "scene 4: supports[1].face.half_x is -1; it must be at least 0");
}

// Annotations derived from geometry are the oracle.
TEST(SoundAnnotations, DerivedOnesAreSound) {
  for (const char* equipment : {"", "cabinet", "tray"}) {
    SceneSpec spec{.name = "s", .base = "tabletop", .timestep = 0.002, .add_floor = true};
    if (*equipment)
      spec.objects.push_back({.name = equipment, .mjcf_path = equipment, .pos = Vec3{1, 1, 0}});
    const SceneAnnotations derived = DeriveAnnotations(spec);
    EXPECT_FALSE(derived.supports.empty());
    EXPECT_NO_THROW(RequireSound(derived, "scene 0")) << equipment;
  }
}

}  // namespace
}  // namespace robocell
