#include "robocell/render/soft_texture.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "robocell/mujoco/compile.h"

namespace robocell::internal {
namespace {

SoftTexture TextureOf(const std::string& attributes) {
  const ModelPtr model = Compile(ParseXmlString("<mujoco><asset><texture name='t' " + attributes +
                                                "/></asset><worldbody><geom size='1'/></worldbody>"
                                                "</mujoco>")
                                     .get());
  return {model.get(), 0};
}

constexpr uint32_t kColour = 0xffffff, kPlain = kSoftPlain;

uint32_t At(const SoftTexture& texture, size_t level, int x, int y, int face = 0) {
  const int width = texture.level_width[level] + 1, height = texture.level_height[level];
  const int at = texture.level_start[level] + face * width * height + y * width + x;
  return texture.texels[static_cast<size_t>(at)];
}

TEST(SoftTexture, AFlatTextureIsPlainEverywhereInEveryLevel) {
  const SoftTexture texture =
      TextureOf("type='2d' builtin='flat' rgb1='1 .5 0' width='8' height='4'");
  ASSERT_EQ(texture.levels, 4);
  EXPECT_FALSE(texture.cube);
  for (size_t level = 0; level < 4; ++level) {
    for (int y = 0; y < texture.level_height[level]; ++y) {
      for (int x = 0; x < texture.level_width[level]; ++x)
        EXPECT_EQ(At(texture, level, x, y), At(texture, 0, 0, 0)) << level;
    }
  }
  EXPECT_EQ(At(texture, 0, 0, 0) & 255, 255) << "red";
  EXPECT_NEAR(At(texture, 0, 0, 0) >> 8 & 255, 127, 1) << "green";
  EXPECT_EQ(At(texture, 0, 0, 0) >> 16 & 255, 0) << "blue";
  EXPECT_TRUE(At(texture, 0, 0, 0) & kPlain);
}

// The marks of squares of one colour, against a look at each texel. Tiles repeat.
TEST(SoftTexture, MarksSquaresOfOneColour) {
  for (const char* marks : {"mark='none'", "mark='random' random='0.004' markrgb='1 0 0'"}) {
    const SoftTexture texture =
        TextureOf("type='2d' builtin='checker' rgb1='0 0 0' rgb2='1 1 1' width='64' height='48' " +
                  std::string(marks));
    int count[2] = {};
    for (size_t level = 0; level < texture.level_width.size(); ++level) {
      const int w = texture.level_width[level], h = texture.level_height[level];
      const auto is_one = [&](int x, int y, int side) {
        for (int k = 0; k < side * side; ++k) {
          const uint32_t other = At(texture, level, (x + k % side) % w, (y + k / side) % h);
          if (((other ^ At(texture, level, x, y)) & kColour) != 0) return false;
        }
        return true;
      };
      for (int y = 0; y < h; ++y) {
        for (int x = 0; x < w; ++x) {
          const bool wide = (At(texture, level, x, y) & kSoftWide) != 0,
                     wider = (At(texture, level, x, y) & kSoftWider) != 0;
          ASSERT_EQ(wide, is_one(x, y, kSoftWideSide)) << level << ": " << x << " " << y;
          ASSERT_EQ(wider, is_one(x, y, kSoftWiderSide)) << level << ": " << x << " " << y;
          count[0] += wide;
          count[1] += wider;
        }
      }
    }
    EXPECT_GT(count[1], 100);
    EXPECT_GT(count[0], count[1]);
  }
}

TEST(SoftTexture, LevelsHalveDownToOneTexel) {
  const SoftTexture texture = TextureOf("type='2d' builtin='flat' width='20' height='6'");
  EXPECT_EQ(texture.level_width, (std::vector<int32_t>{20, 10, 5, 2, 1}));
  EXPECT_EQ(texture.level_height, (std::vector<int32_t>{6, 3, 1, 1, 1}));
}

TEST(SoftTexture, SmallerLevelsAreMeans) {
  const SoftTexture texture =
      TextureOf("type='2d' builtin='checker' rgb1='0 0 0' rgb2='1 1 1' width='4' height='4'");
  EXPECT_NEAR(At(texture, texture.level_width.size() - 1, 0, 0) & 255, 128, 1)
      << "half black, half white";
  EXPECT_FALSE(At(texture, 0, 1, 1) & kPlain) << "four colours meet here";
}

TEST(SoftTexture, ARowOfATileIsFollowedByItsFirstTexel) {
  const SoftTexture texture =
      TextureOf("type='2d' builtin='checker' rgb1='0 0 0' rgb2='1 1 1' width='4' height='4'");
  for (int y = 0; y < 4; ++y)
    EXPECT_EQ(At(texture, 0, 4, y) & kColour, At(texture, 0, 0, y) & kColour);
}

TEST(SoftTexture, ACubeHasSixFacesWhoseRowsEndInTheirLastTexel) {
  const SoftTexture texture =
      TextureOf("type='cube' builtin='gradient' rgb1='1 0 0' rgb2='0 0 1' width='8' height='48'");
  EXPECT_TRUE(texture.cube);
  EXPECT_FALSE(texture.sky);
  EXPECT_EQ(texture.height, 8);
  for (int face = 0; face < 6; ++face) {
    for (int y = 0; y < 8; ++y)
      EXPECT_EQ(At(texture, 0, 8, y, face) & kColour, At(texture, 0, 7, y, face) & kColour);
  }
  EXPECT_TRUE(TextureOf("type='skybox' builtin='flat' width='8' height='48'").sky);
}

}  // namespace
}  // namespace robocell::internal
