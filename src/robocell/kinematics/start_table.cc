#include "robocell/kinematics/start_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "robocell/kinematics/chain_cache.h"
#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/low_discrepancy.h"
#include "robocell/kinematics/start_range.h"

namespace robocell::internal {
namespace {

// More entries are nearer and save steps, but ranking them reads slower memory. Without redundant
// joints a pose has few solutions, and more entries are needed for a start near each.
struct TableSize {
  int entries, cells_along_the_longest_side;
};
constexpr TableSize SizeFor(int joints) {
  return joints > 6 ? TableSize{4096, 8} : TableSize{8192, 7};
}
// Solutions found from near a limit end up pressed on it more often than others. A chain of few
// joints reaches a pose in one or two ways: a region that its starts leave out, for example a wedge
// behind the base, is not found from elsewhere.
constexpr double kPartOfTheRange = 0.8;
constexpr int kFewJoints = 5;
// A cell with fewer entries has no choice to offer.
constexpr int kFewestEntries = 8;
// This part of the chain's length counts as much as one radian.
constexpr double kLengthPerRadian = 0.4;
// Starts whose joints are all nearer than this lead to the same place (rad).
constexpr double kApart = 1.5;

JointVector StartNumber(const ChainModel& chain, int k) {
  const double range = chain.n > kFewJoints ? kPartOfTheRange : 1;
  JointVector q(chain.n);
  for (int i = 0; i < chain.n; ++i) {
    const double part = 0.5 + range * (LowDiscrepancy(k, i) - 0.5);
    q[i] = StartRangeOf(chain.joints[i], chain.length).at(part);
  }
  return q;
}

}  // namespace

StartTable::Aim StartTable::At(const Transform& tip, bool position_only,
                               const Eigen::Vector3d* axis) {
  const Eigen::Vector3f p = tip.translation.cast<float>();
  const Eigen::Quaterniond turn(tip.rotation);
  const Eigen::Vector4f q = turn.coeffs().cast<float>();  // xyzw
  Aim aim{{p.x(), p.y(), p.z()}, {q.w(), q.x(), q.y(), q.z()}, position_only ? 0.F : 8.F};
  if (!axis) return aim;
  aim.any_turn = true;
  const Eigen::Vector4f half =
      (turn * Eigen::Quaterniond(0, axis->x(), axis->y(), axis->z())).coeffs().cast<float>();
  aim.half_turned = {half.w(), half.x(), half.y(), half.z()};
  return aim;
}

StartTable::StartTable(const ChainModel& chain)
    : n_(chain.n),
      per_distance2_(static_cast<float>(1 / std::pow(kLengthPerRadian * chain.length, 2))) {
  for (int i = 0; i < n_; ++i) {
    const double part = chain.joints[i].slide ? kLengthPerRadian : 1;
    apart_[i] = static_cast<float>(kApart * (part * UnitOf(chain, i)));
  }
  const int entries = SizeFor(n_).entries;
  std::vector<std::array<float, kColumns>> poses(entries);
  std::vector<JointVector> starts(entries);
  for (int k = 0; k < entries; ++k) {
    starts[k] = StartNumber(chain, k);
    const Aim at = At(WalkChain(chain, starts[k].data(), [](int, const Transform&) {}), false);
    std::copy(at.position.begin(), at.position.end(), poses[k].begin());
    std::copy(at.quaternion.begin(), at.quaternion.end(), poses[k].begin() + kQw);
  }
  MakeCells(poses);

  std::vector<int> next = begin_;
  for (std::vector<float>& column : poses_) column.resize(entries);
  q_.resize(static_cast<std::size_t>(entries) * n_);
  for (int k = 0; k < entries; ++k) {
    const int entry = next[CellOf(poses[k].data())]++;
    for (int c = 0; c < kColumns; ++c) poses_[c][entry] = poses[k][c];
    std::copy(starts[k].begin(), starts[k].end(), q_.begin() + std::ptrdiff_t(entry) * n_);
  }
  MakeDetours();
}

std::shared_ptr<const StartTable> StartTable::Of(const ChainModel& chain) {
  static ChainCache<StartTable> cache;
  return cache.Get(chain, [&] { return StartTable(chain); });
}

// Makes cubes over the box of all positions, and counts the entries in each.
void StartTable::MakeCells(const std::vector<std::array<float, kColumns>>& poses) {
  std::array<float, 3> sides{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto less = [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; };
    const auto [low, high] = std::minmax_element(poses.begin(), poses.end(), less);
    corner_[axis] = (*low)[axis];
    sides[axis] = (*high)[axis] - (*low)[axis];
  }
  const float longest = *std::max_element(sides.begin(), sides.end());
  // Rounding is not a space.
  const auto cells = static_cast<float>(SizeFor(n_).cells_along_the_longest_side);
  per_edge_ = longest * std::sqrt(per_distance2_) > 1e-5F ? cells / longest : 0;
  for (int axis = 0; axis < 3; ++axis)
    cells_[axis] = std::max(1, static_cast<int>(std::ceil(sides[axis] * per_edge_)));

  begin_.assign(cells_[0] * cells_[1] * cells_[2] + 1, 0);
  for (const auto& pose : poses) ++begin_[CellOf(pose.data()) + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
}

int StartTable::CellOf(const float* position) const {
  int cell = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float at = (position[axis] - corner_[axis]) * per_edge_;
    const float last = static_cast<float>(cells_[axis] - 1);
    // NaN (an infinite position in a table of one place) is in the first cell.
    cell = cell * cells_[axis] + (at > 0 ? static_cast<int>(std::min(at, last)) : 0);
  }
  return cell;
}

// Near the border of the reach, cells are nearly empty: the nearest ones with enough entries
// replace them, including all equally near ones. If the limits of the first joint leave out a
// wedge, a search from one side of it does not find solutions on the other.
void StartTable::MakeDetours() {
  const int count = static_cast<int>(begin_.size()) - 1;
  const auto entries = [&](int cell) { return begin_[cell + 1] - begin_[cell]; };
  const auto place = [&](int cell) {
    return Eigen::Vector3i(cell / (cells_[1] * cells_[2]), cell / cells_[2] % cells_[1],
                           cell % cells_[2]);
  };
  for (int cell = 0; cell < count; ++cell) {
    const std::size_t begin = detours_.size();
    detour_begin_.push_back(static_cast<int>(begin));
    detours_.push_back(cell);
    if (entries(cell) >= kFewestEntries) continue;
    int nearest = std::numeric_limits<int>::max();
    for (int other = 0; other < count; ++other) {
      const int distance2 = (place(other) - place(cell)).squaredNorm();
      if (entries(other) < kFewestEntries || distance2 > nearest) continue;
      if (distance2 < nearest) detours_.resize(begin);
      nearest = distance2;
      detours_.push_back(other);
    }
  }
  detour_begin_.push_back(static_cast<int>(detours_.size()));
}

// Plain loops over columns: the compiler turns them into four lanes on every x86-64, with the same
// result on all.
template <bool kAnyTurn>
void StartTable::Score(const Aim& aim, int first, int count, float* scores) const {
  const auto at = [&](Column column) { return poses_[column].data() + first; };
  const float *x = at(kX), *y = at(kY), *z = at(kZ);
  const float *qw = at(kQw), *qx = at(kQx), *qy = at(kQy), *qz = at(kQz);
  const auto [px, py, pz] = aim.position;
  const auto [w, i, j, k] = aim.quaternion;
  const auto [hw, hi, hj, hk] = aim.half_turned;
  const float per_distance2 = per_distance2_, turn_weight = aim.turn_weight;
  for (int e = 0; e < count; ++e) {
    const float dx = x[e] - px, dy = y[e] - py, dz = z[e] - pz;
    float cosine = qw[e] * w + qx[e] * i + qy[e] * j + qz[e] * k;  // cosine of half the angle
    if constexpr (kAnyTurn) {
      // The value for the nearest rotation about the axis.
      const float other = qw[e] * hw + qx[e] * hi + qy[e] * hj + qz[e] * hk;
      cosine = std::sqrt(cosine * cosine + other * other);
    }
    // angle^2 is about 8 (1 - cos(angle / 2))
    scores[e] =
        per_distance2 * (dx * dx + dy * dy + dz * dz) + turn_weight * (1 - std::abs(cosine));
  }
}

template <class Visit>
void StartTable::ForNearby(const Aim& aim, const Visit& visit) const {
  const int target_cell = CellOf(aim.position.data());
  std::array<float, 64> scores;
  for (int d = detour_begin_[target_cell]; d < detour_begin_[target_cell + 1]; ++d) {
    const int end = begin_[detours_[d] + 1];
    for (int first = begin_[detours_[d]]; first < end; first += static_cast<int>(scores.size())) {
      const int count = std::min(end - first, static_cast<int>(scores.size()));
      aim.any_turn ? Score<true>(aim, first, count, scores.data())
                   : Score<false>(aim, first, count, scores.data());
      for (int e = 0; e < count; ++e) visit(Place{scores[e], first + e});
    }
  }
}

bool StartTable::IsApart(const Place& place, std::span<const Place> others) const {
  const float* q = Values(place);
  return std::all_of(others.begin(), others.end(), [&](const Place& other) {
    const float* near = Values(other);
    for (int i = 0; i < n_; ++i) {
      if (std::abs(q[i] - near[i]) >= apart_[i]) return true;
    }
    return false;
  });
}

const float* StartTable::Next(const Aim& aim, Place* place, std::span<const Place> tried) const {
  Place best{std::numeric_limits<float>::infinity(), -1};
  ForNearby(aim, [&](const Place& entry) {
    if (entry.score >= best.score || entry.score < place->score) return;
    if (entry.score == place->score && entry.entry <= place->entry) return;
    if (IsApart(entry, tried)) best = entry;
  });
  if (best.entry < 0) return nullptr;
  *place = best;
  return Values(best);
}

int StartTable::First(const Aim& aim, std::span<Place> places) const {
  const int most = static_cast<int>(places.size());
  int found = 0;
  float last = std::numeric_limits<float>::infinity();
  // Inserts in order; equally near entries keep their order.
  ForNearby(aim, [&](const Place& entry) {
    if (!(entry.score < last)) return;
    int at = found < most ? found++ : most - 1;
    for (; at > 0 && entry.score < places[at - 1].score; --at) places[at] = places[at - 1];
    places[at] = entry;
    if (found == most) last = places[most - 1].score;
  });
  return found;
}

}  // namespace robocell::internal
