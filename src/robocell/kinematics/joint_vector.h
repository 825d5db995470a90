// JointVector: up to kMaxChainJoints joint values on the stack, so that kinematics never touches
// the heap.
//
// Values are in chain order: radians for hinges, metres for slides. Converts to std::span
// implicitly.
//
//   JointVector q{0, 0.3, 0, -1.2, 0, 1.5, 0};
//   Pose tip = chain.Fk(q);
#pragma once

#include <array>
#include <cmath>
#include <initializer_list>
#include <span>
#include <string>

#include "robocell/base/error.h"
#include "robocell/kinematics/joint_count.h"

namespace robocell {

class JointVector {
 public:
  JointVector() = default;
  explicit JointVector(int size, double value = 0) : size_(Checked(size)) {
    for (double& v : *this) v = value;
  }
  JointVector(std::initializer_list<double> values)
      : JointVector(std::span<const double>(values.begin(), values.size())) {}
  explicit JointVector(std::span<const double> values) : size_(Checked(values.size())) {
    for (int i = 0; i < size_; ++i) values_[i] = values[i];
  }

  int size() const { return size_; }
  bool empty() const { return size_ == 0; }
  double* data() { return values_.data(); }
  const double* data() const { return values_.data(); }
  double* begin() { return data(); }
  double* end() { return data() + size_; }
  const double* begin() const { return data(); }
  const double* end() const { return data() + size_; }
  double& operator[](int i) { return values_[i]; }
  double operator[](int i) const { return values_[i]; }
  bool operator==(const JointVector&) const = default;

 private:
  static int Checked(std::size_t size) {
    if (size > kMaxChainJoints) {
      throw ArgumentError("a joint vector holds at most " + std::to_string(kMaxChainJoints) +
                          " values, got " + std::to_string(size));
    }
    return static_cast<int>(size);
  }

  std::array<double, kMaxChainJoints> values_{};
  int size_ = 0;
};

}  // namespace robocell
