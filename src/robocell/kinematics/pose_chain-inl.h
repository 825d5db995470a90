// A chain as the kernel walks along it: the motions of its joints, the kinds of its steps, and
// loops over them. Included once for each instruction set, after lane_math-inl.h and
// pose_numbers-inl.h.
#include <hwy/highway.h>

#include "robocell/kinematics/pose_table.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The effect of a joint value on the joint's frame.
struct Move {
  P sine, cosine;  // 0 and 1 for a slide
  P shift;         // displacement of a slide
};

class JointMoves {
 public:
  static HWY_INLINE int PairsOf(int joints) { return (joints + 1) / 2; }

  // Processes joints in pairs, because neither waits for the other and both need the same
  // constants. Calls meanwhile() with each pair.
  template <class Meanwhile>
  HWY_INLINE JointMoves(const PoseTable& t, const Inputs& q, Meanwhile&& meanwhile) {
    int i = 0;
    for (; i + 2 <= t.n; i += 2) {
      Put(t, q, i);
      meanwhile();
      Put(t, q, i + 1);
    }
    if (i == t.n) return;
    Put(t, q, i);
    meanwhile();
  }

  HWY_INLINE Move operator[](int i) const {
    return {values_.Get(i, 0), values_.Get(i, 1), values_.Get(i, 2)};
  }

 private:
  HWY_INLINE void Put(const PoseTable& t, const Inputs& q, int i) {
    const PoseJoint& joint = t.joints[i];
    const P off = hn::Sub(q[i], All(joint.reference));
    P sine, cosine;
    SinCosOfAny(kPoses, hn::Mul(All(joint.turns), off), &sine, &cosine);
    values_.Put(i, 0, sine);
    values_.Put(i, 1, cosine);
    values_.Put(i, 2, off);
  }

  JointNumbers<3> values_;  // values in the form of a Move
};

// The parts of a step: from the table, or known at compile time.
struct AnyStep {
  const PoseJoint& joint;
  HWY_INLINE PoseJoint::Twist twist() const { return joint.twist; }
  HWY_INLINE bool slide() const { return joint.slide; }
  HWY_INLINE bool shifted(int axis) const { return joint.shifted[axis]; }
  HWY_INLINE bool heavy() const { return joint.heavy; }
  HWY_INLINE bool weighs() const { return joint.weighs; }
};
struct PlainStep {
  using enum PoseJoint::Twist;
  const PoseJoint& joint;
  HWY_INLINE PoseJoint::Twist twist() const { return joint.twist == kQuarter ? kQuarter : kNone; }
  HWY_INLINE bool slide() const { return false; }
  HWY_INLINE bool shifted(int axis) const { return axis != 1 && joint.shifted[axis]; }
  HWY_INLINE bool heavy() const { return false; }
  HWY_INLINE bool weighs() const { return false; }
};

// Loops over a chain's joints: of any chain, and of a plain one with a fixed number of joints,
// whose loops are unrolled, which saves a third of a mass matrix's instructions.
struct AnyChain {
  const PoseTable& t;
  HWY_INLINE int n() const { return t.n; }
  HWY_INLINE AnyStep operator[](int i) const { return {t.joints[i]}; }
  template <class Visit>
  HWY_INLINE void Up(int first, int last, Visit&& visit) const {
    for (int i = first; i <= last; ++i) visit(i);
  }
  template <class Visit>
  HWY_INLINE void Down(int last, int first, Visit&& visit) const {
    for (int i = last; i >= first; --i) visit(i);
  }
};
template <int kJoints>
struct PlainChain {
  const PoseTable& t;
  HWY_INLINE constexpr int n() const { return kJoints; }
  HWY_INLINE PlainStep operator[](int i) const { return {t.joints[i]}; }
  template <class Visit>
  HWY_INLINE void Up(int first, int last, Visit&& visit) const {
#pragma GCC unroll 16
    for (int i = first; i <= last; ++i) visit(i);
  }
  template <class Visit>
  HWY_INLINE void Down(int last, int first, Visit&& visit) const {
#pragma GCC unroll 16
    for (int i = last; i >= first; --i) visit(i);
  }
};

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
