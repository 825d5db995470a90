// Places for objects on a support: drawn at random, without overlap, upright and turned at random.
#pragma once

#include <span>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/support.h"
#include "robocell/spec/scene_object.h"

namespace robocell::internal {

inline constexpr double kObjectGap = 0.03;   // metres between objects
inline constexpr double kEdgeMargin = 0.03;  // from the support's edge

// Returns true if an object stays where its spec puts it.
inline bool IsFixed(const SceneObject& object) { return object.fixed == true; }

// Sets the objects' poses; `sizes` are theirs, in the same order. Fixed ones keep theirs, and the
// others keep clear of them. False when no place was found for one of them; the objects before it
// have been moved.
bool PlaceOn(const Support& support, std::span<const ObjectSize> sizes,
             std::vector<SceneObject>& objects, Rng& rng);

}  // namespace robocell::internal
