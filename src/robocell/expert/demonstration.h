// Demonstration: an episode as a source for others: what the TCP and the gripper did, where the
// objects were, and the segments in which the hand is in contact with one of them.
//
//   Demonstration demo = {...};                 // one value for each row
//   demo.segments = FindSegments(demo);
//
// Between two segments the hand moves through free space. A segment refers to one object, so that it
// can be repeated wherever that object is (augment_expert.h). The idea is that of MimicGen
// (A. Mandlekar et al., 2023) and SkillGen (C. Garrett et al., 2024).
//
// Segments follow the names of the phases where some of them are of motions through free space
// (IsFreePhase); otherwise they are the surroundings of the gripper's opening and closing, and
// without those the whole episode is one segment. Segments that move nothing are left out.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/expert/expert.h"
#include "robocell/math/pose.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/task_sampler.h"

namespace robocell::internal {

struct DemoSegment {
  int first = 0, end = 0;      // rows
  std::string reference = {};  // the object that it refers to; "": the root frame
  std::string held = {};       // the object in the hand at the first row; "": none
};

struct Demonstration {
  std::string episode = {};  // its id
  std::string object_kind = {};
  double tick = 0.066;                     // seconds between rows
  std::vector<Pose> base_in_world = {};    // of the robot, before the action of each row
  Pose root_in_world = {};                 // the root frame of the scene
  std::vector<Pose> tcp_in_world = {};     // before the action of each row
  std::vector<Pose> target_in_world = {};  // of the TCP, after it
  std::vector<double> opening = {};        // of the gripper, commanded; empty without one
  std::vector<int> phase = {};             // index into `phases`; empty without
  std::vector<std::string> phases = {};
  // Poses of objects, and of bodies that joints of objects move, before the action of each row.
  std::map<std::string, std::vector<Pose>> bodies = {};
  std::vector<DemoSegment> segments = {};

  int rows() const { return static_cast<int>(target_in_world.size()); }
};

// Returns true for the names of phases in which the hand moves through free space: "pregrasp",
// "transfer", "reach", "move" etc.
bool IsFreePhase(std::string_view phase);
// Returns true if the phases of an episode tell its segments.
bool HasSegmentLabels(const Demonstration& demo);
std::vector<DemoSegment> FindSegments(const Demonstration& demo);

using Demonstrations = std::shared_ptr<const std::vector<Demonstration>>;
// Returns the expert that repeats one of these, which have segments, from the start of a run with
// `augment` (augment_expert.h).
std::shared_ptr<Expert> MakeAugmentExpert(const RunConfig& run, const EpisodeStart& start,
                                          Demonstrations sources);

}  // namespace robocell::internal
