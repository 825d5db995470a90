// What a chain keeps for solvers that work on many lanes; made when it is first asked for.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "robocell/kinematics/folded_chain.h"
#include "robocell/kinematics/link_table.h"
#include "robocell/kinematics/normal_frames.h"
#include "robocell/kinematics/start_table.h"

namespace robocell {

class LaneChain {
 public:
  explicit LaneChain(const ChainModel& chain)
      : folded_(Fold(chain)), links_(Tabulate(InNormalFrames(chain))) {}

  const FoldedChain& folded() const { return folded_; }
  // In normal frames.
  const LinkTable& links() const { return links_; }
  const StartTable& starts(const ChainModel& chain) const {
    std::call_once(made_, [&] { starts_.emplace(chain); });
    return *starts_;
  }

 private:
  FoldedChain folded_;
  LinkTable links_;
  mutable std::once_flag made_;
  mutable std::optional<StartTable> starts_;
};

}  // namespace robocell
