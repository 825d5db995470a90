// The kinds of objects that tasks can use: primitives with random sizes and the built-in mesh
// objects.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/spec/scene_object.h"

namespace robocell {

// Returns "box", "cylinder", "sphere" and the built-in models/objects.
std::vector<std::string> ObjectKinds();

// Returns an object of that kind with sizes, colour, mass and friction drawn from `rng`; no pose.
// Throws NotFoundError that lists the kinds.
SceneObject MakeCatalogueObject(const std::string& kind, const std::string& name, Rng& rng);

// The space that an object takes up, standing upright. Metres.
struct ObjectSize {
  double radius = 0;  // around its origin in the plane, for placing without overlap
  double height = 0;  // height of its origin above the support
  double top = 0;     // height of its top above its origin
};

// Sizes of objects. A model is measured once per process, which compiles it; each ObjectSizes
// checks once whether its files are unchanged.
class ObjectSizes {
 public:
  ObjectSize Of(const SceneObject& object);

 private:
  std::map<std::string, ObjectSize> models_;  // sizes by path
};

// Objects that are handled have to fit into a room, metres.
inline constexpr double kLargestObject = 10;

// Returns why an object is too large to be handled, and the next step: its lengths may be in
// millimetres. "" if it is not, and for a fixed object.
std::string WhyTooLarge(const SceneObject& object, const ObjectSize& size);
// Returns the same for a size in metres, of a model or of a shape.
std::string TooLargeText(const std::string& object, double size, bool is_model);

}  // namespace robocell
