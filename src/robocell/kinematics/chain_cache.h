// ChainCache: results that follow from a chain's geometry, kept for later chains with the same one.
//
//   static ChainCache<StartTable> cache;
//   std::shared_ptr<const StartTable> table = cache.Get(chain, [&] { return StartTable(chain); });
//
// Every scene makes its own chains, and a run that builds a scene per episode would compute tables
// of the same robot again each time.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "robocell/kinematics/chain_model.h"

namespace robocell::internal {

// Returns the bits of all numbers that say how the chain moves: not its masses and armatures.
std::vector<uint64_t> GeometryBits(const ChainModel& chain);

// Thread-safe. Keeps the results of the chains that were used last.
template <class Result>
class ChainCache {
 public:
  static constexpr size_t kMostKept = 8;

  // Returns the kept result for a chain that moves alike, or that of `compute`, which may use the
  // chain's geometry only.
  template <class Compute>
  std::shared_ptr<const Result> Get(const ChainModel& chain, Compute&& compute) {
    std::vector<uint64_t> key = GeometryBits(chain);
    if (auto kept = Find(key)) return kept;
    auto result = std::make_shared<const Result>(compute());  // other threads are not kept waiting
    const std::lock_guard lock(mutex_);
    kept_.emplace_front(std::move(key), result);
    if (kept_.size() > kMostKept) kept_.pop_back();
    return result;
  }

 private:
  using Kept = std::pair<std::vector<uint64_t>, std::shared_ptr<const Result>>;

  std::shared_ptr<const Result> Find(const std::vector<uint64_t>& key) {
    const std::lock_guard lock(mutex_);
    for (auto it = kept_.begin(); it != kept_.end(); ++it) {
      if (it->first != key) continue;
      kept_.splice(kept_.begin(), kept_, it);
      return it->second;
    }
    return nullptr;
  }

  std::mutex mutex_;
  std::list<Kept> kept_;  // the last used comes first
};

}  // namespace robocell::internal
