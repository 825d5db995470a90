// Textures with their smaller copies (mip levels), for the software renderer. Internal to render/.
#pragma once

#include <mujoco/mujoco.h>

#include <cstdint>
#include <vector>

namespace robocell::internal {

// Texels are red, green, blue from the lowest byte on. The highest byte is 1 if the texels that are
// mixed with this one, those to the right and below, have its colour, else 0. A cube has six square
// faces in each level: +x, -x, +y, -y, +z, -z. After each row comes the texel that follows its last
// one: the first again, or in a cube the last, so that neighbours lie together.
struct SoftTexture {
  bool cube = false;
  bool sky = false;
  int width = 0, height = 0;  // size of the largest level; of one face for cubes
  int levels = 0;             // 0: this texture cannot be drawn
  // Width, height and first texel of each level.
  std::vector<int32_t> level_width, level_height, level_start;
  std::vector<uint32_t> texels;

  SoftTexture() = default;
  SoftTexture(const mjModel* model, int texture);

 private:
  void AddSmallerLevels(int faces);
  void EndRow();
  void MarkPlain(int faces);
};

}  // namespace robocell::internal
