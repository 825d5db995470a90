#include "robocell/kinematics/chain_batch.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numeric>

#include "robocell/base/error.h"
#include "robocell/kinematics/lane_chain.h"
#include "robocell/kinematics/pose_kernel.h"

namespace robocell {

namespace {

// Adds up NaN for values that are not finite, in several independent sums.
bool AllFinite(std::span<const double> values) {
  constexpr size_t kSums = 8;
  double nothing[kSums] = {};
  const size_t whole = values.size() / kSums * kSums;
  for (size_t first = 0; first < whole; first += kSums) {
#pragma GCC unroll 8
    for (size_t k = 0; k < kSums; ++k) nothing[k] += 0 * values[first + k];
  }
  for (const double value : values.subspan(whole)) nothing[0] += 0 * value;
  return std::accumulate(nothing, nothing + kSums, 0.0) == 0;
}

// Checks the arguments of one batch and splits them into rows.
class BatchRows {
 public:
  BatchRows(const Chain& chain, std::span<double> out, size_t per_row)
      : chain_(chain), count_(out.size() / per_row) {
    if (out.size() == count_ * per_row) return;
    throw ArgumentError(fmt::format("{}: the output has {} numbers, which are not whole rows of {}",
                                    chain.description(), out.size(), per_row));
  }

  size_t count() const { return count_; }

  void RequireTips(std::span<const double> tips) const {
    if (tips.size() == 16 * count_) return;
    throw ArgumentError(
        fmt::format("{}: tips: expected 16 numbers for each of {} configurations; got {}",
                    chain_.description(), count_, tips.size()));
  }

  internal::PoseRows Joints(std::string_view what, std::span<const double> values) const {
    const size_t n = static_cast<size_t>(chain_.n_joints());
    const internal::PoseRows rows = Rows(what, values, n);
    if (AllFinite(values)) return rows;
    for (size_t row = 0;; ++row) {
      const auto of_row = values.subspan(row * n, n);
      if (!AllFinite(of_row))
        chain_.RequireJointValues(
            values.size() == n ? std::string(what) : fmt::format("{}[{}]", what, row), of_row);
    }
  }

  internal::PoseRows Gravity(std::span<const double> values) const {
    const internal::PoseRows rows = Rows("gravity", values, 3);
    if (AllFinite(values)) return rows;
    throw ArgumentError(chain_.description() + ": gravity has numbers that are not finite");
  }

 private:
  internal::PoseRows Rows(std::string_view what, std::span<const double> values,
                          size_t per_row) const {
    if (values.size() == per_row) return {values.data(), 0};
    if (values.size() == count_ * per_row) return {values.data(), per_row};
    throw ArgumentError(
        fmt::format("{}: {}: expected {} numbers, or {} for each of {} configurations; got {}",
                    chain_.description(), what, per_row, per_row, count_, values.size()));
  }

  const Chain& chain_;
  size_t count_;
};

void Run(const Chain& chain, internal::PosePart part, const internal::PoseQuery& query,
         std::span<double> out) {
  internal::ComputePoses(chain.lanes().poses(), part, query, out.data());
}

}  // namespace

void FkBatch(const Chain& chain, std::span<const double> q, std::span<double> tips) {
  const BatchRows batch(chain, tips, 16);
  Run(chain, internal::PosePart::kTip, {.count = batch.count(), .q = batch.Joints("q", q)}, tips);
}

void JacobianBatch(const Chain& chain, std::span<const double> q, std::span<double> jacobians) {
  const BatchRows batch(chain, jacobians, 6 * static_cast<size_t>(chain.n_joints()));
  Run(chain, internal::PosePart::kJacobian, {.count = batch.count(), .q = batch.Joints("q", q)},
      jacobians);
}

void JacobianBatch(const Chain& chain, std::span<const double> q, std::span<double> jacobians,
                   std::span<double> tips) {
  const BatchRows batch(chain, jacobians, 6 * static_cast<size_t>(chain.n_joints()));
  batch.RequireTips(tips);
  internal::ComputePoses(chain.lanes().poses(), internal::PosePart::kJacobian,
                         {.count = batch.count(), .q = batch.Joints("q", q)}, jacobians.data(),
                         tips.data());
}

void GravityTorquesBatch(const Chain& chain, std::span<const double> q,
                         std::span<const double> gravity_in_base, std::span<double> torques) {
  const BatchRows batch(chain, torques, static_cast<size_t>(chain.n_joints()));
  Run(chain, internal::PosePart::kGravity,
      {.count = batch.count(),
       .q = batch.Joints("q", q),
       .gravity = batch.Gravity(gravity_in_base)},
      torques);
}

void MassMatrixBatch(const Chain& chain, std::span<const double> q, std::span<double> masses) {
  const auto n = static_cast<size_t>(chain.n_joints());
  const BatchRows batch(chain, masses, n * n);
  Run(chain, internal::PosePart::kMass, {.count = batch.count(), .q = batch.Joints("q", q)},
      masses);
  for (const JointCoupling& c : chain.couplings()) {
    const auto first = static_cast<size_t>(c.first), second = static_cast<size_t>(c.second);
    for (double* mass = masses.data(); mass < masses.data() + masses.size(); mass += n * n) {
      mass[first * n + second] += c.inertia;
      mass[second * n + first] += c.inertia;
    }
  }
}

void CoriolisTorquesBatch(const Chain& chain, std::span<const double> q, std::span<const double> qd,
                          std::span<double> torques) {
  const std::array<double, kMaxChainJoints> still{};
  const std::array<double, 3> weightless{};
  InverseDynamicsBatch(chain, q, qd, std::span(still).first(static_cast<size_t>(chain.n_joints())),
                       weightless, torques);
}

void ManipulabilityBatch(const Chain& chain, std::span<const double> q, std::span<double> values) {
  const BatchRows batch(chain, values, 1);
  Run(chain, internal::PosePart::kManipulability,
      {.count = batch.count(), .q = batch.Joints("q", q)}, values);
}

void InverseDynamicsBatch(const Chain& chain, std::span<const double> q, std::span<const double> qd,
                          std::span<const double> qdd, std::span<const double> gravity_in_base,
                          std::span<double> torques) {
  const auto n = static_cast<size_t>(chain.n_joints());
  const BatchRows batch(chain, torques, n);
  const internal::PoseQuery query{.count = batch.count(),
                                  .q = batch.Joints("q", q),
                                  .qd = batch.Joints("qd", qd),
                                  .qdd = batch.Joints("qdd", qdd),
                                  .gravity = batch.Gravity(gravity_in_base)};
  Run(chain, internal::PosePart::kMotion, query, torques);
  for (const JointCoupling& c : chain.couplings()) {
    for (size_t row = 0; row < batch.count(); ++row) {
      const double* change = query.qdd.data + row * query.qdd.stride;
      double* torque = torques.data() + row * n;
      torque[c.first] += c.inertia * change[c.second];
      torque[c.second] += c.inertia * change[c.first];
    }
  }
}

}  // namespace robocell
