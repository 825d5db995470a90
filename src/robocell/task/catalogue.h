// The kinds of objects that tasks can use: primitives with random sizes and the built-in mesh
// objects.
#pragma once

#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/spec/scene_object.h"

namespace robocell {

// "box", "cylinder", "sphere" and the built-in models/objects.
std::vector<std::string> ObjectKinds();

// An object of that kind with sizes, colour, mass and friction drawn from `rng`; no pose.
// NotFoundError lists the kinds.
SceneObject MakeCatalogueObject(const std::string& kind, const std::string& name, Rng& rng);

// Room it needs around its origin in the plane, metres (for placing without overlap), and the
// height of its origin above a support it stands on upright. Models are measured once, which
// compiles them.
double FootprintRadius(const SceneObject& object);
double RestHeight(const SceneObject& object);

}  // namespace robocell
