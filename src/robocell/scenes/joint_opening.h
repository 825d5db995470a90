// JointOpening: how far a door, a drawer, a lid or a button is open, as a share of its range.
//
//   const JointOpening drawer = JointOpening::Of(scene, "drawer");
//   if (drawer.share() > 0.3) ...
//
// Closed is the joint's reference position, moved into its range; open is the end of the range that
// is farther from there. The name is that of a hinge or slide, or of an object or body that has one
// such joint in its subtree. Throws NotFoundError for unknown names, ArgumentError for an object
// with several joints (it lists them) or none, and for a joint without limits. Threads: those of
// the scene.
#pragma once

#include <string>

#include "robocell/scene/scene.h"

namespace robocell {

class JointOpening {
 public:
  static JointOpening Of(const Scene& scene, const std::string& name);

  const std::string& joint() const { return joint_; }
  double closed() const { return closed_; }  // positions, rad or m
  double open() const { return open_; }
  double position() const { return scene_.joint_pos(joint_); }
  double share() const { return (position() - closed_) / (open_ - closed_); }
  double PositionAt(double share) const { return closed_ + share * (open_ - closed_); }
  // Moves the joint there at once, at rest. The caller calls Scene::Forward().
  void Put(double share);
  // The ids in the present model.
  int joint_id() const;
  int body_id() const;  // the body that the joint moves

 private:
  JointOpening(Scene scene, std::string joint, double closed, double open)
      : scene_(std::move(scene)), joint_(std::move(joint)), closed_(closed), open_(open) {}

  Scene scene_;
  std::string joint_;
  double closed_, open_;
};

}  // namespace robocell
