// The sequence of starts for one target: the seed if there is one, entries of the chain's table
// near the target, then points that fill the joint space. With a preferred configuration: that one,
// the seed, and then also points that fill a growing part of the space around it.
//
// Several searches can share the starts of a query: each takes every stride-th.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include "robocell/kinematics/lane_work.h"

namespace robocell::internal {

class LaneStarts {
 public:
  LaneStarts() = default;
  // Refers to the pose.
  LaneStarts(const LaneWork& work, const Transform& tip_in_base, std::span<const double> seed,
             int first = 0, int stride = 1)
      : tip_(&tip_in_base),
        seed_(work.SeedOf(seed)),
        seeded_(!seed.empty()),
        next_(first),
        stride_(stride) {
    if (!work.preference().has_goal()) return;
    own_seed_ = seed;
    seed_ = work.preference().GoalFor(seed_);
    around_ = true;
  }

  // Returns the values of locked joints; with a preference, the configuration that solutions should
  // be near.
  const JointVector& seed() const { return seed_; }
  // Returns the number of starts begun.
  int begun() const { return begun_; }
  // Returns the number of the present start among all of the query.
  int number() const { return next_ - stride_; }

  // Finds the starts near the target up to this number all at once, because they will be needed.
  void Foresee(int count, const LaneWork& work) {
    const StartTable* table = around_ || known_ > 0 ? nullptr : work.table();
    if (!table) return;
    AimOnce(work);
    known_ = table->First(near_->aim, std::span(near_->places).first(std::min(count, kNearby)));
  }

  // Puts the next start into a lane.
  void Begin(int lane, LaneWork* work) {
    const int number = next_;
    next_ += stride_;
    ++begun_;
    work->AskFor(lane, number);
    if (around_) return BeginAround(lane, number, work);
    if (number == 0 && seeded_) return work->Put(lane, seed_.data());
    if (!PutNearby(lane, number - (seeded_ ? 1 : 0), number, work))
      work->Put(lane, SpreadStart(work->chain(), seed_, work->options().locked, number).data());
    work->LetRoam(lane);
  }

 private:
  // Number of starts from the table; a target that these do not reach lies in a corner.
  static constexpr int kNearby = 16;
  // Growth of the part that is filled.
  static constexpr double kGrowth = 0.1;

  // Searches the table for a start near the pose for the first time.
  void AimOnce(const LaneWork& work) {
    if (!near_) near_.emplace(Near{.aim = work.AimOfStarts(*tip_)});
  }

  // Puts the table's entry with this rank of nearness into a lane; returns false if there is none.
  bool PutNearby(int lane, int entry, int number, LaneWork* work) {
    const StartTable* table = number < kNearby ? work->table() : nullptr;
    if (!table) return false;
    AimOnce(*work);
    for (; known_ <= entry; ++known_) {
      StartTable::Place place = known_ > 0 ? near_->places[known_ - 1] : StartTable::Place();
      const std::span tried = std::span(near_->places).first(known_);
      if (!table->Next(near_->aim, &place, tried)) return false;
      near_->places[known_] = place;
    }
    work->Put(lane, table->Values(near_->places[entry]));
    return true;
  }

  // Begins at the goal, at the seed, and then alternately around the goal and near the target.
  void BeginAround(int lane, int number, LaneWork* work) {
    if (number == 0) return work->Put(lane, seed_.data());
    if (number == 1 && seeded_) return work->Put(lane, work->SeedOf(own_seed_).data());
    if (number % 2 == 0 || !PutNearby(lane, number / 2, number, work)) {
      const double part = std::min(1.0, kGrowth * number);
      work->Put(lane,
                SpreadStart(work->chain(), seed_, work->options().locked, number, part).data());
    }
    work->LetRoam(lane);
  }

  const Transform* tip_ = nullptr;
  // Entries of the table near the pose, as far as they were searched.
  struct Near {
    StartTable::Aim aim;
    std::array<StartTable::Place, kNearby> places{};
  };
  std::optional<Near> near_;  // successful seeds need none
  JointVector seed_;
  std::span<const double> own_seed_;  // seed of a query with a preference
  bool seeded_ = false, around_ = false;
  int begun_ = 0, known_ = 0;
  int next_ = 0, stride_ = 1;
};

}  // namespace robocell::internal
