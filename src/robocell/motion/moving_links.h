// MovingLinks: the rigid parts of a model that given joints move, as a tree, with their poses.
//
// A configuration is one value for each degree of freedom (rad; m for slides), in the order of the
// given joints: of one arm, of several, of a planar base and the arms on it. Joints that follow
// them by equality constraints (mujoco/couplings.h) move too. All other joints stay where they are
// in the given data; bodies between moving joints are one link. Link 0 is everything that stays.
//
//   MovingLinks links(model, data, joints, "robot 'left'");
//   links.Place(q, poses);   // one pose in the world for each link
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "robocell/kinematics/transform.h"
#include "robocell/mujoco/couplings.h"
#include "robocell/mujoco/forward.h"

namespace robocell::internal {

class MovingLinks {
 public:
  // What one joint moves. Its frame turns about its own z axis, or shifts along it, by the value
  // of the joint less `reference`.
  struct Link {
    int parent = 0;   // index of a link before this one
    Transform fixed;  // the joint's frame at `reference` in the frame of the parent
    bool slide = false;
    int dof = 0;             // index in the configuration
    double reference = 0;    // rad or m
    JointPolynomial of_dof;  // value of the joint: the identity unless it follows
  };
  struct Dof {
    int joint = -1;  // id
    bool slide = false;
    bool limited = false;
    double lower = 0, upper = 0;  // of the joint and its followers; +-infinity without limits
  };

  // `joints`: ids. `data`: poses up to date. Throws ArgumentError, with the place, for ball and free
  // joints and for joints that appear twice or follow another one of the list.
  MovingLinks(const mjModel* model, const mjData* data, std::span<const int> joints,
              std::string_view place);

  const std::vector<Link>& links() const { return links_; }
  const std::vector<Dof>& dofs() const { return dofs_; }
  int n_dofs() const { return static_cast<int>(dofs_.size()); }
  // Returns the link that a body belongs to; 0 if it stays.
  int link_of(int body) const { return link_of_[body]; }
  // Returns the pose of a body in the frame of its link (for link 0: in the world).
  const Transform& in_link(int body) const { return in_link_[body]; }
  // Makes a body and its subtree move with a link, where it is in `data` relative to the link.
  void Attach(const mjModel* model, const mjData* data, int body, int link);

  // Computes the pose of each link in the world; link 0 is the world.
  void Place(std::span<const double> q, std::span<Transform> poses) const;

 private:
  std::vector<Link> links_;
  std::vector<Dof> dofs_;
  std::vector<int> link_of_;           // per body
  std::vector<Transform> in_link_;     // per body
  std::vector<Transform> at_present_;  // per link: its pose in the data
};

}  // namespace robocell::internal
