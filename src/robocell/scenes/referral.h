// Referral expressions: words that mean one object of a scene and no other, such as "the red mug" or
// "the mug left of the laptop".
//
//   const std::vector<ReferableObject> objects = ReferableObjects(scene, annotations.objects);
//   const std::vector<std::string> ways = ReferralsTo(objects, "mug_1", Viewer::Of(base_in_world));
//   ways.front()   // the simplest one
//
// An expression holds clearly for its object and clearly not for every other object that its noun
// could fit: what is in doubt is not said. An object without a known colour may be a red one. Left,
// right, behind and in front are those of the viewer, and so are the nearest and the farthest.
#pragma once

#include <span>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/math/pose.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/scene_annotations.h"

namespace robocell {

// An object that words may mean, or that helps to say where another one is.
struct ReferableObject {
  std::string object;              // its name in the scene
  std::vector<std::string> nouns;  // "mug", "red mug", without an article; the plainest first
  Eigen::Vector3d low = Eigen::Vector3d::Zero(),
                  high = Eigen::Vector3d::Zero();  // its box in the world
  bool has_hollow = false;                         // others can be in it
};

// Somebody who looks at the objects: a place, and the horizontal direction that is straight ahead.
struct Viewer {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d forward = Eigen::Vector3d::UnitX();

  // Of a robot's base: it looks along x.
  static Viewer Of(const Pose& base_in_world) {
    return {base_in_world.translation(), base_in_world.rotation().col(0)};
  }
};

// Relations of an object to another one, as a viewer sees them.
enum class SeenRelation { kOn, kIn, kLeftOf, kRightOf, kInFrontOf, kBehind, kNextTo };
// Answers are yes, no, or neither: the two are so placed that people could disagree.
enum class Answer { kNo, kInDoubt, kYes };
// Returns whether `object` has the relation to `landmark`.
Answer Holds(SeenRelation relation, const ReferableObject& object, const ReferableObject& landmark,
             const Viewer& viewer);
// Returns its words: "left of".
std::string WordsOf(SeenRelation relation);

// Returns the objects of a scene that have words: those given, and the scene's own objects by their
// models and colours. Parked objects and names that the scene does not have are left out. Poses are
// up to date.
std::vector<ReferableObject> ReferableObjects(const Scene& scene,
                                              std::span<const ObjectWords> known = {},
                                              std::span<const Container> containers = {});

// Returns the expressions that mean the object, the simplest first; empty if there are none. Throws
// NotFoundError for a name that is not among the objects.
std::vector<std::string> ReferralsTo(std::span<const ReferableObject> objects,
                                     const std::string& object, const Viewer& viewer);

}  // namespace robocell
