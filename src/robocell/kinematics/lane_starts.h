// Where the searches for one target begin, one after the other: at the seed if there is one, at
// what the chain's table has near the target, then at points that fill the joint space.
#pragma once

#include <span>

#include "robocell/kinematics/lane_work.h"

namespace robocell {

class LaneStarts {
 public:
  LaneStarts() = default;
  LaneStarts(const LaneWork& work, const Transform& tip_in_base, std::span<const double> seed)
      : aim_(StartTable::At(tip_in_base, work.options().position_only)),
        seed_(SeedOf(work.chain(), seed, work.options().locked)),
        seeded_(!seed.empty()) {}

  const JointVector& seed() const { return seed_; }
  // How many were begun.
  int begun() const { return begun_; }

  // Puts the next start into a lane.
  void Begin(int lane, LaneWork* work) {
    const int number = begun_++;
    if (number == 0 && seeded_) return work->Put(lane, seed_.data());
    const StartTable* table = number < kNearby ? work->table() : nullptr;
    const float* nearby = table ? table->Next(aim_, &place_) : nullptr;
    if (nearby) return work->Put(lane, nearby);
    work->Put(lane, SpreadStart(work->chain(), seed_, work->options().locked, number).data());
  }

 private:
  // So many come from the table; a target that these do not reach lies in a corner.
  static constexpr int kNearby = 16;

  StartTable::Aim aim_{};
  StartTable::Place place_;
  JointVector seed_;
  bool seeded_ = false;
  int begun_ = 0;
};

}  // namespace robocell
