// The textures of generated houses: bright patterns that repeat without a seam; materials tint them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace robocell::internal {

struct HouseTexture {
  std::string name;  // "wood": its file is wood.png
  std::vector<uint8_t> png;
};

// Returns all of them; they are drawn once per process.
const std::vector<HouseTexture>& HouseTextures();

// A material of the generator's files.
struct HouseMaterial {
  const char* name;
  const char* texture;  // "" for a plain colour
  float rgba[4];
  float repeat;  // of the texture, per metre
  float specular = 0.2F, shininess = 0.2F;
  float emission = 0;
};
const std::vector<HouseMaterial>& HouseMaterials();

}  // namespace robocell::internal
