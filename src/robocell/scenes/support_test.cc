#include "robocell/scenes/support.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/scene/scene.h"
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

TEST(Support, IsTheUpperFaceOfABoxInTheBoxsPose) {
  const Support s =
      SupportOf("<geom type='box' size='.3 .2 .01' pos='.1 .05 -.01' euler='0 0 30'/>");
  EXPECT_TRUE(s.frame_to_world.is_close(
      Pose::FromRpy({1.1, 2.05, 0.5}, {0, 0, std::numbers::pi / 6}), 1e-9, 1e-9));
  EXPECT_DOUBLE_EQ(s.half_x, 0.3);
  EXPECT_DOUBLE_EQ(s.half_y, 0.2);
  EXPECT_DOUBLE_EQ(s.thickness, 0.02);
}

TEST(Support, CanBeABoxOnItsSide) {
  const Support s = SupportOf("<geom type='box' size='.01 .2 .3' pos='0 0 -.01' euler='0 90 0'/>");
  EXPECT_NEAR(s.frame_to_world.translation().z(), 0.5, 1e-9);
  EXPECT_DOUBLE_EQ(s.half_x, 0.3);
  EXPECT_DOUBLE_EQ(s.half_y, 0.2);
  EXPECT_NEAR(s.frame_to_world.rotation()(2, 2), 1, 1e-9);
}

// Sites that earlier versions read as marks of the support, and wherever they are.
TEST(Support, DoesNotDependOnNames) {
  const std::string boxes =
      "<geom type='box' size='.3 .2 .01' pos='0 0 -.01'/>"
      "<body name='shelf' pos='2 0 0'><geom type='box' size='.1 .1 .01'/>{}</body>";
  const auto with = [&](const std::string& site) {
    return SupportOf(fmt::format(fmt::runtime(boxes), site)).frame_to_world;
  };
  const Pose plain = with("");
  for (const char* site : {"<site name='table_top'/>", "<site name='table_top' euler='0 180 0'/>",
                           "<site name='a_table_top'/><site name='b/table_top' pos='9 9 9'/>"})
    EXPECT_EQ(with(site), plain) << site;
}

TEST(Support, IsTheLargestLevelFace) {
  const std::string small = "<geom type='box' size='.2 .1 .01' pos='2 0 0'/>";
  const std::string large = "<geom type='box' size='.01 .3 .4' pos='0 .1 .2' euler='0 90 0'/>";
  const Support s = SupportOf(small + large);
  EXPECT_NEAR(s.half_x * s.half_y, 0.12, 1e-9);
  EXPECT_NEAR(s.frame_to_world.translation().z(), 0.71, 1e-9);
  EXPECT_NEAR(s.frame_to_world.rotation()(2, 2), 1, 1e-9);
  // Not the ground, not what is tilted, moves, is under a shelf or does not collide.
  EXPECT_NEAR(SupportOf(small + "<geom type='box' size='4 4 .1' pos='0 0 -.6'/>").half_x, 0.2,
              1e-9);
  EXPECT_NEAR(SupportOf(small + "<geom type='box' size='.5 .5 .01' euler='5 0 0'/>").half_x, 0.2,
              1e-9);
  EXPECT_NEAR(SupportOf(small + "<body><joint/><geom type='box' size='.5 .5 .01'/></body>").half_x,
              0.2, 1e-9);
  EXPECT_NEAR(SupportOf(small + "<geom type='box' size='.5 .5 .01'/>"
                                "<geom type='sphere' size='.1' pos='0 0 .2'/>")
                  .half_x,
              0.2, 1e-9);
  EXPECT_NEAR(
      SupportOf(small + "<geom type='box' size='.5 .5 .01' contype='0' conaffinity='0'/>").half_x,
      0.2, 1e-9);
  ExpectThrow<NotFoundError>([&] { SupportOf("<geom type='sphere' size='.3'/>"); },
                             "scene 's' from '");
  ExpectThrow<NotFoundError>([&] { SupportOf("<geom type='sphere' size='.3'/>"); },
                             "no support for objects: no fixed box");
}

// An object that lies in the middle of a table moves; a column does not.
TEST(Support, AFreeObjectInTheMiddleLeavesItASupport) {
  const auto height = [](const std::string& joint) {
    const Support s = SupportOf(
        "<geom type='box' size='.4 .4 .01' pos='0 0 -.01'/></body><body name='low' pos='3 0 .2'>"
        "<geom type='box' size='.2 .2 .01' pos='0 0 -.01'/></body><body pos='1 2 .55'>" +
        joint + "<geom type='box' size='.05 .05 .05'/>");
    return s.frame_to_world.translation().z();
  };
  EXPECT_NEAR(height("<freejoint/>"), 0.5, 1e-9);
  EXPECT_NEAR(height(""), 0.2, 1e-9);
}

// The engine is the oracle: what is put on it stays.
TEST(Support, HoldsPlacedObjects) {
  TempDir folder;
  AtomicWrite(folder / "lab.xml",
              "<mujoco><worldbody><geom type='plane' size='3 3 1'/>"
              "<body name='bench' pos='.4 -.2 0' euler='0 0 35'>"
              "<geom type='box' size='.3 .2 .3' pos='0 0 .3'/></body></worldbody></mujoco>");
  SceneSpec spec{.name = "s", .timestep = 0.002, .add_floor = false, .add_skybox = false};
  spec.base = (folder / "lab.xml").string();
  const Support s = FindSupport(spec);
  for (const double x : {-0.9, 0.9}) {
    for (const double y : {-0.9, 0.9}) {
      SceneSpec with = spec;
      SceneObject box{.name = "box", .shape = Shape::kBox};
      box.size = Vec3{0.01, 0.01, 0.01};
      box.mass = 0.1;
      box.rgba = Vec4{1, 1, 1, 1};
      box.friction = Vec3{1, 0.01, 0.001};
      const Pose at = s.frame_to_world * Pose({x * s.half_x, y * s.half_y, 0.011});
      box.pos = ToVec3(at.translation());
      with.objects.push_back(box);
      Scene scene = Scene::Build(with);
      scene.Reset();
      ASSERT_TRUE(scene.StepN(500).ok());
      EXPECT_NEAR(scene.body_pose("box").translation().z(), 0.61, 1e-3);
    }
  }
}

// The engine is the oracle: the corners of what is found are on the floor and touch nothing else.
TEST(Support, IsAFreePartOfTheFloorWithoutAFace) {
  TempDir folder;
  AtomicWrite(folder / "hall.xml",
              "<mujoco><worldbody><geom type='plane' size='0 0 1' pos='0 0 .1'/>"
              "<geom name='pillar' type='cylinder' size='.4 1' pos='0 0 1'/></worldbody></mujoco>");
  SceneSpec spec{.name = "s", .timestep = 0.002, .add_floor = false, .add_skybox = false};
  spec.base = (folder / "hall.xml").string();
  const Support s = FindSupport(spec);
  EXPECT_LE(std::max(s.half_x, s.half_y), 0.5) << "in reach of a robot beside it";
  EXPECT_GE(std::min(s.half_x, s.half_y), 0.25);
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      const Eigen::Vector3d at = s.frame_to_world * Eigen::Vector3d(x * s.half_x, y * s.half_y, 0);
      EXPECT_NEAR(at.z(), 0.1, 1e-9);
      EXPECT_GT(at.head<2>().norm(), 0.4);
    }
  }
  spec.objects.push_back({.name = "bench",
                          .shape = Shape::kBox,
                          .size = Vec3{0.2, 0.3, 0.1},
                          .rgba = Vec4{1, 1, 1, 1},
                          .mass = 1,
                          .friction = Vec3{1, 0.01, 0.001},
                          .pos = Vec3{2, 0, 0.2},
                          .fixed = true});
  EXPECT_NEAR(FindSupport(spec).frame_to_world.translation().z(), 0.3, 1e-9)
      << "a face comes first";
}

TEST(Support, ExcludesParkedTables) {
  TempDir folder;
  AtomicWrite(folder / "bench.xml",
              "<mujoco><worldbody><body name='bench'><geom type='box' size='.5 .5 .1' "
              "pos='0 0 -.1'/></body></worldbody></mujoco>");
  SceneSpec spec{.name = "s", .timestep = 0.002, .add_floor = false, .add_skybox = false};
  spec.base = "tabletop";
  const Support table = FindSupport(spec);
  spec.objects.push_back({.name = "spare",
                          .mjcf_path = (folder / "bench.xml").string(),
                          .fixed = false,
                          .parked = true});
  EXPECT_EQ(FindSupport(spec).frame_to_world, table.frame_to_world);
  spec.base.reset();
  ExpectThrow<NotFoundError>([&] { FindSupport(spec); }, "no support for objects");
}

}  // namespace
}  // namespace robocell
