// Tests shadow maps against the distances of boxes from a light.
#include "robocell/render/soft_shadows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/mujoco/compile.h"
#include "robocell/render/soft_shapes.h"

namespace robocell::internal {
namespace {

constexpr int kSize = 64;

// A light 4 m above the origin that looks down, and a box of 2 m around the origin: 3 m below it.
class SoftShadowsTest : public ::testing::Test {
 protected:
  SoftShadowsTest()
      : model_(Compile(
            ParseXmlString("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>").get())) {
    mjv_defaultScene(&list_);
    list_.nlight = 1;
    mjvLight& light = list_.lights[0];
    light = {};
    light.type = mjLIGHT_SPOT;
    light.castshadow = true;
    light.cutoff = 45;
    light.pos[2] = 4;
    light.dir[2] = -1;
    camera_.near_m = 0.1;
    camera_.far_m = 20;
  }

  void Draw(const SoftMesh* mesh, const Eigen::Affine3d& in_world, bool bends = false) {
    shadows_.Begin(model_.get(), list_, camera_, kSize);
    if (mesh) shadows_.AddCaster(mesh, in_world, bends);
    shadows_.Draw(&threads_);
  }
  const SoftShadowMap& map() const { return *shadows_.Of(0)->map; }
  // The nearness in a pixel.
  float At(int x, int y) const {
    const SoftBuffer& buffer = map().buffer;
    const int block = (y / kSoftBlock) * buffer.columns + x / kSoftBlock;
    return buffer.nearness[static_cast<size_t>(block)]
        .at[(y % kSoftBlock) * kSoftBlock + x % kSoftBlock];
  }
  int PixelsNearerThanNothing() const {
    int count = 0;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) count += At(x, y) > map().background * 1.01f + 1e-6f;
    }
    return count;
  }

  ModelPtr model_;
  mjvScene list_;
  CameraModel camera_;
  SoftThreads threads_{2};
  SoftShadows shadows_;
  const SoftShapes shapes_{16, 8};
};

const Eigen::Affine3d kHere = Eigen::Affine3d::Identity();

TEST_F(SoftShadowsTest, TheMiddleOfASpotIsAsNearAsTheBox) {
  Draw(&shapes_.box, kHere);
  EXPECT_NEAR(At(kSize / 2, kSize / 2), 1.0 / 3, 1e-4) << "nearness is 1 / depth";
  EXPECT_NEAR(At(0, 0), 1 / camera_.far_m, 1e-6) << "nothing is there";
}

// The face of 2 m at a depth of 3 m fills the square of 2 fx / 3 pixels.
TEST_F(SoftShadowsTest, ABoxFillsItsShareOfTheMap) {
  Draw(&shapes_.box, kHere);
  const double side = 2 * shadows_.Of(0)->view.fx / 3;
  EXPECT_NEAR(PixelsNearerThanNothing(), side * side, 4 * side);
}

TEST_F(SoftShadowsTest, ADirectionalLightIsLinearInDepth) {
  list_.lights[0].type = mjLIGHT_DIRECTIONAL;
  Draw(&shapes_.box, kHere);
  EXPECT_NEAR(At(kSize / 2, kSize / 2), (20 - 3) / (20 - 0.1), 1e-4);
  EXPECT_EQ(At(0, 0), 0);
}

TEST_F(SoftShadowsTest, TheNearestCasterIsInTheMap) {
  shadows_.Begin(model_.get(), list_, camera_, kSize);
  const Eigen::Affine3d higher(Eigen::Translation3d(0, 0, 1) * Eigen::Scaling(0.2));
  shadows_.AddCaster(&shapes_.box, higher, false);
  shadows_.AddCaster(&shapes_.box, kHere, false);
  shadows_.Draw(&threads_);
  EXPECT_NEAR(At(kSize / 2, kSize / 2), 1 / (3 - 0.2), 1e-4);
}

TEST_F(SoftShadowsTest, AMovedCasterIsDrawnAgainAndLeavesNothingBehind) {
  Draw(&shapes_.box, kHere);
  const int before = PixelsNearerThanNothing();
  Draw(&shapes_.box, Eigen::Affine3d(Eigen::Translation3d(0.5, 0, -1)));
  EXPECT_NEAR(At(kSize / 2, kSize / 2), 1.0 / 4, 1e-4);
  EXPECT_LT(PixelsNearerThanNothing(), before);
  Draw(nullptr, kHere);
  EXPECT_EQ(PixelsNearerThanNothing(), 0);
}

// A light may move by less than the single precision of its transform shows: maps are those of a new
// renderer all the same.
TEST_F(SoftShadowsTest, ALightThatMovesTheLeastBitIsDrawnAgain) {
  mjvLight& light = list_.lights[0];
  light.pos[0] = 0.001F;
  light.dir[0] = light.dir[1] = 0.5F;
  Draw(&shapes_.box, kHere);
  Draw(&shapes_.box, kHere);
  EXPECT_EQ(map().drawings, 1U);
  light.pos[0] = std::nextafter(light.pos[0], 1.0F);
  Draw(&shapes_.box, kHere);
  EXPECT_EQ(map().drawings, 2U);
}

// Maps that were drawn in parts are those that are drawn at once, bit by bit.
TEST_F(SoftShadowsTest, MovedCastersChangeTheirPartOfTheMapAlone) {
  Rng rng = Rng::Stream(3, "moved casters");
  constexpr int kSide = 512, kCasters = 12;
  std::vector<Eigen::Affine3d> poses;
  const auto anywhere = [&] {
    Eigen::Affine3d pose(Eigen::Translation3d(rng.Uniform(-5, 5), rng.Uniform(-5, 5),
                                              rng.Uniform(-2, 4.5)));  // also behind the light
    pose.rotate(Eigen::AngleAxisd(rng.Uniform(-3, 3), Eigen::Vector3d::UnitX()));
    return Eigen::Affine3d(pose * Eigen::Scaling(rng.Uniform(0.05, 0.6)));
  };
  for (int i = 0; i < kCasters; ++i) poses.push_back(anywhere());
  const auto draw = [&](SoftShadows& shadows) {
    shadows.Begin(model_.get(), list_, camera_, kSide);
    const Eigen::Affine3d floor(Eigen::Translation3d(0, 0, -3) * Eigen::Scaling(9.0, 9.0, 0.1));
    shadows.AddCaster(&shapes_.box, floor, false);
    for (size_t i = 0; i < poses.size(); ++i)
      shadows.AddCaster(i % 2 ? &shapes_.box : &shapes_.sphere, poses[i], i == 1);
    shadows.Draw(&threads_);
  };
  for (const int type : {mjLIGHT_SPOT, mjLIGHT_DIRECTIONAL}) {
    list_.lights[0].type = type;
    for (int frame = 0; frame < 30; ++frame) {
      for (int moves = 0; moves < frame % 4; ++moves)
        poses[rng.UniformInt(poses.size())] = anywhere();
      if (frame == 20) poses.pop_back();
      draw(shadows_);
      SoftShadows fresh;
      draw(fresh);
      const SoftShadowMap &parts = map(), &at_once = *fresh.Of(0)->map;
      ASSERT_EQ(parts.buffer.nearness.size(), at_once.buffer.nearness.size());
      for (size_t i = 0; i < parts.buffer.nearness.size(); ++i)
        ASSERT_TRUE(std::ranges::equal(parts.buffer.nearness[i].at, at_once.buffer.nearness[i].at))
            << "frame " << frame << ", block " << i;
      ASSERT_EQ(parts.nearest, at_once.nearest) << "frame " << frame;
      ASSERT_EQ(parts.farthest, at_once.farthest) << "frame " << frame;
    }
  }
}

// A tile's limits are those of its pixels and of a row and a column of blocks beside it, in each level.
TEST_F(SoftShadowsTest, LimitsOfTilesAreThoseOfTheirPixels) {
  constexpr int kSide = 200;  // neither tiles nor their pairs fill it
  shadows_.Begin(model_.get(), list_, camera_, kSide);
  Eigen::Affine3d pose(Eigen::Translation3d(0.3, -0.4, 0));
  pose.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  shadows_.AddCaster(&shapes_.box, pose, false);
  shadows_.Draw(&threads_);
  const SoftShadowMap& map = this->map();
  for (int level = 0; level < kSoftTileLevels; ++level) {
    const int side = kSoftTile * kSoftBlock << level;
    ASSERT_EQ(map.level_columns[level], (kSide + side - 1) / side);
    for (int y = 0; y < map.level_rows[level]; ++y) {
      for (int x = 0; x < map.level_columns[level]; ++x) {
        const int end_x = std::min(kSide, side * (x + 1) + kSoftBlock),
                  end_y = std::min(kSide, side * (y + 1) + kSoftBlock);
        float nearest = 0, farthest = 1e9f;
        for (int v = side * y; v < end_y; ++v) {
          for (int u = side * x; u < end_x; ++u) {
            nearest = std::max(nearest, At(u, v));
            farthest = std::min(farthest, At(u, v));
          }
        }
        const int tile = map.level_start[level] + y * map.level_columns[level] + x;
        ASSERT_EQ(map.nearest[static_cast<size_t>(tile)], nearest)
            << level << ": " << x << " " << y;
        ASSERT_EQ(map.farthest[static_cast<size_t>(tile)], farthest)
            << level << ": " << x << " " << y;
      }
    }
  }
}

TEST_F(SoftShadowsTest, TheMapDoesNotDependOnTheCamera) {
  Draw(&shapes_.box, kHere);
  const float* nearness = map().buffer.nearness[0].at;
  const float first = At(kSize / 2, kSize / 2);
  camera_.camera_in_world = Pose(Eigen::Vector3d(1, 2, 3));
  Draw(&shapes_.box, kHere);
  EXPECT_EQ(map().buffer.nearness[0].at, nearness);
  EXPECT_EQ(At(kSize / 2, kSize / 2), first);
}

// The centre of the box's upper face, as the camera sees it, is the middle of the map.
TEST_F(SoftShadowsTest, PointsOfTheCameraLeadToTheirPlaceInTheMap) {
  camera_.camera_in_world = Pose(Eigen::Vector3d(1, 2, 3));
  Draw(&shapes_.box, kHere);
  const SoftShadow& shadow = *shadows_.Of(0);
  const Eigen::Vector3d point = camera_.camera_in_world.inverse() * Eigen::Vector3d(0, 0, 1);
  const auto row = [&](int r) {
    const float* m = shadow.to_map + 4 * r;
    return m[0] * point.x() + m[1] * point.y() + m[2] * point.z() + m[3];
  };
  EXPECT_NEAR(row(2), 3, 1e-5) << "the distance along the beam";
  EXPECT_NEAR(row(0), 0, 1e-4) << "the middle, times the distance";
  EXPECT_NEAR(row(1), 0, 1e-4);
}

TEST_F(SoftShadowsTest, LightsThatCastNoShadowHaveNoMap) {
  list_.lights[0].castshadow = false;
  Draw(&shapes_.box, kHere);
  EXPECT_EQ(shadows_.Of(0), nullptr);
  list_.lights[0].castshadow = true;
  list_.lights[0].headlight = true;
  Draw(&shapes_.box, kHere);
  EXPECT_EQ(shadows_.Of(0), nullptr);
  EXPECT_EQ(shadows_.Of(7), nullptr);
}

TEST_F(SoftShadowsTest, ClearedMapsAreDrawnAgain) {
  Draw(&shapes_.box, kHere);
  shadows_.Clear();
  EXPECT_EQ(shadows_.Of(0), nullptr);
  const SoftShapes smaller(8, 4);
  Draw(&smaller.sphere, kHere);
  EXPECT_NEAR(At(kSize / 2, kSize / 2), 1.0 / 3, 1e-2);
}

}  // namespace
}  // namespace robocell::internal
