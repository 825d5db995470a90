// PreparedObjects: the free objects that a task's Prepare added to an environment's scene without
// saying where they are. As in runs they get places on a support, drawn at each reset; the task may
// put them elsewhere in Starts or Arrange.
//
//   PreparedObjects prepared(scene, config, *task);
//   prepared.AddPlaces(starts, rng);              // of those that `starts` does not place
//   scene.Reset({.body_poses = starts});  task.Arrange(...);
//   if (const std::string lost = prepared.Unplaced(); !lost.empty()) ...   // nobody placed it
#pragma once

#include <map>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/support.h"
#include "robocell/spec/env_config.h"
#include "robocell/task/task.h"

namespace robocell::internal {

class PreparedObjects {
 public:
  // Looks for supports within reach of each robot of the configuration. The scene is at its reset
  // state, and is left there.
  PreparedObjects(const Scene& scene, const EnvConfig& config, const Task& task);

  bool empty() const { return objects_.empty(); }
  // In the order in which they were added.
  std::vector<std::string> names() const;
  // Whether a robot has a support within reach with room for all of them.
  bool has_support() const { return !places_.empty(); }

  // Draws a robot and places for all objects that `starts` does not place, and adds them. Does
  // nothing when they fit nowhere; Unplaced names them.
  void AddPlaces(BodyPoses& starts, Rng& rng) const;
  // The names of those that lie where they were compiled, which nobody chose.
  std::vector<std::string> Unplaced() const;
  // Those that are where the last AddPlaces put them.
  std::vector<std::string> PlacedHere(const BodyPoses& starts) const;
  // What to do about objects without a place: the end of a message.
  std::string Advice() const;

 private:
  // Where a robot can reach objects on a support.
  struct Place {
    Robot robot;
    Support patch;       // around it, of the support
    BaseRange distance;  // of the first object from the robot's base
  };
  std::vector<Place> PlacesOf(const Robot& robot, const std::vector<Support>& supports,
                              const BaseRange& wanted) const;
  bool TryPlaces(const Place& place, BodyPoses& starts, Rng& rng) const;

  Scene scene_;
  std::vector<SceneObject> objects_;
  std::vector<std::string> bodies_;  // of objects_
  std::vector<ObjectSize> sizes_;
  std::vector<Pose> compiled_;  // where they lie in a scene that was reset
  std::vector<Place> places_;   // one for each robot that has any
};

}  // namespace robocell::internal
