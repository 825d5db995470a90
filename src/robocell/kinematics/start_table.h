// StartTable: joint values spread over a chain's limits, found by the pose that they give the tip:
// where a search for a pose best begins.
//
// Points of a low-discrepancy sequence, sorted into cells of space by the position of the tip; in a
// cell they are ranked by how far the tip has to turn and to move. A start nearby needs few steps,
// and ends more often inside the limits. Immutable; a chain makes it once, in some milliseconds.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "robocell/kinematics/chain_model.h"

namespace robocell::internal {

class StartTable {
 public:
  explicit StartTable(const ChainModel& chain);

  // A pose to start near.
  struct Aim {
    std::array<float, 3> position;    // m, in the base frame
    std::array<float, 4> quaternion;  // wxyz
    float turn_weight;                // 0: any rotation will do
    // Any turn about an axis will do; the quaternion after half a turn about it.
    bool any_turn = false;
    std::array<float, 4> half_turned{};
  };
  // Of the rotation only the direction of this axis, in the tip's frame, counts; null: all of it.
  static Aim At(const Transform& tip_in_base, bool position_only,
                const Eigen::Vector3d* axis = nullptr);

  // How far a walk through the starts near an aim has come.
  struct Place {
    float score = -1;
    int entry = -1;
  };
  // The next start in order of nearness: n values, or null when there are no more nearby. Those
  // that are much like one that was tried are passed over: they lead to the same place.
  const float* Next(const Aim& aim, Place* place, std::span<const Place> tried = {}) const;
  // The first of them at once, as many as `places` holds: for less than two walks. How many there
  // are.
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
  // Distances of consecutive entries from the aim.
  template <bool kAnyTurn>
  void Score(const Aim& aim, int first, int count, float* scores) const;
  // Returns true if some joint is far from its position in each of the others.
  bool IsApart(const Place& place, std::span<const Place> others) const;
  // Calls visit(place) for each entry of the cells to look in for the aim, in their order.
  template <class Visit>
  void ForNearby(const Aim& aim, const Visit& visit) const;

  int n_ = 0;
  std::array<float, kMaxChainJoints> apart_{};  // of each joint, rad or m
  float per_distance2_ = 0;        // weight of a squared distance against a squared angle
  std::array<float, 3> corner_{};  // of the first cell, m
  float per_edge_ = 0;             // 1 / edge of a cell, 1/m
  std::array<int, 3> cells_{};     // along each axis
  std::vector<int> begin_;         // of each cell's entries; one more at the end
  // The cells to look in for a cell, from detour_begin_[cell] to the next one's: itself, or those
  // with entries that are nearest.
  std::vector<int> detour_begin_, detours_;
  std::array<std::vector<float>, kColumns> poses_;
  std::vector<float> q_;  // n values each
};

}  // namespace robocell::internal
