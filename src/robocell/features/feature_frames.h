// The frames in which features of a user's own may be expressed: those of a cell's robots, and
// elements of its scene.
#pragma once

#include <string>

#include "robocell/scene/scene.h"

namespace robocell::internal {

// Returns "" for a frame of the scene, and for "", no frame; else which ones there are, with the
// nearest: "no frame 'wrld'. Its frames: world, ... Did you mean 'world'?". Frames are "world",
// "root frame", "shared base frame", "base of rc7", "TCP of rc7", and elements: "body 'cup'",
// "geom 'lid'", "site 'grip'", "camera 'wrist'".
std::string WhyNoFrame(const Scene& scene, const std::string& frame);

}  // namespace robocell::internal
