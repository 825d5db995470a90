// Fills a map of what a chain reaches. For reach_map.cc.
//
// Every pose is asked for from a few starts of its own. What none of them reached, next to a cell
// where the same rotation was reached, is asked for again from there, and once from many starts, on
// and on as long as that finds more: few starts miss whole regions, but hardly their borders.
#pragma once

#include <span>
#include <vector>

#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/reach_map.h"

namespace robocell::internal {

class ReachMapper {
 public:
  // `map` has its cells; its numbers are filled in. Both must outlive this.
  ReachMapper(const Chain& chain, const ReachMapOptions& options, ReachMap* map);
  void Run();

 private:
  // Maps the cells from `first` to `end`, in the order of the map.
  void MapCells(std::size_t first, std::size_t end);
  void FindCellsInReach();
  void AskForAll();
  // Asks for what was not reached beside what was reached last; whether anything was found.
  bool AskBesideNews();
  // Asks once from many starts for what was not reached from beside; whether anything was found.
  bool InsistAtBorders();
  void AskBeside(std::span<const std::size_t> news, int axis, int step);
  void Ask(std::size_t pose, const float* seed);
  void Solve(const IkBatchOptions& options);
  // The pose with the same rotation in the next cell; kNone where there is none.
  std::size_t PoseBeside(std::size_t pose, int axis, int step) const;
  Eigen::Vector3d CentreOf(std::size_t cell) const;
  void Fill();
  void FillCell(std::size_t slot, std::vector<double>* q, std::vector<double>* values);

  static constexpr std::size_t kNone = -1;

  const Chain& chain_;
  ReachMap& map_;
  IkBatchOptions from_starts_, from_seeds_, from_many_starts_;
  std::vector<Quaternion> rotations_;

  // Cells in reach have slots; a pose is its slot times the rotations, plus its rotation.
  std::size_t first_ = 0, end_ = 0;
  std::vector<std::size_t> cell_of_slot_, slot_of_cell_;  // the latter from first_ on
  enum class State : uint8_t { kOpen, kInsisted, kReached };
  std::vector<State> states_;  // of each pose
  std::vector<float> q_;       // n for each pose, where reached
  // Poses that were reached last; that were not reached from beside.
  std::vector<std::size_t> news_, barred_;

  // The cells of the queries that are solved together.
  std::vector<std::size_t> asked_;
  std::vector<Pose> targets_;
  std::vector<double> seeds_;
  IkBatchResult found_;
};

}  // namespace robocell::internal
