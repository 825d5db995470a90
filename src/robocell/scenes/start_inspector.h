// StartInspector: checks whether an episode can begin in the present state of a scene: its objects
// touch no robot, are inside nothing, and have a support; no robot is inside of anything.
//
//   StartInspector inspector(scene, {"cube"});
//   scene.Reset(options);
//   if (const std::string why = inspector.WhyNot(); !why.empty()) ...   // "'cube' touches ..."
//
// It reads the contacts and poses of the evaluation that ended the reset and casts five rays for
// each object, so that it costs a fraction of that evaluation. Settle (settle.h) simulates instead,
// and is for starts that are tried once. Throws NotFoundError for unknown objects. Threads: those
// of the scene.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/scene/scene.h"

namespace robocell::internal {

// A robot that is inside something, as a sentence: "robot 'left' (link2) is 40 mm inside cup".
struct RobotOverlap {
  std::string robot;
  std::string text;
  std::string object = {};  // the object that it is inside; "" for anything else
};

class StartInspector {
 public:
  // `objects`: the names of the free objects that have to lie still.
  StartInspector(Scene scene, std::vector<std::string> objects);

  // Returns "" for a good start, else its first problem.
  std::string WhyNot();
  // Returns robots that are deeper than kInside in foreign bodies, with the depth.
  // A pair of robots is listed once, with its deepest contact.
  std::vector<RobotOverlap> RobotsInside();
  // Returns robots whose own parts penetrate each other by more than kInside, with the largest
  // depth. Adjacent links and parts of a hand do not count.
  std::vector<std::string> RobotsInsideThemselves();
  // Accepts the present state: bodies that the robots are inside of now no longer count, because
  // models and cells have such places; objects may start as high above their support as now; and
  // those that reach over its edge now may do so.
  void Accept();
  // Returns the same starts, with each object lowered onto its support if Accept found it slightly
  // above: by some millimetres, and no more than kMostSettling. Higher ones are meant to drop.
  BodyPoses Lowered(BodyPoses starts) const;
  // Lets objects be without a support: for those that rest on geoms which a ray misses.
  void AcceptGaps() { needs_support_ = false; }

  static constexpr double kInside = 0.002;  // metres; contacts at rest penetrate less

 private:
  using Pair = std::pair<int, int>;  // bodies, the robot's first
  struct Object {
    std::string name;
    int body = -1;
    std::vector<int> geoms;  // colliding geoms
    double most_gap = 0;     // under it, metres
    bool may_reach_over = false;
  };
  struct Gap {
    double height;  // infinite with nothing under it
    int geom;       // geom below it
  };

  void Bind();
  void MarkRobots();
  void MarkHand(const RobotRecord& robot);
  bool AreParts(const Pair& bodies) const;  // true for parts of one robot that must not overlap
  std::string TouchOf(int contact) const;
  std::vector<Pair> RobotPairs();
  std::optional<Pair> RobotPair(int contact) const;
  std::string FallOf(const Object& object) const;
  Gap GapUnder(const Object& object) const;
  bool ReachesOver(const Object& object) const;
  std::string RobotText(int body) const;

  Scene scene_;
  std::vector<std::string> names_;
  uint64_t generation_ = ~uint64_t{0};
  std::vector<Object> objects_;
  std::vector<std::string> robots_;  // names, of those that stand for themselves
  std::vector<int> robot_of_;        // per body, index into robots_ or -1
  std::vector<int> hand_of_;         // per body, the hand's lowest body or -1
  std::vector<int> object_of_;       // per body, index into objects_ or -1
  std::vector<Pair> accepted_;
  std::vector<std::pair<std::string, Eigen::Vector3d>> lowering_;  // per body, in the world
  bool needs_support_ = true;
};

// Returns, as sentences, fixed objects that hang in the air: objects whose model has no joint
// although they are not declared as fixed, and that are near nothing. `objects` are their names.
std::vector<std::string> HangingObjects(const Scene& scene,
                                        const std::vector<std::string>& objects);

// Returns robots whose fixed parts are below a floor (a plane). The engine does not report it: two
// fixed bodies never touch.
std::vector<RobotOverlap> RobotsInTheFloor(const Scene& scene);

// Returns, as sentences, free objects whose centre is below a floor (a plane): they are shot out of
// it.
std::vector<std::string> ObjectsInTheFloor(const Scene& scene);

// Returns, as sentences, free objects that are deep inside something other than a robot: they are
// pushed apart. Excludes those of ObjectsInTheFloor.
std::vector<std::string> ObjectsInside(const Scene& scene);

// Returns, as sentences, objects that are larger than a room: their sizes may be in millimetres.
// Fixed ones only count by their thickness, because floors and walls are large.
std::vector<std::string> ObjectsInMillimetres(const Scene& scene);

// Returns free objects without any support in their present pose. Excludes those in the floor.
std::vector<std::string> ObjectsOverNothing(const Scene& scene);

}  // namespace robocell::internal
