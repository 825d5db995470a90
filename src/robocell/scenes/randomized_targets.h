// RandomizedTargets: what `randomize:` can mean in a scene: objects, robots, bodies that stand in the
// world and its geoms, by name or by a pattern of names.
//
//   RandomizedTargets targets(scene);
//   for (const std::string& name : targets.Matching("block_*")) use(targets.At(name, "run 'a'").bodies);
//
// It follows the scene: after objects were added or removed, targets are looked up again.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/scene/scene.h"

namespace robocell::internal {

// Geoms of this group and higher ones collide, and are not drawn.
inline constexpr int kFirstHiddenGroup = 3;

// The built-in model of lights and materials that randomisation uses; no target.
inline constexpr const char* kStudio = "studio";

struct RandomizedTarget {
  std::string name;
  bool is_object = false, is_robot = false;
  std::vector<int> bodies, geoms, dofs, servos;
  std::vector<int> shown;  // geoms that are drawn
};

class RandomizedTargets {
 public:
  explicit RandomizedTargets(Scene scene) : scene_(std::move(scene)) {}

  // Returns the names of all targets.
  std::vector<std::string> names();
  // Returns those that a pattern means (`*`, `?`, `objects`, `robots`), or the body or geom of that
  // name; empty if there are none.
  std::vector<std::string> Matching(const std::string& pattern);
  // Throws NotFoundError with the targets, which `place` begins, for a pattern that means none of
  // them and none of `others`, such as objects of other starts.
  void RequireMatch(const std::string& pattern, const std::vector<std::string>& others,
                    const std::string& place);
  bool Has(const std::string& target);
  // Throws NotFoundError with the targets.
  const RandomizedTarget& At(const std::string& name, const std::string& place);

 private:
  void Bind();
  RandomizedTarget Resolve(const std::string& name, int root) const;
  std::optional<RandomizedTarget> ResolveElement(const std::string& name) const;

  Scene scene_;
  uint64_t generation_ = 0;
  std::deque<RandomizedTarget> targets_;
};

}  // namespace robocell::internal
