#include "robocell/kinematics/chain_batch.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/kinematics/lane_chain.h"
#include "robocell/kinematics/link_answer.h"
#include "robocell/kinematics/manipulability.h"
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
    throw ArgumentError(fmt::format("{}: the output has {}, not whole rows of {}",
                                    chain.description(), Counted(std::ssize(out), "number"),
                                    per_row));
  }

  size_t count() const { return count_; }

  void RequireTips(std::span<const double> tips) const {
    if (tips.size() == 16 * count_) return;
    throw ArgumentError(fmt::format("{}: tips: expected 16 numbers for each of {}; got {}",
                                    chain_.description(), Counted(count(), "configuration"),
                                    tips.size()));
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
    throw ArgumentError(fmt::format("{}: {}: expected {}, or {} for each of {}; got {}",
                                    chain_.description(), what,
                                    Counted(static_cast<int64_t>(per_row), "number"), per_row,
                                    Counted(count(), "configuration"), values.size()));
  }

  const Chain& chain_;
  size_t count_;
};

// Some configurations of a chain in which joints follow others: expands them to all joints for the
// kernel, and reduces its results to the degrees of freedom.
class CoupledBlock {
 public:
  static constexpr size_t kMost = 16;  // configurations

  CoupledBlock(const Chain& chain, const internal::PoseQuery& query, size_t first, size_t count)
      : chain_(chain), coupled_(*chain.coupled()), count_(count) {
    const auto row = [&](const internal::PoseRows& rows, size_t r) {
      return rows.data ? rows.data + (first + r) * rows.stride : nullptr;
    };
    const size_t m = joints();
    for (size_t r = 0; r < count; ++r) {
      const internal::ExpandedMotion motion(
          coupled_, {.q = row(query.q, r), .qd = row(query.qd, r), .qdd = row(query.qdd, r)});
      const internal::LinkQuery all = motion.query();
      std::copy_n(motion.slopes, m, slopes_[r]);
      std::copy_n(all.q, m, q_ + r * m);
      if (all.qd) std::copy_n(all.qd, m, qd_ + r * m);
      all.qdd ? std::copy_n(all.qdd, m, qdd_ + r * m) : std::fill_n(qdd_ + r * m, m, 0.0);
      x_[r] = row(query.q, r);
    }
    query_ = {.count = count, .q = {q_, m}, .qd = {qd_, m}, .qdd = {qdd_, m}};
    query_.gravity = {row(query.gravity, 0), query.gravity.stride};
  }

  void Compute(internal::PosePart part, double* out, double* tips) {
    const size_t m = joints(), n = static_cast<size_t>(coupled_.n);
    if (part == internal::PosePart::kManipulability) {
      for (size_t r = 0; r < count_; ++r) out[r] = ManipulabilityOf(chain_.model(), x_[r]);
      return;
    }
    const bool tip = part == internal::PosePart::kTip;
    internal::ComputePoses(chain_.lanes().poses(), part, query_, tip ? out : results_, tips);
    if (tip) return;
    const size_t rows = part == internal::PosePart::kJacobian ? 6
                        : part == internal::PosePart::kMass   ? m
                                                              : 1;
    for (size_t r = 0; r < count_; ++r) {
      double* of_row = results_ + r * rows * m;
      AddTendons(part, r, of_row);
      for (size_t k = 0; k < rows; ++k) internal::ReduceRow(coupled_, slopes_[r], of_row + k * m);
      if (part == internal::PosePart::kMass) {
        SumRows(slopes_[r], of_row, out + r * n * n);
        continue;
      }
      for (size_t k = 0; k < rows; ++k) std::copy_n(of_row + k * m, n, out + (r * rows + k) * n);
    }
  }

 private:
  size_t joints() const { return static_cast<size_t>(coupled_.links.n); }

  void AddTendons(internal::PosePart part, size_t r, double* of_row) const {
    const size_t m = joints();
    for (const JointCoupling& c : coupled_.tendons) {
      const auto first = static_cast<size_t>(c.first), second = static_cast<size_t>(c.second);
      if (part == internal::PosePart::kMass) {
        of_row[first * m + second] += c.inertia;
        of_row[second * m + first] += c.inertia;
      } else if (part == internal::PosePart::kMotion) {
        of_row[first] += c.inertia * qdd_[r * m + second];
        of_row[second] += c.inertia * qdd_[r * m + first];
      }
    }
  }

  // The columns of a mass matrix are reduced already.
  void SumRows(const double* slopes, const double* of_row, double* out) const {
    const size_t m = joints(), n = static_cast<size_t>(coupled_.n);
    for (size_t l = 0; l < n; ++l) {
      double column[kMaxChainJoints];
      for (size_t k = 0; k < m; ++k) column[k] = of_row[k * m + l];
      internal::ReduceRow(coupled_, slopes, column);
      for (size_t k = 0; k < n; ++k) out[k * n + l] = column[k];
    }
  }

  const Chain& chain_;
  const CoupledLinks& coupled_;
  size_t count_;
  internal::PoseQuery query_;
  const double* x_[kMost];
  double slopes_[kMost][kMaxChainJoints];
  double q_[kMost * kMaxChainJoints], qd_[kMost * kMaxChainJoints], qdd_[kMost * kMaxChainJoints];
  double results_[kMost * kMaxChainJoints * kMaxChainJoints];
};

// `numbers` is how many numbers a result has.
void RunCoupled(const Chain& chain, internal::PosePart part, const internal::PoseQuery& query,
                size_t numbers, double* out, double* tips) {
  for (size_t first = 0; first < query.count; first += CoupledBlock::kMost) {
    CoupledBlock block(chain, query, first, std::min(CoupledBlock::kMost, query.count - first));
    block.Compute(part, out + first * numbers, tips ? tips + 16 * first : nullptr);
  }
}

void Run(const Chain& chain, internal::PosePart part, const internal::PoseQuery& query,
         std::span<double> out, double* tips = nullptr) {
  if (!chain.coupled())
    return internal::ComputePoses(chain.lanes().poses(), part, query, out.data(), tips);
  if (query.count > 0) RunCoupled(chain, part, query, out.size() / query.count, out.data(), tips);
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
  Run(chain, internal::PosePart::kJacobian, {.count = batch.count(), .q = batch.Joints("q", q)},
      jacobians, tips.data());
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
