// Finds the best of several solutions of a query, or one that a filter keeps. For ik.cc,
// ik_batch.cc and ik_solutions.cc.
//
// Each query has kSearches searches at a time, each with its own starts; their solutions are
// filtered and compared. If none was kept, the searches continue from their next starts, and
// without further starts begin again with more time for each: many searches with a few starts each
// do not miss solutions that one search finds after many starts. The result depends on the query
// alone.
//
// Without redundant joints, where solutions can be counted, starts continue until many of them
// found nothing better.
#pragma once

#include <atomic>
#include <functional>
#include <span>

#include "robocell/kinematics/filter_call.h"
#include "robocell/kinematics/ik.h"
#include "robocell/kinematics/ik_preference.h"
#include "robocell/kinematics/ik_task.h"
#include "robocell/kinematics/lane_solver.h"

namespace robocell::internal {

// Chains without redundant joints have a countable set of solutions: how long to search for all of
// them. A caller that allows fewer starts than these wants a quick result, and gets no more.
inline constexpr int kFewStarts = 48;

// Returns true if starts continue beyond max_restarts, until all solutions are most likely known.
bool LooksForAll(const Chain& chain, const IkTask& task, const IkOptions& options);

// Returns true if more starts may lead to another (or better) solution, if start `newest` was the
// first to lead to the last such one and `begun` were tried. The search ends after `quiet` starts
// in a row without one, and after 2000 more than allowed, because singular poses have infinitely
// many.
bool MayFindAnother(const IkOptions& options, int newest, int begun, int quiet);

// Returns true if some joint differs by more than `least`: rad (modulo whole turns), lengths of the
// chain.
bool AreApart(const ChainModel& chain, const JointVector& a, const JointVector& b, double least);

// Nearer solutions count as one, rad: they are as near as the tolerance of the tip can distinguish.
inline constexpr double kAnother = 0.05;

// Returns true if these options need a choice between solutions.
bool IsChosen(const IkOptions& options);

class IkChoice {
 public:
  // Number of searches for one query, and of compared solutions.
  static constexpr int kSearches = 16;

  struct Search {
    int next_start = 0, starts_left = 0, began = 0;
    bool patient = false;  // LaneQuery::patient
    bool open = false;     // has to run
    bool unmoved_too = false;
    IkResult found, unmoved;
  };

  // `searches`: memory for kSearches of each query. All arguments must outlive this object.
  IkChoice(const Chain& chain, const IkOptions& options, std::span<const LaneQuery> queries,
           std::span<Search> searches, std::span<IkResult> answers);

  // Runs the open searches of every `stride`-th query from `first` on, until `ended`; several
  // threads may do so. `poll` may be empty; it is called occasionally.
  void Run(int first, int stride, const std::atomic<bool>& ended,
           const std::function<void()>& poll);
  // Filters and chooses after all have run. Returns false when every query has its result.
  bool Choose();

 private:
  class Queue;

  void Begin(int query, bool patient);
  void Open(int query, int searches);
  bool MayBeginAgain(int query) const;
  // Returns true if a better solution may still be found.
  bool GoesOn(int query) const;
  // Adds one start to each search.
  void LookFurther(int query);
  // Returns the cost of the present solution; infinite without one.
  double CostOf(int query) const;
  JointVector GoalOf(int query) const;
  // Calls use(result, cost) for each solution of a search that is better than `least`.
  template <class Use>
  void ForBetter(Search& search, const JointVector& goal, double least, const Use& use);
  void ChooseFor(int query, std::span<const uint8_t> keep, std::size_t* row);
  // Returns which solutions, in the order of finding, the filter keeps; empty without a filter.
  std::span<const uint8_t> Filter();
  double Miss(const IkResult& result) const;
  int StartsFor(const LaneQuery& query) const;
  // Returns additional starts if there is no solution but a start came near, as for queries without
  // a preference.
  int MoreStartsFor(int query) const;

  const Chain& chain_;
  const IkOptions& options_;
  IkTask task_;
  IkPreference preference_;
  bool compares_all_ = false;  // true without redundant joints
  std::span<const LaneQuery> queries_;
  std::span<Search> searches_;
  std::span<IkResult> answers_;
  FilterCall filtered_;
};

}  // namespace robocell::internal
