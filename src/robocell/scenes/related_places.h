// RelatedPlaces: draws the places of objects of a start that are on, inside or next to something
// else (place_links.h).
//
//   RelatedPlaces related(LinkPlaces(LandmarksOf(base), said, start, problems));
//   if (auto why_not = related.Put(support, sizes, objects, rng)) ...   // "'mug' does not fit ..."
//
// Threads: one user at a time.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/place_links.h"
#include "robocell/scenes/support.h"
#include "robocell/spec/scene_object.h"

namespace robocell::internal {

class RelatedPlaces {
 public:
  explicit RelatedPlaces(std::vector<PlaceLink> links) : links_(std::move(links)) {}

  // Returns true if an object, by its index, has a place in relation to something.
  bool IsRelated(size_t object) const;
  // Sets the poses of these objects, after the others have theirs; `grounds` is what each of the
  // others stands on. Returns why there is no place for one of them; those before it have been
  // moved.
  std::optional<std::string> Put(std::vector<LevelArea> grounds, std::span<const ObjectSize> sizes,
                                 std::vector<SceneObject>& objects, Rng& rng) const;
  // The others stand on the support.
  std::optional<std::string> Put(const Support& support, std::span<const ObjectSize> sizes,
                                 std::vector<SceneObject>& objects, Rng& rng) const;

  // Checks all relations in a scene where the objects have come to rest: returns "'mug' inside
  // 'tray': it did not stay there", unset if all hold. Poses and contacts must be up to date.
  std::optional<std::string> WhyNotKept(const Scene& scene,
                                        const std::vector<SceneObject>& objects) const;

 private:
  const PlaceLink* LinkOf(size_t object) const;
  bool RestsOn(const PlaceLink& link, size_t object) const;

  std::vector<PlaceLink> links_;  // each after those that it refers to
};

}  // namespace robocell::internal
