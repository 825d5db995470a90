// Solves a queue of inverse kinematics queries, as many at a time as a processor core has lanes.
//
// A lane whose query is solved takes the next one at once, so that hard queries do not delay
// others. A lane without progress starts again elsewhere. The result depends on the query alone. A
// single query uses all lanes (SearchInLanes).
#pragma once

#include <span>

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/ik.h"

namespace robocell::internal {

struct LaneQuery {
  int number = 0;  // the caller's
  Transform target;
  std::span<const double> seed;  // tried first; empty: none
  // The starts to try: every `stride`-th from `first` on, at most `most` (-1: the number in the
  // options).
  int first = 0, stride = 1, most = -1;
  // Each start gets the time of its place among all starts of the query, instead of among those of
  // this search: that is more time for most, for solutions that are hard to find.
  bool patient = false;
};

// Source of queries and destination of results; called on the solving thread.
class LaneQueue {
 public:
  virtual ~LaneQueue() = default;
  // Returns false if there are no more.
  virtual bool Next(LaneQuery* query) = 0;
  virtual void Take(int number, const IkResult& answer) = 0;
  // Called before a search restarts; returns false if no more results are needed.
  virtual bool GoesOn() { return true; }
  // Called before Take if redundant joints were moved, with the solution before that.
  virtual void TakeUnmoved(int /*number*/, const IkResult& /*answer*/) {}
};

// Runs until the queue is empty and every query has a result. options.seed and options.filter have
// no meaning here. With a preference, redundant joints go to its goal after arrival. The starts are
// those of lane_starts.h.
void SolveLanes(const Chain& chain, const IkOptions& options, LaneQueue* queue);

// Solves one query in all lanes: each searches from its own start.
//
// A seed near the target searches alone for its first steps, because one lane is cheaper than
// several. If it is far or slow, others join it, but a solution from the seed takes precedence
// until the seed is given up. Otherwise the first lane to arrive has the solution (of several, the
// one that began first). The same query has the same solution on the same instruction set.
//
// options.prefer and options.filter have no meaning here. iterations: steps, each of all lanes at
// once. `poll` may be empty; it is called every so many starts.
IkResult SearchInLanes(const Chain& chain, const Transform& tip_in_base, const IkOptions& options,
                       const std::function<void()>& poll);

}  // namespace robocell::internal
