#include "robocell/scenes/made_texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <string>

#include "robocell/base/error.h"
#include "robocell/spec/randomize_config.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

std::vector<uint8_t> Texels(const std::string& kind, uint32_t seed, const TextureSize& size) {
  std::vector<uint8_t> texels(size.bytes());
  FillTexture({.kind = kind, .seed = seed}, size, texels);
  return texels;
}

TEST(MadeTexture, EachKindHasAPatternOfItsOwnThatASeedRepeats) {
  const TextureSize size{.side = 16, .faces = 6};
  std::set<std::vector<uint8_t>> different;
  for (const std::string& kind : MadeTextures()) {
    const std::vector<uint8_t> texels = Texels(kind, 3, size);
    EXPECT_EQ(texels, Texels(kind, 3, size)) << kind;
    different.insert(texels);
    different.insert(Texels(kind, 4, size));
    const auto [low, high] = std::ranges::minmax_element(texels);
    EXPECT_GT(*high - *low, 20) << kind << " is flat";
  }
  EXPECT_EQ(different.size(), 2 * MadeTextures().size());
}

TEST(MadeTexture, NoiseGoesOnAtTheEdges) {
  const TextureSize size{.side = 64};
  for (const std::string kind : {"noise", "gradient"}) {
    const std::vector<uint8_t> texels = Texels(kind, 5, size);
    int inside = 0, across = 0;  // largest steps between neighbours
    for (int row = 0; row < 64; ++row) {
      const uint8_t* line = texels.data() + static_cast<ptrdiff_t>(3 * 64) * row;
      for (int i = 0; i < 63; ++i)
        inside = std::max(inside, std::abs(line[3 * i] - line[3 * (i + 1)]));
      across = std::max(across, std::abs(line[0] - line[3 * 63]));
    }
    EXPECT_LE(across, inside + 2) << kind;
  }
}

TEST(MadeTexture, UnknownKindsAndFilesAreNamed) {
  std::vector<uint8_t> texels(3);
  ExpectThrow<NotFoundError>([&] { FillTexture({.kind = "wod"}, {.side = 1}, texels); },
                             "Did you mean 'wood'?");
  ExpectThrow<IoError>([] { ReadPng("/nowhere/oak.png"); }, "there is no such file");
}

TEST(MadeTexture, AnImageIsScaledToEveryFaceByMeans) {
  const TextureImage image{
      .width = 2, .height = 2, .rgb = {0, 0, 0, 100, 0, 0, 200, 0, 0, 60, 0, 0}};
  std::vector<uint8_t> texels(TextureSize{.side = 1, .faces = 6}.bytes());
  FillTexture(image, {.side = 1, .faces = 6}, texels);
  for (size_t face = 0; face < 6; ++face) EXPECT_EQ(texels[3 * face], 90);
  std::vector<uint8_t> same(TextureSize{.side = 2}.bytes());
  FillTexture(image, {.side = 2}, same);
  EXPECT_EQ(same, image.rgb);
}

}  // namespace
}  // namespace robocell::internal
