// The joints that move with given ones (couplings.h), and the range that their limits leave.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "robocell/mujoco/couplings.h"

namespace robocell::internal {

struct JointRange {
  double lower = 0, upper = 0;
};

// Returns whether a constraint between joints has one of these: without one no joint follows them,
// which is known without composing the constraints of the others.
bool AreCoupled(const mjModel* model, std::span<const int> joints);

// A joint that follows one of a list; it may be in any part of the model.
struct JointFollower {
  int joint = -1;
  std::size_t leader = 0;  // index in the list
  JointPolynomial of_leader;
};

// Returns the joints that follow those of the list and are not in it. A joint of the list may itself
// follow one outside of it, or be led by one: as long as that is affine, all others follow it too.
// Joints of -1 are left out.
std::vector<JointFollower> FollowersOf(const mjModel* model, std::span<const int> joints);

// Returns the indices in the list of joints that follow another one of it, with their leader there.
// If several follow a joint outside, the first one leads the others.
struct ListedFollower {
  std::size_t index = 0, leader = 0;
  JointPolynomial of_leader;
};
std::vector<ListedFollower> FollowersAmong(const mjModel* model, std::span<const int> joints);

// Returns the values of a polynomial that is monotone over a range; ends may be infinite if it is
// affine.
JointRange ImageOf(const JointPolynomial& polynomial, const JointRange& range);
// Returns true if a polynomial does not turn back in a finite range.
bool IsMonotone(const JointPolynomial& polynomial, const JointRange& range);
// Returns the part of a leader's range in which its follower is within its own; an empty one
// (lower > upper) if there is none. The polynomial must be monotone there.
JointRange RangeWithin(const JointPolynomial& polynomial, const JointRange& leader,
                       const JointRange& follower);

// Returns the limits of a joint; +-infinity without.
JointRange LimitsOf(const mjModel* model, int joint);

}  // namespace robocell::internal
