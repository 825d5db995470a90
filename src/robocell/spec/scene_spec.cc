#include "robocell/spec/scene_spec.h"

#include <set>

#include "robocell/spec/timestep.h"
#include "robocell/spec/validate.h"

namespace robocell {
namespace {

// Checks given names only; the others are made unique later.
void ValidateRobotNames(const List<RobotSpec>& robots, Problems& problems) {
  std::set<std::string> seen;
  for (size_t i = 0; i < robots.size(); ++i) {
    if (!robots[i].name || seen.insert(*robots[i].name).second) continue;
    Problems::Scope list(problems, "robots");
    Problems::Scope item(problems, i);
    problems.AddAt("name", "'" + *robots[i].name + "' is used twice; each robot needs its own");
  }
}

template <class T>
std::vector<std::string> NamesOf(const List<T>& list) {
  std::vector<std::string> names;
  for (const T& item : list) names.push_back(item.name);
  return names;
}

}  // namespace

void SceneSpec::Validate(Problems& problems) const {
  ValidateNotEmpty(name, "name", "scenes are named in messages", problems);
  if (!base) {
    if (!timestep)
      problems.AddAt("timestep", "is required without a base scene, for example 0.002 (seconds)");
    if (!add_floor) problems.AddAt("add_floor", "is required without a base scene: true or false");
    if (!add_skybox)
      problems.AddAt("add_skybox", "is required without a base scene: true or false");
  }
  if (timestep) internal::ValidateTimestep(*timestep, 1, "timestep", problems);
  // A robot that is part of another robot's model has that robot's prefix.
  std::vector<std::string> prefixes;
  for (const RobotSpec& robot : robots) {
    const std::string of_its_own = "of the robot at " + std::to_string(prefixes.size());
    prefixes.push_back(robot.part_of.empty() ? robot.prefix : of_its_own);
  }
  ValidateUnique(prefixes, "robots", "prefix", problems);
  ValidateRobotNames(robots, problems);
  ValidateUnique(NamesOf(objects), "objects", "name", problems);
  ValidateUnique(NamesOf(cameras), "cameras", "name", problems);
}

}  // namespace robocell
