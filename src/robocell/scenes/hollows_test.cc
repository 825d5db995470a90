#include "robocell/scenes/hollows.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/files.h"
#include "robocell/mujoco/names.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

// A box of boards, 0.4 m wide and deep and 0.2 m high, open on one side.
Scene BoxOfBoards(bool front, bool top) {
  std::string text =
      "<mujoco><worldbody><body name='box'>"
      "<geom type='box' size='.2 .2 .005' pos='0 0 .005'/>"
      "<geom type='box' size='.2 .005 .09' pos='0 .195 .1'/>"
      "<geom type='box' size='.2 .005 .09' pos='0 -.195 .1'/>"
      "<geom type='box' size='.005 .19 .09' pos='-.195 0 .1'/>";
  if (front) text += "<geom type='box' size='.005 .19 .09' pos='.195 0 .1'/>";
  if (top) text += "<geom type='box' size='.2 .2 .005' pos='0 0 .195'/>";
  const TempDir folder;
  AtomicWrite(folder / "box.xml", text + "</body></worldbody></mujoco>");
  Scene scene = Scene::Build({.name = "box", .base = (folder / "box.xml").string()});
  scene.Reset();
  return scene;
}

std::optional<Hollow> HollowOf(const Scene& scene) {
  return FindHollow(scene, FindId(scene.model(), mjOBJ_BODY, "box"));
}

TEST(Hollow, OfAnOpenBoxIsTheSpaceBetweenItsBoards) {
  const auto hollow = HollowOf(BoxOfBoards(true, false));
  ASSERT_TRUE(hollow);
  EXPECT_NEAR(hollow->opening.z(), 1, 1e-9);
  EXPECT_NEAR(hollow->half_extents[0], 0.19, 0.03);  // the grid's width
  EXPECT_NEAR(hollow->half_extents[1], 0.19, 0.03);
  EXPECT_NEAR(2 * hollow->half_extents[2], 0.18, 1e-6);
  EXPECT_NEAR(hollow->middle.z(), 0.1, 1e-6);
}

TEST(Hollow, OfAShelfOpensToItsFront) {
  const auto hollow = HollowOf(BoxOfBoards(false, true));
  ASSERT_TRUE(hollow);
  EXPECT_NEAR(hollow->opening.x(), 1, 1e-9);
}

TEST(Hollow, ClosedBoxesHaveNone) { EXPECT_FALSE(HollowOf(BoxOfBoards(true, true))); }

TEST(Hollow, BoxesWithoutAWallHaveNone) { EXPECT_FALSE(HollowOf(BoxOfBoards(false, false))); }

}  // namespace
}  // namespace robocell::internal
