// PreparedObjects: the free objects of an environment whose place is drawn at each reset: those
// that its task's Prepare added without a pose, which are put on a support as in runs, and those
// that `places` of the configuration or of the task put in relation to something. A placement by
// relation holds for any result of the task's Starts; Arrange may move everything.
//
//   PreparedObjects prepared(scene, config, task.get());
//   const Drawn drawn = prepared.Draw(starts, rng);   // and adds them to `starts`
//   scene.Reset({.body_poses = starts});  task.Arrange(...);
//   if (const std::string lost = prepared.Unplaced(); !lost.empty()) ...   // nobody placed it
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/place_links.h"
#include "robocell/scenes/related_places.h"
#include "robocell/scenes/support.h"
#include "robocell/spec/env_config.h"
#include "robocell/spec/locations.h"
#include "robocell/spec/scene_object.h"
#include "robocell/task/task.h"

namespace robocell::internal {

// Returns true for poses that differ by rounding alone.
bool IsSamePlace(const Pose& a, const Pose& b);

class PreparedObjects {
 public:
  // Looks for supports within reach of each robot of the configuration. The scene is at its reset
  // state, and is left there. `task` may be null. SpecError lists all that is wrong with `places`.
  PreparedObjects(const Scene& scene, const EnvConfig& config, Task* task);

  bool empty() const { return names().empty(); }
  // Returns the objects in the order in which they were added to the scene.
  std::vector<std::string> names() const;
  // Those that are put on a support.
  std::vector<std::string> names_on_support() const;
  // Returns true if a robot reaches a support with room for the objects that need one.
  bool has_support() const { return loose_.empty() || !places_.empty(); }

  struct Drawn {
    BodyPoses added;
    std::string why_not;  // "" unless an object has no place
  };
  // Draws a robot and places for all objects that `starts` does not place, and adds them. Does
  // nothing if they fit nowhere; Unplaced names them.
  Drawn Draw(BodyPoses& starts, Rng& rng);
  // Returns the names of those that lie at their compiled pose, which was not chosen.
  std::vector<std::string> Unplaced() const;
  // Those that are where Draw put them.
  std::vector<std::string> PlacedHere(const BodyPoses& added) const;
  // Returns advice about objects without a place: the end of a message.
  std::string Advice() const;

 private:
  // A place of objects on a support in reach of a robot.
  struct Place {
    Robot robot;
    Support patch;       // around it, of the support
    BaseRange distance;  // range of the first object's distance from the robot's base
  };
  void RequireObjects(const EnvConfig& config, Task& task) const;
  void FindObjects(const EnvConfig& config);
  void ResolveModel(SceneObject& object) const;
  void Relate(const EnvConfig& config);
  std::vector<std::string> PresentParts() const;
  void RelateParts(std::vector<std::string> parts);
  void FindSupports(const EnvConfig& config, Task* task);
  bool IsRelated(size_t i) const { return related_ && related_->IsRelated(i); }
  bool IsLoose(size_t i) const;
  std::vector<Support> SupportsAround(const std::vector<Robot>& robots) const;
  std::vector<Place> PlacesOf(const Robot& robot, const std::vector<Support>& supports,
                              const BaseRange& wanted) const;
  bool PutLoose(const Place& place, std::vector<SceneObject>& objects, Rng& rng) const;
  std::vector<SceneObject> ObjectsAt(const BodyPoses& starts) const;

  Scene scene_;
  Task* task_;
  std::string place_;  // "environment 'duo'"
  Locations locations_;
  // All that can move, as they are in the world; without a pose if they were added without one.
  std::vector<SceneObject> objects_;
  std::vector<std::string> bodies_;  // bodies of objects_
  std::vector<ObjectSize> sizes_;
  std::vector<Pose> compiled_;  // their poses after a reset
  std::vector<size_t> added_;   // those that were added without a pose
  std::vector<size_t> loose_;   // of them, those that are put on a support in this start
  std::vector<StatedPlaces> stated_;
  std::vector<SceneObject> placed_;  // objects_ without the poses that stated_ replaces
  std::vector<std::string> kinds_;   // their kinds
  // The names of the task that stand for objects in this start (Task::object_of), "" for none.
  std::vector<std::string> parts_;
  std::optional<RelatedPlaces> related_;
  std::shared_ptr<const Landmarks>
      landmarks_;              // landmarks of all bodies but objects_; set with related_
  std::vector<Place> places_;  // one for each robot with any
};

}  // namespace robocell::internal
