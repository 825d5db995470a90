// For tests only: all images of one view, and the similarity of two of them.
#pragma once

#include <mujoco/mujoco.h>

#include <cstdint>
#include <vector>

#include "robocell/render/renderer.h"

namespace robocell {

inline constexpr int kAcross = 320, kDown = 240, kShown = kAcross * kDown;

struct SoftImages {
  std::vector<uint8_t> rgb = std::vector<uint8_t>(3 * kShown);
  std::vector<float> depth = std::vector<float>(kShown);
  std::vector<int32_t> ids = std::vector<int32_t>(kShown);
  CameraModel camera;
};

inline SoftImages TakeOf(Renderer& renderer, const mjData* data, const CameraView& view) {
  SoftImages out;
  out.camera = renderer.Render(data, {.camera = view, .width = kAcross, .height = kDown},
                               {.rgb = out.rgb, .depth = out.depth, .segmentation = out.ids});
  return out;
}

// Returns the structural similarity of the brightness (Wang et al. 2004), over windows of 8 x 8
// pixels.
inline double Similarity(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
  constexpr double kC1 = 6.5025, kC2 = 58.5225;
  double sum = 0;
  int windows = 0;
  for (int y = 0; y + 8 <= kDown; y += 4) {
    for (int x = 0; x + 8 <= kAcross; x += 4, ++windows) {
      double ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
      for (int k = 0; k < 64; ++k) {
        const int at = 3 * ((y + k / 8) * kAcross + x + k % 8);
        const double va = (a[at] + a[at + 1] + a[at + 2]) / 3.0,
                     vb = (b[at] + b[at + 1] + b[at + 2]) / 3.0;
        ma += va / 64;
        mb += vb / 64;
        aa += va * va / 64;
        bb += vb * vb / 64;
        ab += va * vb / 64;
      }
      sum += (2 * ma * mb + kC1) * (2 * (ab - ma * mb) + kC2) /
             ((ma * ma + mb * mb + kC1) * (aa - ma * ma + bb - mb * mb + kC2));
    }
  }
  return sum / windows;
}

}  // namespace robocell
