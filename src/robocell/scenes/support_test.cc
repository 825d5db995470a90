#include "robocell/scenes/support.h"

#include <gtest/gtest.h>

#include <numbers>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

// A scene with a body "table" at (1, 2, 0.5) that contains `inside`.
Support SupportOf(const std::string& inside) {
  TempDir folder;
  AtomicWrite(folder / "table.xml", "<mujoco><worldbody><body name='table' pos='1 2 .5'>" + inside +
                                        "</body></worldbody></mujoco>");
  SceneSpec spec{.name = "s", .timestep = 0.002, .add_floor = false, .add_skybox = false};
  spec.base = (folder / "table.xml").string();
  return FindSupport(spec);
}

void ExpectRefused(const std::string& inside, const std::string& why) {
  ExpectThrow<SpecError>([&] { SupportOf(inside); }, why);
}

TEST(Support, IsTheBoxUnderTheSiteInTheBoxsPose) {
  const Support s = SupportOf(
      "<geom type='box' size='.3 .2 .01' pos='.1 .05 -.01' euler='0 0 30'/>"
      "<site name='table_top' pos='.12 .06 0'/>");
  EXPECT_TRUE(s.frame_to_world.is_close(
      Pose::FromRpy({1.1, 2.05, 0.5}, {0, 0, std::numbers::pi / 6}), 1e-9, 1e-9));
  EXPECT_DOUBLE_EQ(s.half_x, 0.3);
  EXPECT_DOUBLE_EQ(s.half_y, 0.2);
  EXPECT_DOUBLE_EQ(s.thickness, 0.02);
}

TEST(Support, MayBeABoxThatLiesOnItsSide) {
  const Support s = SupportOf(
      "<geom type='box' size='.01 .2 .3' pos='0 0 -.01' euler='0 90 0'/><site "
      "name='a_table_top'/>");
  EXPECT_NEAR(s.frame_to_world.translation().z(), 0.5, 1e-9);
  EXPECT_DOUBLE_EQ(s.half_x, 0.3);
  EXPECT_DOUBLE_EQ(s.half_y, 0.2);
  EXPECT_NEAR(s.frame_to_world.rotation()(2, 2), 1, 1e-9);
}

TEST(Support, ThatTheSiteIsNotOnIsRefused) {
  const std::string site = "<site name='table_top'/>";
  ExpectRefused("<geom type='box' size='.3 .2 .01' euler='0 10 0' pos='0 0 -.01'/>" + site,
                "the box is tilted against it; give the box a horizontal upper face");
  ExpectRefused("<geom type='box' size='.3 .2 .01' pos='.4 0 -.01'/>" + site,
                "the box's middle is 0.400 m away, so that it is beside the box");
  ExpectRefused("<geom type='box' size='.3 .2 .01'/>" + site, "it is 0.010 m below the box's");
  ExpectRefused(
      "<geom type='box' size='.3 .2 .01' pos='0 0 .01'/><site name='table_top' euler='0 "
      "180 0'/>",
      "its z axis does not point up. Put it in the middle of that face, z up");
  ExpectRefused("<geom type='sphere' size='.3'/>" + site, "needs a box geom in its body");
}

TEST(Support, IsMarkedByOneSiteOnly) {
  const std::string box = "<geom type='box' size='.3 .2 .01' pos='0 0 -.01'/>";
  SupportOf(box + "<site name='stable_top' pos='9 9 9'/><site name='shop/table_top'/>");
  SupportOf(box + "<site name='a_table_top' pos='9 9 9'/><site name='table_top'/>");
  ExpectThrow<NotFoundError>([&] { SupportOf(box + "<site name='stable_top'/>"); },
                             "where should objects stand: no site 'table_top'. Its sites: "
                             "stable_top. Did you mean 'stable_top'?");
  ExpectRefused(box + "<site name='a_table_top'/><site name='b_table_top'/>",
                "where should objects stand? Several sites could be meant: a_table_top, "
                "b_table_top. Name the one 'table_top'");
}

TEST(Support, IsNoTableThatIsParked) {
  TempDir folder;
  AtomicWrite(folder / "bench.xml",
              "<mujoco><worldbody><body name='bench'><geom type='box' size='.5 .5 .1' "
              "pos='0 0 -.1'/><site name='table_top'/></body></worldbody></mujoco>");
  SceneSpec spec{.name = "s", .timestep = 0.002, .add_floor = false, .add_skybox = false};
  spec.base = "tabletop";
  const Support table = FindSupport(spec);
  spec.objects.push_back({.name = "spare",
                          .mjcf_path = (folder / "bench.xml").string(),
                          .fixed = false,
                          .parked = true});
  EXPECT_EQ(FindSupport(spec).frame_to_world, table.frame_to_world);
  spec.base.reset();
  ExpectThrow<NotFoundError>([&] { FindSupport(spec); }, "no site 'table_top'");
}

}  // namespace
}  // namespace robocell
