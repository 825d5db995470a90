// RequireSound of scene_annotations.h.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "robocell/base/error.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

TEST(SoundAnnotations, NumbersThatCannotBeAreNamed) {
  const double nan = std::nan(""), infinity = HUGE_VAL;
  const auto expect = [&](const SceneAnnotations& known, const std::string& said) {
    ExpectThrow<ArgumentError>([&] { RequireSound(known, "scene 4"); }, "scene 4: " + said);
  };
  const SupportFace good{.face = {Pose(), 0.3, 0.4, 0.02}};
  SupportFace bad = good;
  bad.face.half_x = nan;
  expect({.supports = {good, bad}}, "supports[1].face.half_x is nan; it must be finite");
  bad.face.half_x = -1;
  expect({.supports = {bad}}, "supports[0].face.half_x is -1; it must be at least 0");
  expect({.containers = {{.body = "tray", .half_extents = {0.1, nan, 0.1}}}},
         "containers[0].half_extents is nan");
  expect({.containers = {{.body = "tray", .opening = {0, 0, infinity}}}},
         "containers[0].opening is inf");
  expect({.articulations = {{.range = {nan, 1}}}}, "articulations[0].range is nan; it must be a");
  expect({.articulations = {{.axis = {nan, 0, 0}}}}, "articulations[0].axis is nan");
  expect({.articulations = {{.anchor = {nan, 0, 0}}}}, "articulations[0].anchor is nan");
  expect({.articulations = {{.start = infinity}}}, "articulations[0].start is inf");
  expect({.rooms = {{.name = "a"}, {.name = "b", .outline = {{0, nan}}}}},
         "rooms[1].outline is nan");
  expect({.rooms = {{.name = "a", .floor_height = nan}}}, "rooms[0].floor_height is nan");
  expect({.free_floor = {{.half_y = infinity}}}, "free_floor[0].half_y is inf");
  expect({.lights = {{.direction = {0, nan, 0}}}}, "lights[0].direction is nan");
  const SceneAnnotations endless{.supports = {good},
                                 .articulations = {{.range = {-infinity, infinity}}}};
  EXPECT_NO_THROW(RequireSound(endless, "scene 4")) << "a joint may have no limits";
}

}  // namespace
}  // namespace robocell
