// The data of a chain for solvers that work on many lanes; made on first use.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>

#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/folded_chain.h"
#include "robocell/kinematics/ik_parts.h"
#include "robocell/kinematics/pose_table.h"
#include "robocell/kinematics/start_table.h"

namespace robocell::internal {

class LaneChain {
 public:
  explicit LaneChain(const ChainModel& chain)
      : poses_(TabulatePoses(LinksOf(chain))), middle_(SeedOf(chain, {}, {})) {
    if (!chain.coupled) {
      folded_ = Fold(chain);
      return;
    }
    CoupledFold folded = FoldCoupled(chain);
    coupling_ = std::make_unique<const FoldedCoupling>(folded.coupling);
    folded_ = folded.chain;
    folded_.coupling = coupling_.get();
  }

  const FoldedChain& folded() const { return folded_; }
  // The table has all joints of LinksOf the chain.
  const PoseTable& poses() const { return poses_; }
  // Start of searches without a seed.
  const JointVector& middle() const { return middle_; }
  const StartTable& starts(const ChainModel& chain) const {
    if (const StartTable* ready = ready_.load(std::memory_order_acquire)) return *ready;
    std::call_once(made_, [&] {
      starts_ = StartTable::Of(chain);
      ready_.store(starts_.get(), std::memory_order_release);
    });
    return *starts_;
  }

 private:
  FoldedChain folded_;
  std::unique_ptr<const FoldedCoupling> coupling_;
  PoseTable poses_;
  JointVector middle_;
  mutable std::once_flag made_;
  mutable std::shared_ptr<const StartTable> starts_;
  mutable std::atomic<const StartTable*> ready_ = nullptr;  // faster to read than the flag
};

}  // namespace robocell::internal
