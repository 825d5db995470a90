// Numbers of many configurations at once: one for all, and those of each joint. Included once for
// each instruction set, after link_math-inl.h and pose_rows-inl.h.
#include <hwy/highway.h>

#include "robocell/kinematics/joint_count.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Forces inlining of lambdas that compilers consider too long.
#undef POSE_INLINE
#define POSE_INLINE HWY_ATTR __attribute__((always_inline))

HWY_INLINE P All(double value) { return hn::Set(kPoses, value); }
HWY_INLINE Vec3<P> All(const double* v) { return {All(v[0]), All(v[1]), All(v[2])}; }
HWY_INLINE Vec3<P> ZeroVector() { return {hn::Zero(kPoses), hn::Zero(kPoses), hn::Zero(kPoses)}; }
HWY_INLINE Symmetric3<P> AllOf(const double* s) {
  return {All(s[0]), All(s[1]), All(s[2]), All(s[3]), All(s[4]), All(s[5])};
}

// A fixed number of values of each joint, one by one: compilers copy structs in pieces, and then
// wait for the pieces when they need a whole register.
template <int kNumbers>
class JointNumbers {
 public:
  HWY_INLINE void Put(int joint, int k, P value) { hn::Store(value, kPoses, values_[joint][k]); }
  HWY_INLINE P Get(int joint, int k) const { return hn::Load(kPoses, values_[joint][k]); }

 private:
  alignas(64) double values_[kMaxChainJoints][kNumbers][kWidth];
};
class JointVectors {
 public:
  HWY_INLINE void Put(int joint, const Vec3<P>& v) {
    values_.Put(joint, 0, v.x);
    values_.Put(joint, 1, v.y);
    values_.Put(joint, 2, v.z);
  }
  HWY_INLINE Vec3<P> operator[](int joint) const {
    return {values_.Get(joint, 0), values_.Get(joint, 1), values_.Get(joint, 2)};
  }

 private:
  JointNumbers<3> values_;
};
class JointSixes {
 public:
  HWY_INLINE void Put(int joint, const Six<P>& v) {
    linear_.Put(joint, v.linear);
    angular_.Put(joint, v.angular);
  }
  HWY_INLINE Six<P> operator[](int joint) const { return {linear_[joint], angular_[joint]}; }

 private:
  JointVectors linear_, angular_;
};

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
