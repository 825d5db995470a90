// CellImages: the image streams of a cell (CameraSystemConfig), drawn for its present state.
// Recorders and policies use the same images from here. The frames of an environment are CellImages
// too.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robocell/render/camera_model.h"
#include "robocell/render/renderer.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/camera_spec.h"

namespace robocell {

struct CellImage {
  std::string name;  // name of the stream
  CameraView view;
  int width = 0, height = 0;
  double time = 0;                 // simulated s; in environments since the reset
  CameraModel camera;              // of the last Draw()
  std::vector<uint8_t> rgb;        // rows from the top, 3 bytes a pixel
  std::vector<uint16_t> depth_mm;  // empty unless the stream has depth
  std::vector<uint16_t> bodies;    // empty unless it has segmentation: body ids, or kNoSegment
};

// Converts a renderer's body ids, -1 for none, to the labels that images and episodes have:
// kNoSegment for none (data/episode_schema.h). Both have the same size.
void ToSegments(std::span<const int32_t> bodies, std::span<uint16_t> segments);

class CellImages {
 public:
  // `renderer` may be null without streams; it is shared by all cells of a process and must outlive
  // this object. Throws NotFoundError for cameras that are not in the scene.
  CellImages(const Scene& scene, const CameraSystemConfig& config, Renderer* renderer);
  // Draws all streams of the present state.
  void Draw();
  // The same of a copy of the scene's model, and of data of it. All calls draw the same model.
  void Draw(const mjModel* model, const mjData* data);
  const std::vector<CellImage>& images() const {
    if (draw_at_look_) draw_at_look_();
    return images_;
  }
  // For recorders that draw later: called whenever somebody asks for images, to draw those of the
  // present state.
  void set_draw_at_look(std::function<void()> draw) { draw_at_look_ = std::move(draw); }
  // Returns the images of the last Draw, which may show another state than the present one.
  const std::vector<CellImage>& drawn() const { return images_; }

 private:
  Scene scene_;
  Renderer* renderer_;
  bool is_ready_ = false;  // the renderer has the model, which stays the same
  std::function<void()> draw_at_look_;
  std::vector<CellImage> images_;
  std::vector<int32_t> ids_;  // ids as returned by the renderer
};

}  // namespace robocell
