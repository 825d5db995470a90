// The kinds of objects that tasks can use: primitives with random sizes, the built-in mesh objects
// and those of users. Their categories, words and grasps are in object.yaml beside the model.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/spec/containers.h"
#include "robocell/spec/object_info.h"
#include "robocell/spec/scene_object.h"

namespace robocell {

// Returns all kinds: "box", "cylinder", "sphere", and the objects of models/objects and of users
// (assets::ObjectFolders).
std::vector<std::string> ObjectKinds();
// Returns true if `name` is one of them. Looks at the files of that kind only.
bool IsObjectKind(const std::string& name);

// Returns the kinds that tasks draw unless they name some: the primitives, and the objects whose
// object.yaml has `drawn_by_default`. They do not grow with the catalogue, so that the same seed
// keeps its draws. Warns of an object.yaml with faults.
std::vector<std::string> DefaultObjectKinds();

// Returns the words, the size and the grasps of a kind or of built-in equipment, from object.yaml
// beside its model; defaults without that file. Throws NotFoundError for an unknown kind and
// SpecError for a file with faults.
ObjectInfo ObjectInfoOf(const std::string& kind);

// Returns the categories of the catalogue and the kinds of each. Warns of an object.yaml with
// faults and leaves out its kind.
std::map<std::string, std::vector<std::string>> ObjectCategories();

// Replaces categories by their kinds; each kind comes once. A name that is a kind stands for that,
// and unknown names stay.
std::vector<std::string> ObjectKindsOf(const std::vector<std::string>& names);

// Returns the kinds that a task with this field `objects` draws.
std::vector<std::string> KindsToDraw(const NameList& objects);

// Returns a kind as a word of instructions: "milk carton" for "milk_carton".
std::string WordOfKind(const std::string& kind);

// Returns an object of that kind, without a pose. A primitive gets sizes, colour, mass and friction
// drawn from `rng`; a model is as its file says. Throws NotFoundError that lists the kinds.
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
