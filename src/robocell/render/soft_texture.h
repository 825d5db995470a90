// Textures with their smaller copies (mip levels), for the software renderer. Internal to render/.
#pragma once

#include <mujoco/mujoco.h>

#include <cstdint>
#include <vector>

namespace robocell::internal {

inline constexpr uint32_t kSoftPlain = 1u << 24, kSoftWide = 1u << 25, kSoftWider = 1u << 26;
inline constexpr int kSoftWideSide = 9, kSoftWiderSide = 13;

// Texels are red, green, blue from the lowest byte on. The highest byte has marks, else 0: kSoftPlain
// if the texels that are mixed with this one, those to the right and below, have its colour;
// kSoftWide and kSoftWider if all in a square of so many texels to the right and below have it (not
// in cubes). A cube has six square faces in each level: +x, -x, +y, -y, +z, -z. After each row comes
// the texel that follows its last one: the first again, or in a cube the last, so that neighbours lie
// together.
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
  void MarkWide();
};

}  // namespace robocell::internal
