// The data of a chain for solvers that work on many lanes; made on first use.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>

#include "robocell/kinematics/folded_chain.h"
#include "robocell/kinematics/ik_parts.h"
#include "robocell/kinematics/pose_table.h"
#include "robocell/kinematics/start_table.h"

namespace robocell::internal {

class LaneChain {
 public:
  explicit LaneChain(const ChainModel& chain)
      : folded_(Fold(chain)), poses_(TabulatePoses(chain)), middle_(SeedOf(chain, {}, {})) {}

  const FoldedChain& folded() const { return folded_; }
  const PoseTable& poses() const { return poses_; }
  // Start of searches without a seed.
  const JointVector& middle() const { return middle_; }
  const StartTable& starts(const ChainModel& chain) const {
    if (const StartTable* ready = ready_.load(std::memory_order_acquire)) return *ready;
    std::call_once(made_,
                   [&] { ready_.store(&starts_.emplace(chain), std::memory_order_release); });
    return *starts_;
  }

 private:
  FoldedChain folded_;
  PoseTable poses_;
  JointVector middle_;
  mutable std::once_flag made_;
  mutable std::optional<StartTable> starts_;
  mutable std::atomic<const StartTable*> ready_ = nullptr;  // faster to read than the flag
};

}  // namespace robocell::internal
