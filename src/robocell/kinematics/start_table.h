// StartTable: joint values spread over a chain's limits, indexed by the pose of the tip: the best
// starts of a search for a pose.
//
// It sorts points of a low-discrepancy sequence into cells of space by the position of the tip;
// within a cell they are ranked by the rotation and translation that the tip needs. A start nearby
// needs few steps, and ends more often inside the limits. Immutable; made in some milliseconds, once
// for all chains that move alike.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "robocell/kinematics/chain_model.h"

namespace robocell::internal {

class StartTable {
 public:
  explicit StartTable(const ChainModel& chain);
  // Returns a chain's table, which chains with the same geometry share.
  static std::shared_ptr<const StartTable> Of(const ChainModel& chain);

  // A pose to start near.
  struct Aim {
    std::array<float, 3> position;    // m, in the base frame
    std::array<float, 4> quaternion;  // wxyz
    float turn_weight;                // 0: any rotation will do
    // If true, any turn about an axis is accepted; the quaternion after half a turn about it.
    bool any_turn = false;
    std::array<float, 4> half_turned{};
  };
  // If set, only the direction of this axis, in the tip's frame, counts of the rotation; null: all
  // of it.
  static Aim At(const Transform& tip_in_base, bool position_only,
                const Eigen::Vector3d* axis = nullptr);

  // The position of a walk through the starts near an aim.
  struct Place {
    float score = -1;
    int entry = -1;
  };
  // Returns the next start in order of nearness: n values, or null if there are no more nearby. It
  // skips starts similar to a tried one, which lead to the same place.
  const float* Next(const Aim& aim, Place* place, std::span<const Place> tried = {}) const;
  // Finds the first of them at once, as many as `places` holds, in less time than two walks.
  // Returns their number.
  int First(const Aim& aim, std::span<Place> places) const;
  const float* Values(const Place& place) const {
    return q_.data() + static_cast<std::ptrdiff_t>(place.entry) * n_;
  }

  int n_joints() const { return n_; }

 private:
  enum Column { kX, kY, kZ, kQw, kQx, kQy, kQz, kColumns };

  void MakeCells(const std::vector<std::array<float, kColumns>>& poses);
  void MakeDetours();
  int CellOf(const float* position) const;
  // Returns distances of consecutive entries from the aim.
  template <bool kAnyTurn>
  void Score(const Aim& aim, int first, int count, float* scores) const;
  // Returns true if some joint is far from its position in each of the others.
  bool IsApart(const Place& place, std::span<const Place> others) const;
  // Calls visit(place) for each entry of the aim's cells, in order.
  template <class Visit>
  void ForNearby(const Aim& aim, const Visit& visit) const;

  int n_ = 0;
  std::array<float, kMaxChainJoints> apart_{};  // distance for each joint, rad or m
  float per_distance2_ = 0;        // weight of a squared distance against a squared angle
  std::array<float, 3> corner_{};  // corner of the first cell, m
  float per_edge_ = 0;             // 1 / edge of a cell, 1/m
  std::array<int, 3> cells_{};     // along each axis
  std::vector<int> begin_;         // first entry of each cell; one more at the end
  // The cells to search for a cell, from detour_begin_[cell] to the next one's: itself, or the
  // nearest ones with enough entries.
  std::vector<int> detour_begin_, detours_;
  std::array<std::vector<float>, kColumns> poses_;
  std::vector<float> q_;  // n values each
};

}  // namespace robocell::internal
