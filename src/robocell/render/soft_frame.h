// The input and output of the software renderer's kernels for one image. Internal to render/.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "robocell/render/soft_mesh.h"
#include "robocell/render/soft_texture.h"

namespace robocell::internal {

// 4 x 4 pixels lie together, row after row.
inline constexpr int kSoftBlock = 4, kSoftPixels = 16;

// The camera. Pixels as in camera_model.h: the centre of the upper left one is (0, 0). View axes
// are MuJoCo's camera axes. Nearness, which replaces depth in the buffers, is linear on the image
// and grows towards the camera: 1 / depth of perspective cameras, the distance to the far plane as
// a share of the range of orthographic ones.
struct SoftView {
  int width = 0, height = 0;
  bool orthographic = false;
  float fx = 0, fy = 0, cx = 0, cy = 0;
  float near = 0, far = 0;
  float per_fx = 0, per_fy = 0;  // 1 / fx, 1 / fy
  // Corners are rounded to this share of a pixel.
  float steps = 256;
  int top = 0, bottom = 0;  // rows that are drawn: from `top` on, above `bottom`
};

// Rows of blocks, from `begin` on and above `end`.
struct SoftRows {
  int begin = 0, end = 0;
};

// The rows of blocks that a view draws.
inline SoftRows BlockRows(const SoftView& view) {
  return {view.top / kSoftBlock, (view.bottom + kSoftBlock - 1) / kSoftBlock};
}

// The part of a view that shows some rows.
inline SoftView RowsOf(SoftView view, SoftRows rows) {
  view.top = kSoftBlock * rows.begin;
  view.bottom = std::min(view.bottom, kSoftBlock * rows.end);
  return view;
}

// The orientation that a triangle must have to be drawn.
enum class SoftSide { kFront, kBack, kBoth };

enum class SoftMapping { kNone, kMesh, kPlanar, kCube };

struct SoftMaterial {
  float rgba[4] = {1, 1, 1, 1};
  float emission = 0, specular = 0, shininess = 0;
  bool shines = false;
  float least_shine = 0;  // square of the cosine below which a highlight is invisible
  const SoftTexture* texture = nullptr;
  SoftMapping mapping = SoftMapping::kNone;
  float scale[3] = {1, 1, 1};  // planar: of x and y; cube: of the position; mesh: of u and v
  float offset[2] = {0, 0};    // planar
};

// One mesh at one place.
struct SoftInstance {
  const SoftMesh* mesh = nullptr;
  float to_view[12];  // rows of 4
  float to_mesh[12];
  float eye[4];  // the camera, or the direction to it with 0, in the mesh's axes
  SoftSide side = SoftSide::kFront;
  SoftMaterial material;
  float own[3];  // light that does not depend on where its surface is and how it is turned
  int body = -1;
  int segment = -1;       // -1: in colour only
  uint32_t first_id = 0;  // its triangles have the ids that follow
};

struct SoftShadow;

struct SoftLight {
  bool directional = false;
  float direction[3];  // view axes; directional: to the light, others: along the beam
  float position[3];
  float attenuation[3];
  float cutoff_cosine = -1;  // -1: in all directions
  float exponent = 0;
  float ambient[3], diffuse[3], specular[3];
  bool shines = false;
  const SoftShadow* shadow = nullptr;
  bool everywhere = false;  // far away and never hidden
};

// Light reflected by a material.
struct SoftGain {
  float ambient[3], diffuse[3], specular[3];
  bool shines = false;
};

struct alignas(64) SoftNumbers {
  float at[kSoftPixels];
};
struct alignas(64) SoftIds {
  uint32_t at[kSoftPixels];
};
inline constexpr uint32_t kSoftNothing = 0xffffffffu;
// Ids are assigned in runs of this many, so that an id gives its instance.
inline constexpr int kSoftRunBits = 16;

// The visible surface of each pixel.
struct SoftBuffer {
  int width = 0, height = 0;  // pixels
  int columns = 0, rows = 0;  // blocks
  std::vector<SoftNumbers> nearness;
  std::vector<SoftIds> ids;
};

// Points beside the pixels' centres, in those blocks that show an edge.
inline constexpr int32_t kSoftNoSlot = -1;
inline constexpr int kSoftMostSamples = 16;
// A sample of a surface that no pixel beside it shows.
struct SoftStray {
  float x = 0, y = 0, nearness = 0;  // pixels
  uint32_t id = kSoftNothing;
  int32_t slot = 0, pixel = 0;
};
struct SoftSamples {
  int count = 0;                                                    // samples of each pixel
  float right[kSoftMostSamples] = {}, down[kSoftMostSamples] = {};  // pixels from the centre
  int columns = 0;                                                  // blocks
  std::vector<int32_t> slots;  // slot of each block, or kSoftNoSlot
  // The number of slots above and left of a block's upper left corner; one row and column more.
  std::vector<int32_t> before;
  std::vector<SoftNumbers> nearness;  // slot after slot, `count` each
  std::vector<SoftIds> ids;
  // Sums of red and, 16 bits higher, of blue, and sums of green; used while edges are smoothed.
  std::vector<SoftIds> red_blue, green;

  size_t At(int32_t slot, int sample) const {
    return static_cast<size_t>(slot) * static_cast<size_t>(count) + static_cast<size_t>(sample);
  }
};

// The nearness of the first surface to a light. Tiles of 4 x 4 blocks have the limits of their
// nearness, and mark where something may have been drawn. Each further level has the limits of
// 2 x 2 tiles of the level before.
inline constexpr int kSoftTile = 4,
                     kSoftTileBits = 4;  // blocks; pixels are 2 to this power
inline constexpr int kSoftTileLevels = 4;
struct SoftShadowMap {
  SoftBuffer buffer;  // buffer without ids
  int tile_columns = 0, tile_rows = 0;
  float background = 0;
  std::vector<uint8_t> drawn;  // flag of each tile
  // Limits in each tile and its neighbours, level after level, and where these begin.
  std::vector<float> nearest, farthest;
  int32_t level_start[kSoftTileLevels] = {}, level_columns[kSoftTileLevels] = {},
          level_rows[kSoftTileLevels] = {};
  // Counts the drawings, and the one that last changed each tile.
  uint32_t drawings = 0;
  std::vector<uint32_t> changed;
};

// The tiles of a map on which the colours of a block depend: columns and rows.
struct SoftReach {
  int16_t begin[2] = {0, 0}, end[2] = {0, 0};
};

// A light's view.
struct SoftShadow {
  SoftView view;
  // Rows of 4, of a point in the camera's view axes: its place in the map, half a pixel before it,
  // and its nearness; of lights with a position both places times the distance, and the distance.
  float to_map[12];
  const SoftShadowMap* map = nullptr;
};

// Scratch memory while an instance is drawn.
struct SoftScratch {
  std::vector<SoftStray> strays;
  std::vector<float> x, y, nearness;  // vertices on the image
  std::vector<int32_t> facing;        // triangles that are turned to the camera
  std::vector<int32_t> corners[3];    // their vertices
  std::vector<int32_t> cut;           // those that reach out of the drawable range
  std::vector<int32_t> clusters;      // clusters that may be visible
  std::vector<uint8_t> groups;        // 1 for groups of vertices that are needed
};

struct SoftSky {
  const SoftTexture* texture = nullptr;
  float from_view[9];  // rows; to world axes
  float radius = 0;    // radius of the cylinder with the sky, around the camera
  // Haze over the first infinite plane, below `elevation` metres of the camera; 0: none.
  float elevation = 0;
  float to_plane[9];  // rows; from view axes to the plane's
  float haze = 0, haze_rgb[3];
  float haze_height = 0.5f;  // share of the elevation at which it is densest
};

struct SoftReflection;

struct SoftPicture {
  const SoftView* view = nullptr;
  const SoftInstance* instances = nullptr;
  const int32_t* instance_of_run = nullptr;
  const SoftLight* lights = nullptr;
  int light_count = 0;
  const SoftGain* gains = nullptr;  // gains of each instance, light after light
  bool shadows = true;
  SoftSky sky;
  const SoftReflection* reflection = nullptr;
};

// The reflection in a flat face: a separate picture, seen through the face as a mirror.
struct SoftReflection {
  SoftPicture picture;
  SoftBuffer buffer;
  uint32_t first_id = 0;  // triangles of the face
  int triangles = 0;
};

}  // namespace robocell::internal
