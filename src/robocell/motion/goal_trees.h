// A path in joint space from a start to one of several goals: bidirectional RRT-Connect (J. Kuffner
// and S. LaValle, 2000) with one tree from the start and one from all goals.
//
//   GoalTrees search(start, goals, space, edges);
//   while (!search.found() && budget-- > 0) search.Step(rng);
//
// Deterministic: the same inputs and Rng state give the same path. It knows nothing of robots; the
// EdgeJudge decides which straight motions are free.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/robot/move_group.h"

namespace robocell::internal {

// One row for each waypoint.
using Rows = std::vector<std::vector<double>>;

class EdgeJudge {
 public:
  virtual ~EdgeJudge() = default;
  // Returns true if the motion from a to b is free, b included; a is known to be.
  virtual bool IsFree(std::span<const double> a, std::span<const double> b) = 0;
  // Moves a configuration to the nearest that obeys the constraints of the path; false if there is
  // none nearby.
  virtual bool Project(std::span<double>) { return true; }
};

struct JointSpace {
  std::vector<Interval> bounds{};  // finite; of the search
  std::vector<double> units{};     // of each joint in distances: 1 for hinges, m for slides
  double range = 2;                // longest step of a tree, as the 2-norm in these units
};

// Returns the 2-norm of the difference in units.
double DistanceIn(const JointSpace& space, std::span<const double> a, std::span<const double> b);

class GoalTrees {
 public:
  // Start and goals must be free; there is at least one goal. They must outlive the search.
  GoalTrees(std::span<const double> start, const Rows& goals, const JointSpace& space,
            EdgeJudge* judge);

  // Tries straight motions to the nearest goals.
  void TryDirect(int goals);
  // Grows both trees once.
  void Step(Rng& rng);

  bool found() const { return !path_.empty(); }
  const Rows& path() const { return path_; }  // from the start to a goal; empty until found
  // Returns the index of the goal that the path ends at.
  int goal() const { return goal_; }
  // Returns true if both trees have grown: more steps may find a path. A tree that never grew is
  // shut in.
  bool start_grows() const { return trees_[0].size() > 1; }
  bool goals_grow() const { return trees_[1].size() > goals_; }

 private:
  class Tree {
   public:
    explicit Tree(const JointSpace& space) : space_(&space) {}
    int size() const { return static_cast<int>(parents_.size()); }
    void Add(std::span<const double> q, int parent);
    int Nearest(std::span<const double> q) const;
    std::span<const double> at(int node) const;
    int parent(int node) const { return parents_[node]; }

   private:
    const JointSpace* space_;
    std::vector<double> rows_;
    std::vector<int> parents_;
    std::vector<float> columns_;  // in units, for the search of neighbours
    int stride_ = 0;
    mutable std::vector<float> asked_;
  };
  enum class Growth { kTrapped, kAdvanced, kReached };

  Growth Extend(Tree& tree, std::span<const double> towards);
  void Join(int start_node, int goal_node);

  const JointSpace& space_;
  EdgeJudge& judge_;
  Tree trees_[2];
  int goals_;
  Rows path_;
  int goal_ = -1;
  std::vector<double> drawn_, next_;
};

// Shortens a path: leaves out waypoints, then replaces stretches between two random points of it
// by straight motions, `tries` times.
void Shorten(Rows* path, const JointSpace& space, EdgeJudge* judge, Rng& rng, int tries);

double LengthIn(const JointSpace& space, const Rows& path);

}  // namespace robocell::internal
