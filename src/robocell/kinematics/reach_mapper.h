// Fills a map of what a chain reaches. For reach_map.cc.
//
// Every pose is solved from a few separate starts. A pose that none of them reached, next to a
// cell where the same rotation was reached, is solved again from there, and once from many starts,
// as long as that finds more: few starts miss whole regions, but hardly their borders.
#pragma once

#include <span>
#include <vector>

#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/reach_map.h"

namespace robocell::internal {

class ReachMapper {
 public:
  // Fills the numbers of `map`, which has its cells. All arguments must outlive this object.
  ReachMapper(const Chain& chain, const ReachMapOptions& options, ReachMap* map);
  void Run();

 private:
  // Maps the cells from `first` to `end`, in the order of the map.
  void MapCells(std::size_t first, std::size_t end);
  void FindCellsInReach();
  void AskForAll();
  // Solves unreached poses beside those reached last; returns true if any was reached.
  bool AskBesideNews();
  // Solves poses that were not reached from a neighbour once from many starts; returns true if any
  // was reached.
  bool InsistAtBorders();
  void AskBeside(std::span<const std::size_t> news, int axis, int step);
  void Ask(std::size_t pose, const float* seed);
  void Solve(const IkBatchOptions& options);
  // Returns the pose with the same rotation in the next cell; kNone if there is none.
  std::size_t PoseBeside(std::size_t pose, int axis, int step) const;
  Eigen::Vector3d CentreOf(std::size_t cell) const;
  void Fill();
  void FillCell(std::size_t slot, std::vector<double>* q, std::vector<double>* values);

  static constexpr std::size_t kNone = -1;

  const Chain& chain_;
  ReachMap& map_;
  IkBatchOptions from_starts_, from_seeds_, from_many_starts_;
  std::vector<Quaternion> rotations_;

  // Cells in reach have slots; the index of a pose is its slot times the rotations, plus its
  // rotation.
  std::size_t first_ = 0, end_ = 0;
  std::vector<std::size_t> cell_of_slot_, slot_of_cell_;  // the latter from first_ on
  enum class State : uint8_t { kOpen, kInsisted, kReached };
  std::vector<State> states_;  // state of each pose
  std::vector<float> q_;       // n for each pose, where reached
  // Poses that were reached last, and those that were not reached from a neighbour.
  std::vector<std::size_t> news_, barred_;

  // The cells of the queries that are solved together.
  std::vector<std::size_t> queued_;
  std::vector<Pose> targets_;
  std::vector<double> seeds_;
  IkBatchResult found_;
};

}  // namespace robocell::internal
