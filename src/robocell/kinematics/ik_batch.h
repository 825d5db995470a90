// Inverse kinematics of many poses at once.
//
// Each query is solved on its own: its result does not depend on the other queries, on their order
// or on the number of threads. It may differ from the result of Ik, and on another instruction set
// again; each is a solution. Results are arrays with one row per query. lane_solver.h describes the
// method. A filter gets the solutions of many queries at once, on the caller's thread.
//
// Throws ArgumentError, with the wrong row, before any work starts. See ik.h for the options.
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
  // Number of threads, including the caller's.
  int threads = 1;
  // Called occasionally on the caller's thread. Its exception ends the batch and is rethrown.
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

// `seeds` has no value (the middle of the limits), n values (the same seed for all) or B x n values
// row by row.
IkBatchResult IkBatch(const Chain& chain, const IkTargets& tips_in_base,
                      std::span<const double> seeds = {}, const IkBatchOptions& options = {});
// Writes into a result whose memory is reused: no allocation if the size is the same, threads is
// 1, and the options have neither a preference nor a filter.
void IkBatch(const Chain& chain, const IkTargets& tips_in_base, std::span<const double> seeds,
             const IkBatchOptions& options, IkBatchResult* result);

}  // namespace robocell
