#include "robocell/scenes/landmarks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "robocell/base/error.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/place_links.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

SceneObject Fixed(SceneObject object, const Vec3& pos) {
  object.fixed = true;
  object.pos = pos;
  return object;
}

SceneSpec Shop() {
  SceneSpec spec{.name = "shop", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  SceneObject board = BoxObject("board", {0, 0, 0});
  board.size = Vec3{0.3, 0.2, 0.01};
  spec.objects.push_back(Fixed(board, {1, 0, 0.5}));
  SceneObject block = BoxObject("block", {0, 0, 0});
  block.size = Vec3{0.03, 0.02, 0.04};
  spec.objects.push_back(Fixed(block, {1.1, 0.05, 0.55}));
  spec.objects.push_back(Fixed({.name = "dish", .mjcf_path = "tray"}, {0.85, 0, 0.51}));
  SceneObject ball{.name = "ball",
                   .shape = Shape::kSphere,
                   .size = Vec3{0.05, 0, 0},
                   .rgba = Vec4{1, 0, 0, 1},
                   .mass = 1,
                   .friction = Vec3{1, 0.02, 0.001}};
  spec.objects.push_back(Fixed(ball, {-1, 0, 0.05}));
  return spec;
}

class LandmarksTest : public ::testing::Test {
 protected:
  std::shared_ptr<const Landmarks> marks = LandmarksOf(Shop());
};

TEST_F(LandmarksTest, TheTopOfABoardIsItsFace) {
  const LevelArea top = marks->Tops("board").front();
  EXPECT_NEAR((top.frame_to_world.translation() - Eigen::Vector3d(1, 0, 0.51)).norm(), 0, 1e-9);
  EXPECT_NEAR(std::max(top.half_x, top.half_y), 0.3, 1e-9);
  EXPECT_NEAR(std::min(top.half_x, top.half_y), 0.2, 1e-9);
}

TEST_F(LandmarksTest, ASmallTopIsMeasuredByRays) {
  const LevelArea block = marks->Tops("block").front();
  EXPECT_NEAR((block.frame_to_world.translation() - Eigen::Vector3d(1.1, 0.05, 0.59)).norm(), 0,
              1e-6);
  EXPECT_NEAR(block.half_x, 0.03, 0.001);
  EXPECT_NEAR(block.half_y, 0.02, 0.001);
  const LevelArea ball = marks->Tops("ball").front();
  EXPECT_NEAR(ball.frame_to_world.translation().z(), 0.1, 1e-6);
  EXPECT_LT(ball.half_x, 0.02);
}

TEST_F(LandmarksTest, ATraysFloorIsBelowItsRim) {
  ASSERT_THAT(marks->Floors("dish"), ::testing::SizeIs(1));
  const LevelArea floor = marks->Floors("dish").front();
  EXPECT_GT(floor.half_x, 0.03);
  EXPECT_LT(floor.frame_to_world.translation().z(),
            0.51 + marks->ReachAlong("dish", Eigen::Vector3d::UnitZ()));
  EXPECT_NEAR(floor.frame_to_world.translation().z(),
              marks->Tops("dish").front().frame_to_world.translation().z(), 1e-6);
  EXPECT_THAT(marks->Floors("block"), IsEmpty());
}

TEST_F(LandmarksTest, TheGroundIsTheNearestSurfaceBelow) {
  EXPECT_NEAR(marks->Ground("block").frame_to_world.translation().z(), 0.51, 1e-9);
  EXPECT_NEAR(marks->Ground("ball").frame_to_world.translation().z(), 0, 1e-9);
  EXPECT_GT(marks->Ground("ball").half_x, 1);
}

TEST_F(LandmarksTest, ReachIsToTheSurface) {
  EXPECT_NEAR(marks->ReachAlong("ball", Eigen::Vector3d(0.6, 0.8, 0)), 0.05, 1e-9);
  EXPECT_NEAR(marks->ReachAlong("block", Eigen::Vector3d::UnitX()), 0.03, 1e-9);
}

// The engine's ray functions end the process for unknown kinds of geoms.
TEST(Landmarks, TerrainHasATop) {
  const TempDir dir;
  const std::filesystem::path model = dir.path() / "hill.xml";
  std::ofstream(model) << R"(<mujoco><asset><hfield name="hill" nrow="3" ncol="3" size="1 1 0.2 0.1"
    elevation="0 1 1 1 1 1 1 1 1"/></asset><worldbody><body name="terrain"><geom type="hfield" hfield="hill"/>
    </body></worldbody></mujoco>)";
  SceneSpec spec{.name = "hill", .base = model.string(), .add_floor = true};
  const std::shared_ptr<const Landmarks> marks = LandmarksOf(spec);
  ASSERT_FALSE(marks->Tops("terrain").empty());
  EXPECT_NEAR(marks->Tops("terrain").front().frame_to_world.translation().z(), 0.2, 1e-6);
}

TEST_F(LandmarksTest, SuggestsTheNearestName) {
  EXPECT_FALSE(marks->Has("bord"));
  const std::string message = ExpectThrow<NotFoundError>([&] { (void)marks->Tops("bord"); }, "");
  EXPECT_THAT(message, HasSubstr("Did you mean 'board'?"));
}

}  // namespace
}  // namespace robocell::internal
