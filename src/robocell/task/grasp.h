// Grasp: how a hand takes hold of an object, in the frame of the object's body, so that it stays
// valid wherever the object is. grasp_generator.h computes grasps, grasp_library.h stores them,
// reachable_grasps.h selects those that an arm can reach.
//
//   const Pose tcp_in_world = body_in_world * grasp.tcp_in_body;
//   const Pose before = grasp.before() ...   // where the straight approach begins
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <Eigen/Core>

#include "robocell/math/pose.h"

namespace robocell {

enum class GraspKind {
  kTop,        // two fingers, from above: along -z of the body within 45 degrees
  kSide,       // two fingers, level within 30 degrees
  kAntipodal,  // two fingers, from any other direction
  kRim,        // the wall of an open vessel is between the fingers
  kHandle,     // a geom that is named handle or knob, or that the caller names
  kEnclosing,  // three or more fingers close around the object
  kSuction,    // a cup sticks to a face
  kPush,       // the tip of the closed hand presses on a face
  kHook,       // the closed hand is behind a bar and pulls
};
inline constexpr std::array kGraspKinds = {
    std::pair{GraspKind::kTop, std::string_view("top")},
    std::pair{GraspKind::kSide, std::string_view("side")},
    std::pair{GraspKind::kAntipodal, std::string_view("antipodal")},
    std::pair{GraspKind::kRim, std::string_view("rim")},
    std::pair{GraspKind::kHandle, std::string_view("handle")},
    std::pair{GraspKind::kEnclosing, std::string_view("enclosing")},
    std::pair{GraspKind::kSuction, std::string_view("suction")},
    std::pair{GraspKind::kPush, std::string_view("push")},
    std::pair{GraspKind::kHook, std::string_view("hook")}};
// Returns "top", "side", ...
std::string ToString(GraspKind kind);
// Throws NotFoundError with the names.
GraspKind GraspKindOf(std::string_view name);

struct Grasp {
  Pose tcp_in_body;  // the TCP in the frame of the body at contact
  GraspKind kind = GraspKind::kAntipodal;
  double opening = 0;  // free distance between the fingers during the approach, m
  double width = 0;    // at contact, m; 0 for suction, push and hook
  // Distance of the object from a pad that does not move, to which the other one pushes it, m.
  double aside = 0;
  // The straight way of the hand to the contact: a unit vector in the frame of the body, and its
  // length, m.
  Eigen::Vector3d approach = -Eigen::Vector3d::UnitZ();
  double approach_length = 0.08;
  double score = 0;  // 0 to 1; higher is better

  // The TCP in the frame of the body where the approach begins.
  Pose before() const {
    return Pose(tcp_in_body.translation() - approach_length * approach, tcp_in_body.quaternion());
  }
};

// The grasps of one body by one hand, best first.
struct GraspSet {
  std::string robot;  // name of the hand's robot
  std::string body;   // full name of the body in the scene
  std::vector<Grasp> grasps;
};

}  // namespace robocell
