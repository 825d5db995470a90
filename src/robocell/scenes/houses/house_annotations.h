// The annotations of a house: what its geometry says, completed by its map and its metadata.
#pragma once

#include <string>
#include <vector>

#include "robocell/scene/scene.h"
#include "robocell/scenes/houses/house_folder.h"
#include "robocell/scenes/scene_annotations.h"

namespace robocell::internal {

// Returns the annotations of a built house. Free floor and rooms come from the map, words of the
// objects from the metadata; without these files, free floor comes from the geometry, and there are
// no rooms and words. Supports are the free parts of level faces as high as furniture. `notes` gets
// what is missing or cannot be read.
SceneAnnotations AnnotateHouse(const Scene& scene, const HouseFiles& files,
                               std::vector<std::string>& notes);

// Returns the largest free rectangles of level faces, one for each, largest first: nothing is
// within kRoomAbove over them. Faces as high as furniture only, each at least kLeastSupport wide.
std::vector<SupportFace> FreeSupports(const Scene& scene, const std::vector<SupportFace>& faces);
inline constexpr double kRoomAbove = 0.3, kLeastSupport = 0.18;  // metres

}  // namespace robocell::internal
