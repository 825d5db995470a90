// GlPainter: draws lists of visible elements with MuJoCo's own OpenGL drawing, in the GL context
// that is current. It knows nothing of simulations: who made the list may be another process
// (drawing_service.h).
//
//   const GlPainter painter(model, {.multisamples = 4});    // uploads meshes and textures
//   painter.Paint({.scene = scene, .exact_geoms = scene->ngeom, .width = 640, .height = 480, .rgb = rgb});
//
// Colour is one pass; depth and codes come together from a second one, drawn with ids as colours,
// without multisampling and without the sky, which would write depth. Images are raw: rows from the
// bottom, depth reversed (mjDEPTH_ZEROFAR), which keeps it exact to a fraction of a millimetre over
// the whole range, and ids as colours (image_convert.h).
//
// Begin and Finish do the same in two halves, for several pictures at a time: the card draws one
// while the images of another are copied. Every call needs the GL context current on this thread;
// so do the constructor and the destructor. Internal to render/.
#pragma once

#include <mujoco/mujoco.h>

#include <cstdint>
#include <memory>
#include <span>

#include "robocell/render/gl_drawing.h"
#include "robocell/render/pixel_buffer.h"

namespace robocell::internal {

struct GlStyle {
  int multisamples = 0;
  int shadow_size = 0;  // 0: no shadows
  bool things = true;   // meshes and textures are uploaded
  bool operator==(const GlStyle&) const = default;
};

struct GlPicture {
  // The list of elements, with its camera, lights, and flags of shadows, reflections and the sky.
  mjvScene* scene = nullptr;
  int exact_geoms = 0;  // those of depth and codes; markers come after them
  int width = 0, height = 0;
  std::span<uint8_t> rgb = {};  // empty: not wanted
  std::span<uint8_t> codes = {};
  std::span<float> depth = {};

  bool is_exact() const { return !codes.empty() || !depth.empty(); }
};

class GlPainter {
 public:
  // `model` has to outlive it.
  GlPainter(const mjModel* model, const GlStyle& style);

  void Paint(const GlPicture& picture);
  void Begin(const GlPicture& picture, PixelBuffer& pixels);
  static void Finish(const GlPicture& picture, PixelBuffer& pixels);

 private:
  void DrawColour(const GlPicture& picture);
  void DrawExact(const GlPicture& picture);
  MjrContext& Exact();

  const mjModel* model_;
  GlStyle style_;
  MjrContext colour_;                  // without multisampling one serves both passes
  std::unique_ptr<MjrContext> exact_;  // for depth and codes if `colour_` is multisampled
};

}  // namespace robocell::internal
