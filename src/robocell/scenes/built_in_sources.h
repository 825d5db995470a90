// The built-in kinds of scene sources, for their registry.
#pragma once

#include <memory>

#include "robocell/scenes/scene_source.h"

namespace robocell::internal {

// `files`: MJCF files, one scene each.
std::shared_ptr<const SceneSourceKind> MakeFilesKind();
// `houses`: houses from files (houses/house_folder.h), and the built-in ones.
std::shared_ptr<const SceneSourceKind> MakeHousesKind();
// `tabletop`: the built-in table on a floor, as often as requested.
std::shared_ptr<const SceneSourceKind> MakeTabletopKind();

}  // namespace robocell::internal
