// PlaceLinks: the places of a start (`start.places`, Task::places), resolved: which object of the
// start lies on, in or beside what.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "robocell/scenes/landmarks.h"
#include "robocell/spec/containers.h"
#include "robocell/spec/object_place.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/scene_object.h"
#include "robocell/spec/scene_spec.h"

namespace robocell::internal {

// Compiles the scene. Missing annotations are derived.
std::shared_ptr<const Landmarks> LandmarksOf(const SceneSpec& scene,
                                             const std::optional<SceneAnnotations>& known = {});

// Places that a file or a task states: `path` is "start.places" of a run, "places" of an
// environment.
struct StatedPlaces {
  Map<ObjectPlace> places;
  std::string path;
  // The method that returned them, "places()"; `path` is then that of its task. "" for a file.
  std::string hook = {};
};

// The objects of a start, and their kinds.
struct StartObjects {
  const std::vector<SceneObject>& objects;
  const std::vector<std::string>& kinds;
  // Decides which names and kinds objects of other starts may have.
  std::function<bool(const std::string& name)> may_come;
  // The names that stand for them in this start, "target"; "" for none. Empty if none has one.
  std::vector<std::string> parts = {};
};

// A relation between an object of the start, by its index, and another one or an element of the
// scene.
struct PlaceLink {
  size_t object = 0;
  ObjectPlace place = {};
  std::optional<size_t> other = {};  // the object that it refers to
  std::shared_ptr<const Landmarks> marks =
      {};                 // landmarks with the reference; null if the start has none
  std::string mark = {};  // its name there
  std::shared_ptr<const Landmarks> own = {};  // the object's, alone at the origin
};

// The mistakes of an entry of places.
enum class PlaceMistakeKind {
  kNotValid,         // by itself
  kNoSuchObject,     // no object has the name or kind of the entry
  kNoSuchReference,  // nothing has the name that it refers to
  kRefersToItself,
  kIsFixed,
  kHasAPose,
  kNoTop,     // nothing can lie on or beside the reference
  kNoHollow,  // or inside it
  kNoGround,  // what the reference stands on is not known
  kCircle,
};
// Identifies a mistake: several starts have the same one, each with its own alternatives.
struct PlaceMistake {
  PlaceMistakeKind kind;
  std::string path, entry;  // of StatedPlaces, and the key of the entry; "" for several entries
  std::string which = {};   // of several of this kind
  bool operator<(const PlaceMistake& other) const {
    return std::tie(kind, path, entry, which) <
           std::tie(other.kind, other.path, other.entry, other.which);
  }
};
using PlaceMistakes = std::set<PlaceMistake>;

// Returns the link of each object that has an entry, each after those that it refers to. The first
// of `stated` with an entry counts; in each, an object's name comes before its part, and that before
// its kind. An entry by part or kind does not concern the object that it refers to.
// Adds problems, at the path of the entry: no object has that name or kind, a place is not valid,
// the reference is nothing in the scene or cannot be put on, into or beside, or relations run in a
// circle. Entries with problems have no link. The second form leaves out mistakes that `reported`
// has, and adds the others to it.
std::vector<PlaceLink> LinkPlaces(const std::shared_ptr<const Landmarks>& base,
                                  std::span<const StatedPlaces> stated, const StartObjects& start,
                                  Problems& problems);
std::vector<PlaceLink> LinkPlaces(const std::shared_ptr<const Landmarks>& base,
                                  std::span<const StatedPlaces> stated, const StartObjects& start,
                                  Problems& problems, PlaceMistakes& reported);

// Returns "'mug' next_to 'box'".
std::string TextOf(const PlaceLink& link, const std::vector<SceneObject>& objects);

}  // namespace robocell::internal
