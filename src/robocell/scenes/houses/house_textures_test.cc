#include "robocell/scenes/houses/house_textures.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <string>

#include "robocell/base/files.h"
#include "robocell/media/png.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

TEST(HouseTextures, AreGrayPicturesWithoutASeam) {
  const TempDir folder;
  for (const HouseTexture& texture : HouseTextures()) {
    AtomicWrite(folder / "t.png", std::string(texture.png.begin(), texture.png.end()));
    const RgbImage image = ReadPngRgb(folder / "t.png");
    EXPECT_EQ(image.width, image.height);
    const auto at = [&](int x, int y) {
      return int{image.pixels[static_cast<size_t>(3 * (y * image.width + x))]};
    };
    // Neighbours across the edge differ as little as neighbours inside.
    double inside = 0, across = 0;
    for (int y = 0; y < image.height; ++y) {
      inside += std::abs(at(100, y) - at(101, y));
      across += std::abs(at(image.width - 1, y) - at(0, y));
    }
    EXPECT_LT(across, 8 * inside + 40 * image.height) << texture.name;
  }
}

TEST(HouseTextures, MaterialsHaveTheirTextures) {
  std::set<std::string> textures = {""}, names;
  for (const HouseTexture& texture : HouseTextures()) textures.insert(texture.name);
  for (const HouseMaterial& material : HouseMaterials()) {
    EXPECT_TRUE(textures.contains(material.texture)) << material.name;
    EXPECT_TRUE(names.insert(material.name).second) << material.name;
  }
}

}  // namespace
}  // namespace robocell::internal
