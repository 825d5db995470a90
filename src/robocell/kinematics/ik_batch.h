// Inverse kinematics of many poses at once.
//
// Each query is solved on its own: its result does not depend on the other queries, on their order
// or on the number of threads. It may differ from the result of Ik, and on a processor with another
// instruction set again; each is a solution. Results are arrays with one row per query. See
// lane_solver.h for the method. A filter gets the solutions of many queries at once, on the
// caller's thread.
//
// Errors: ArgumentError before any work starts, naming the row that is wrong. See ik.h for the
// options.
//
//   IkBatchResult r = IkBatch(chain, targets, seeds, {.threads = 2});
//   for (int b = 0; b < r.size; ++b) if (r.success[b]) Use(r.row(b));
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "robocell/kinematics/ik.h"
#include "robocell/kinematics/ik_targets.h"

namespace robocell {

struct IkBatchOptions {
  // Options of every query. The seed in here must be empty: seeds are a separate argument.
  IkOptions ik{};
  // The caller's thread is one of them.
  int threads = 1;
  // Called now and then on the caller's thread. What it throws ends the batch and comes out of it.
  std::function<void()> poll = {};
};

struct IkBatchResult {
  int size = 0;                          // B queries
  int n_joints = 0;                      // n
  std::vector<double> q{};               // B x n, row by row
  std::vector<uint8_t> success{};        // B, 0 or 1
  std::vector<double> position_error{};  // B, m
  std::vector<double> rotation_error{};  // B, rad
  std::vector<int> iterations{};         // B

  std::span<const double> row(int b) const {
    return std::span(q).subspan(static_cast<std::size_t>(b) * n_joints, n_joints);
  }
  int solved() const;
};

// `seeds` holds no value (the middle of the limits), n values (the same seed for all) or B x n
// values row by row.
IkBatchResult IkBatch(const Chain& chain, const IkTargets& tips_in_base,
                      std::span<const double> seeds = {}, const IkBatchOptions& options = {});
// The same into a result whose memory is used again: no allocation when the size is the same,
// threads is 1, and the options have neither a preference nor a filter.
void IkBatch(const Chain& chain, const IkTargets& tips_in_base, std::span<const double> seeds,
             const IkBatchOptions& options, IkBatchResult* result);

}  // namespace robocell
