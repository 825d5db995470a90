// CellImages: the image streams of a cell (CameraSystemConfig), drawn for its present state.
// Recorders and policies use the same images from here.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "robocell/render/camera_model.h"
#include "robocell/render/renderer.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/camera_spec.h"

namespace robocell {

// A pixel of segmentation that shows no body.
inline constexpr uint16_t kNoBody = 65535;

struct CellImage {
  std::string name;  // of the stream
  CameraView view;
  int width, height;
  CameraModel camera;              // of the last Draw()
  std::vector<uint8_t> rgb;        // rows from the top, 3 bytes a pixel
  std::vector<uint16_t> depth_mm;  // empty unless the stream has depth
  std::vector<uint16_t> bodies;    // empty unless it has segmentation: body ids, or kNoBody
};

class CellImages {
 public:
  // `renderer` may be null without streams; it is shared by all cells of a process and must outlive
  // this object. Throws NotFoundError for cameras that are not in the scene.
  CellImages(const Scene& scene, const CameraSystemConfig& config, Renderer* renderer);
  // Draws all streams of the present state.
  void Draw();
  const std::vector<CellImage>& images() const { return images_; }

 private:
  Scene scene_;
  Renderer* renderer_;
  std::vector<CellImage> images_;
  std::vector<int32_t> ids_;  // as returned by the renderer
};

}  // namespace robocell
