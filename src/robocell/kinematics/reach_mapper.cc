#include "robocell/kinematics/reach_mapper.h"

#include <algorithm>
#include <array>
#include <utility>

#include "robocell/kinematics/chain_batch.h"
#include "robocell/kinematics/on_threads.h"

namespace robocell::internal {
namespace {

// Poses that are solved together: enough for all threads, few enough for the caches.
constexpr std::size_t kPosesTogether = 1 << 15;
// Joint values that are kept at a time, 512 MiB: larger maps are made in parts, which ignore their
// neighbours.
constexpr std::size_t kValuesKept = std::size_t{1} << 27;
// Starts for poses that cannot be entered from a neighbour, usually because of a limit. The first
// sixteen are near the target and of one kind.
constexpr int kRestartsAtBorders = 48;

}  // namespace

ReachMapper::ReachMapper(const Chain& chain, const ReachMapOptions& options, ReachMap* map)
    : chain_(chain), map_(*map) {
  from_starts_.ik.position_only = options.position_only;
  from_starts_.ik.axis = options.axis;
  from_starts_.ik.tolerance = options.tolerance;
  from_starts_.ik.max_restarts = options.max_restarts;
  from_starts_.threads = options.threads;
  from_starts_.poll = options.poll;
  from_seeds_ = from_starts_;
  from_seeds_.ik.max_restarts = 0;
  from_many_starts_ = from_starts_;
  from_many_starts_.ik.max_restarts = std::max(kRestartsAtBorders, options.max_restarts);
  for (int k = 0; k < map->rotations; ++k) rotations_.push_back(SpreadRotation(k, map->rotations));
}

void ReachMapper::Run() {
  const std::size_t cells = map_.fraction.size();
  const std::size_t values = rotations_.size() * chain_.n_joints();
  const std::size_t together = std::max<std::size_t>(1, kValuesKept / values);
  for (std::size_t first = 0; first < cells; first += together)
    MapCells(first, std::min(first + together, cells));
}

void ReachMapper::MapCells(std::size_t first, std::size_t end) {
  first_ = first;
  end_ = end;
  FindCellsInReach();
  AskForAll();
  do {
    while (AskBesideNews()) {
    }
  } while (InsistAtBorders());
  Fill();
}

void ReachMapper::FindCellsInReach() {
  const ChainModel& model = chain_.model();
  cell_of_slot_.clear();
  slot_of_cell_.assign(end_ - first_, kNone);
  for (std::size_t cell = first_; cell < end_; ++cell) {
    const double away = (CentreOf(cell) - model.joints[0].fixed.translation).norm();
    if (away > model.reach_bound + from_starts_.ik.tolerance) continue;
    slot_of_cell_[cell - first_] = cell_of_slot_.size();
    cell_of_slot_.push_back(cell);
  }
  const std::size_t poses = cell_of_slot_.size() * rotations_.size();
  states_.assign(poses, State::kOpen);
  q_.resize(poses * chain_.n_joints());
  news_.clear();
}

void ReachMapper::AskForAll() {
  for (std::size_t pose = 0; pose < states_.size(); ++pose) {
    Ask(pose, nullptr);
    if (queued_.size() >= kPosesTogether) Solve(from_starts_);
  }
  Solve(from_starts_);
}

bool ReachMapper::AskBesideNews() {
  const std::vector<std::size_t> news = std::exchange(news_, {});
  for (int axis = 0; axis < 3; ++axis) {
    for (const int step : {-1, 1}) AskBeside(news, axis, step);
  }
  return !news_.empty();
}

// Works in one direction at a time, so that no pose is solved twice together.
void ReachMapper::AskBeside(std::span<const std::size_t> news, int axis, int step) {
  for (const std::size_t from : news) {
    const std::size_t pose = PoseBeside(from, axis, step);
    if (pose == kNone || states_[pose] == State::kReached) continue;
    Ask(pose, &q_[from * chain_.n_joints()]);
    if (queued_.size() >= kPosesTogether) Solve(from_seeds_);
  }
  Solve(from_seeds_);
}

bool ReachMapper::InsistAtBorders() {
  for (const std::size_t pose : std::exchange(barred_, {})) {
    if (states_[pose] != State::kOpen) continue;
    states_[pose] = State::kInsisted;
    Ask(pose, nullptr);
    if (queued_.size() >= kPosesTogether) Solve(from_many_starts_);
  }
  Solve(from_many_starts_);
  return !news_.empty();
}

void ReachMapper::Ask(std::size_t pose, const float* seed) {
  queued_.push_back(pose);
  const std::size_t cell = cell_of_slot_[pose / rotations_.size()];
  targets_.emplace_back(CentreOf(cell), rotations_[pose % rotations_.size()]);
  if (seed) seeds_.insert(seeds_.end(), seed, seed + chain_.n_joints());
}

void ReachMapper::Solve(const IkBatchOptions& options) {
  IkBatch(chain_, targets_, seeds_, options, &found_);
  for (int b = 0; b < found_.size; ++b) {
    const std::size_t pose = queued_[b];
    if (!found_.success[b]) {
      if (&options == &from_seeds_) barred_.push_back(pose);
      continue;
    }
    const std::span<const double> q = found_.row(b);
    std::transform(q.begin(), q.end(), q_.begin() + std::ptrdiff_t(pose * q.size()),
                   [](double value) { return static_cast<float>(value); });
    states_[pose] = State::kReached;
    news_.push_back(pose);
  }
  queued_.clear();
  targets_.clear();
  seeds_.clear();
}

std::size_t ReachMapper::PoseBeside(std::size_t pose, int axis, int step) const {
  const std::size_t rotation = pose % rotations_.size(),
                    cell = cell_of_slot_[pose / rotations_.size()];
  std::array<int, 3> at = map_.cell_at(cell);
  at[axis] += step;
  if (at[axis] < 0 || at[axis] >= map_.cells[axis]) return kNone;
  const std::size_t beside = map_.index(at[0], at[1], at[2]);
  if (beside < first_ || beside >= end_) return kNone;
  const std::size_t slot = slot_of_cell_[beside - first_];
  return slot == kNone ? kNone : slot * rotations_.size() + rotation;
}

Eigen::Vector3d ReachMapper::CentreOf(std::size_t cell) const {
  const auto [x, y, z] = map_.cell_at(cell);
  return map_.centre(x, y, z);
}

void ReachMapper::Fill() {
  const int slots = static_cast<int>(cell_of_slot_.size());
  const int threads = std::clamp(from_starts_.threads, 1, std::max(1, slots));
  OnThreads(threads, [&](int t) {
    std::vector<double> q(rotations_.size() * chain_.n_joints()), values(rotations_.size());
    for (int slot = t; slot < slots; slot += threads) FillCell(slot, &q, &values);
  });
}

void ReachMapper::FillCell(std::size_t slot, std::vector<double>* q, std::vector<double>* values) {
  const std::size_t n = chain_.n_joints(), first = slot * rotations_.size();
  std::size_t reached = 0;
  for (std::size_t k = 0; k < rotations_.size(); ++k) {
    if (states_[first + k] != State::kReached) continue;
    std::copy_n(q_.begin() + std::ptrdiff_t((first + k) * n), n,
                q->begin() + std::ptrdiff_t(reached * n));
    ++reached;
  }
  if (reached == 0) return;
  const std::span found = std::span(*values).first(reached);
  ManipulabilityBatch(chain_, std::span(*q).first(reached * n), found);
  double sum = 0;
  for (const double value : found) sum += value;
  const std::size_t cell = cell_of_slot_[slot];
  map_.fraction[cell] = static_cast<float>(reached) / static_cast<float>(rotations_.size());
  map_.manipulability[cell] = static_cast<float>(sum / static_cast<double>(reached));
}

}  // namespace robocell::internal
