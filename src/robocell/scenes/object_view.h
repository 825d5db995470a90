// What a camera shows of an object: its pixels, its box and points on it in the image, and the share
// of it that is visible.
//
//   BodyImages images;
//   const std::vector<bool> mug = BodiesOf(scene, "mug", "scene 'table'");
//   const ObjectView view = ViewOfObject(scene, mug, camera, 640, 480, 10, images);
//   view.pixels, view.share, view.box, view.points
//
// Images of body ids are drawn by the back end `soft`: the same pixels on every machine. One thread
// at a time.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/render/camera_model.h"
#include "robocell/render/renderer.h"
#include "robocell/scene/scene.h"

namespace robocell {

// Returns which bodies of the scene a name means: those of an object or a robot, or a body with all
// that hangs from it. Names of robots' elements may lack the prefix. Throws NotFoundError, which
// begins with `place`, with the nearest names.
std::vector<bool> BodiesOf(const Scene& scene, const std::string& name, const std::string& place);

// A box along the axes of the world, metres.
struct WorldBox {
  Eigen::Vector3d low, high;
};
// Returns a box around the geoms of some bodies without planes, unset for bodies without geoms. Poses
// are up to date.
std::optional<WorldBox> BoxOf(const Scene& scene, const std::vector<bool>& bodies);

// Images of body ids, of one scene after the other.
class BodyImages {
 public:
  // Returns the body in each pixel, -1 for none, until the next call. No allocation for further
  // images of a scene.
  std::span<const int32_t> Draw(const Scene& scene, const CameraView& view, int width, int height);

 private:
  std::unique_ptr<Renderer> renderer_;
  uint64_t generation_ = 0;  // of the scene that the renderer has
  std::vector<int32_t> ids_;
};

using Pixel = std::array<int, 2>;  // column from the left, row from the top

struct ObjectView {
  int pixels = 0;                       // that show it
  double share = 0;                     // of it that is in the image with nothing in front, 0 to 1
  Pixel low = {0, 0}, high = {-1, -1};  // corners of its box, both inside; without pixels empty
  std::vector<Pixel> points;            // on it, away from its edge and from each other
};

ObjectView ViewOfObject(const Scene& scene, const std::vector<bool>& bodies, const CameraView& view,
                        int width, int height, int most_points, BodyImages& images);

// Returns at most that many pixels of a mask, rows from the top: first the one nearest to the middle
// of the mask, then each time the one farthest from those before. They are two pixels away from its
// edge where the mask is wide enough. Throws ArgumentError for a mask of another size
// and for more than 10,000 points.
std::vector<Pixel> PointsInMask(std::span<const uint8_t> mask, int width, int height, int most);

}  // namespace robocell
