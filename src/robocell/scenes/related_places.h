// RelatedPlaces: draws where objects of a start lie that are on, inside or next to something else:
// another object of the start, or an object or body of the scene.
//
//   RelatedPlaces related(LandmarksOf(base, annotations), places, objects, kinds);
//   if (auto why_not = related.Put(support, sizes, objects, rng)) ...   // "'mug' does not fit ..."
//
// Threads: one user at a time.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/landmarks.h"
#include "robocell/scenes/support.h"
#include "robocell/spec/containers.h"
#include "robocell/spec/object_place.h"
#include "robocell/spec/scene_object.h"
#include "robocell/spec/scene_spec.h"

namespace robocell::internal {

// Compiles the scene. What its source does not know is derived.
std::shared_ptr<const Landmarks> LandmarksOf(const SceneSpec& scene,
                                             const std::optional<SceneAnnotations>& known = {});

using NamePredicate = std::function<bool(const std::string& name)>;

class RelatedPlaces {
 public:
  // `objects` of a start, and what each is called beside its name. `base` is the scene without
  // them. `may_come` tells which names and kinds objects of other starts may have. SpecError, with
  // the key of `places`: no object has that name or kind, the reference is nothing in the scene or
  // cannot be put on or into, or relations run in a circle.
  RelatedPlaces(std::shared_ptr<const Landmarks> base, const Map<ObjectPlace>& places,
                const std::vector<SceneObject>& objects, const std::vector<std::string>& kinds,
                const NamePredicate& may_come);

  // Whether an object has a place in relation to something, by its index.
  bool IsRelated(size_t object) const;
  // Sets the poses of these objects, after the others have theirs. Returns why there is no place
  // for one of them; those before it have been moved.
  std::optional<std::string> Put(const Support& support, std::span<const ObjectSize> sizes,
                                 std::vector<SceneObject>& objects, Rng& rng) const;

  // Whether all of it holds in a scene where the objects have come to rest: "'mug' did not stay
  // inside 'tray'", unset if it does. Poses and contacts are up to date.
  std::optional<std::string> WhyNotKept(const Scene& scene,
                                        const std::vector<SceneObject>& objects) const;

  // A relation of the start: between an object and another one, or something of the scene.
  struct Link {
    size_t object = 0;
    ObjectPlace place = {};
    std::optional<size_t> other = {};  // the object that it refers to
    std::shared_ptr<const Landmarks> marks =
        {};                 // that have the reference; null when the start has none
    std::string mark = {};  // its name there
  };

 private:
  std::vector<Link> links_;  // each after those that it refers to
};

}  // namespace robocell::internal
