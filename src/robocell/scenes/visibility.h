// Measures the share of an object that a camera sees, with rays: for conditions on starts, which
// are tried many times a second without a renderer.
#pragma once

#include <string>
#include <vector>

#include "robocell/render/camera_model.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

// What a camera sees of some bodies.
struct SightOfBodies {
  double share = 0;              // see VisibleShare
  std::vector<int> hidden_by{};  // by body of the scene: points of them that it hides
};

// The same for the bodies of a mask, one entry for each body of the model. Poses of the scene are up
// to date.
SightOfBodies SightOf(const Scene& scene, const std::vector<bool>& bodies,
                      const CameraModel& camera);

// The share, 0 to 1, of points on a body and on what hangs from it that are in the image with
// nothing in front of them. The points are those where rays to a grid in the bounding boxes of its
// visible geoms end on it; what is drawn only in groups that renderers leave out (3 and above)
// neither counts nor hides. Poses of the scene are up to date. NotFoundError for an unknown body.
double VisibleShare(const Scene& scene, const std::string& body, const CameraModel& camera);

}  // namespace robocell::internal
