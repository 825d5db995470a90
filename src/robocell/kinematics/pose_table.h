// PoseTable: a chain's numbers joint by joint, for the kernel that works on many configurations at
// once (pose_kernel.h). It contains everything that can be computed once for a chain.
//
// Frames are normal ones (normal_frames.h), but left-handed: y points the opposite way. So a step
// from one to the next is a reflection in x and y, by the hinge, after one in y and z, by the
// twist, which usually swaps these two. A reflection is its own inverse, and no number changes its
// sign on the way. The first joint's step comes from the base, whose axes are unchanged; all others
// have the second axis reversed at both ends.
//
// Plain numbers only; this header is included by code for every instruction set.
#pragma once

#include "robocell/kinematics/joint_count.h"

namespace robocell {
struct ChainModel;
}

namespace robocell::internal {

struct PoseJoint {
  enum class Twist : unsigned char { kQuarter, kNone, kAboutX, kAny };

  Twist twist = Twist::kAny;
  bool slide = false;
  // True for values other than 0: the parts of the translation, and the sums behind the joint.
  bool shifted[3] = {};
  bool heavy = false, weighs = false;
  double twist_cosine = 1, twist_sine = 0;  // not for kAny
  // The twisted axes, right-handed, column by column, and the origin, from the previous joint. For
  // the first joint PoseTable::origin is the origin.
  double rotation[9] = {};
  double translation[3] = {};
  double reference = 0;
  double turns = 1;  // 0 for a slide
  // Base inertial parameters of the link (base_inertial_parameters.h). Behind a hinge these are 0:
  // both masses, z of both moments, and yy of the inertia, which is xx, yy, zz, xy, xz, yz.
  double mass = 0;
  double moment[3] = {};
  double inertia[6] = {};
  double weight_mass = 0;
  double weight_moment[3] = {};
  double armature = 0;
  // Sums over the link and those behind it.
  double mass_behind = 0;
  double weight_behind = 0;
};

struct PoseTable {
  int n = 0;
  // True for hinges only, where twists behind the first one are a quarter turn or none, and there
  // is no shift along y.
  bool plain = false;
  PoseJoint joints[kMaxChainJoints];
  double origin[3] = {};        // kernels count from here, so that far bases cost no digits
  double tip_rotation[9] = {};  // column by column
  double tip_translation[3] = {};
};

PoseTable TabulatePoses(const ChainModel& chain);

}  // namespace robocell::internal
