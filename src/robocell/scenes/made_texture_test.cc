#include "robocell/scenes/made_texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/io_error.h"
#include "robocell/media/png.h"
#include "robocell/spec/randomize_config.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

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
  ExpectThrow<NotFoundError>(
      [&] { FillTexture({.kind = "wod"}, {.side = 1}, texels, "target 'cube'"); }, "target 'cube'");
  ExpectThrow<IoError>([] { ReadPng("/nowhere/oak.png"); }, "there is no such file");
}

TEST(MadeTexture, AFileIsCheckedWithoutDecodingAndReadAgainWhenItChanges) {
  const TempDir folder;
  const std::string file = (folder / "oak.png").string();
  const auto write = [&](uint8_t red) {
    std::vector<uint8_t> rgb;
    for (int i = 0; i < 4; ++i) rgb.insert(rgb.end(), {red, 0, 0});
    WritePng(file, RgbImage{2, 2, rgb});
  };
  const auto red_of = [&] {
    std::vector<uint8_t> texels(TextureSize{.side = 1}.bytes());
    FillTextureFromPng(file, {.side = 1}, texels);
    return static_cast<int>(texels[0]);
  };
  write(100);
  EXPECT_NO_THROW(RequirePng(file));
  EXPECT_EQ(red_of(), 100);
  EXPECT_EQ(red_of(), 100);
  write(200);
  std::filesystem::last_write_time(
      file, std::filesystem::last_write_time(file) + std::chrono::seconds(2));
  EXPECT_EQ(red_of(), 200);
  const std::string whole = ReadFile(file);
  AtomicWrite(file, whole.substr(0, whole.size() - 4));
  ExpectThrow<IoError>([&] { RequirePng(file); }, "its end is missing");
  std::string large = whole;
  large[17] = large[21] = 1;  // 65538 x 65538
  AtomicWrite(file, large);
  ExpectThrow<IoError>([&] { RequirePng(file); }, "it has 65538 x 65538 pixels");
  AtomicWrite(file, "GIF");
  ExpectThrow<IoError>([&] { ReadPng(file); }, "too short");
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
