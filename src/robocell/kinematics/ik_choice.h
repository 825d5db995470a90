// Answers questions that are asked for the best of several solutions, or for one that a filter
// keeps. For ik.cc and ik_batch.cc.
//
// A question is searched for in kSearches ways at a time, each with starts of its own; what is
// found is filtered and compared. Where nothing was kept, the searches go on from their next
// starts, and when there are no more, begin once more with more time for each: what a search alone
// finds after many starts is not missed by many that have a few each. What a question is answered
// depends on the question alone.
//
// Where no joints are to spare, so that the best is one of a few, starts go on after a solution was
// found until many of them have led to no better one.
#pragma once

#include <atomic>
#include <functional>
#include <span>

#include "robocell/kinematics/filter_call.h"
#include "robocell/kinematics/ik_preference.h"
#include "robocell/kinematics/ik_task.h"
#include "robocell/kinematics/lane_solver.h"

namespace robocell::internal {

// Whether an answer with these options has to be chosen.
bool IsChosen(const IkOptions& options);

class IkChoice {
 public:
  // Ways to look for one answer; so many solutions are compared.
  static constexpr int kSearches = 16;

  struct Search {
    int next_start = 0, starts_left = 0, began = 0;
    bool patient = false;  // LaneQuestion::patient
    bool open = false;     // has to be run
    bool unmoved_too = false;
    IkResult found, unmoved;
  };

  // `searches`: memory for kSearches of each question. Everything given must outlive this.
  IkChoice(const Chain& chain, const IkOptions& options, std::span<const LaneQuestion> questions,
           std::span<Search> searches, std::span<IkResult> answers);

  // Runs the open searches of every `stride`-th question from `first` on, until `ended`; several
  // threads may do so. `poll` may be empty; it is called now and then.
  void Run(int first, int stride, const std::atomic<bool>& ended,
           const std::function<void()>& poll);
  // Filters and chooses, when all have run. False when every question has its answer.
  bool Choose();

 private:
  class Queue;

  void Begin(int question, bool patient);
  void Open(int question, int searches);
  bool MayBeginAgain(int question) const;
  // Whether a better solution than the present one may still come.
  bool GoesOn(int question) const;
  // One more start for each search.
  void LookFurther(int question);
  // Of the answer so far; infinite where there is none.
  double CostOf(int question) const;
  JointVector GoalOf(int question) const;
  // Calls use(result, cost) for each solution of a search that is better than `least`.
  template <class Use>
  void ForBetter(Search& search, const JointVector& goal, double least, const Use& use);
  void ChooseFor(int question, std::span<const uint8_t> keep, std::size_t* row);
  // Which of the solutions found, in their order, the filter keeps; empty without one.
  std::span<const uint8_t> Filter();
  double Miss(const IkResult& result) const;
  int StartsFor(const LaneQuestion& question) const;
  // Where nothing was found, but an approach came near, as for questions without a preference.
  int MoreStartsFor(int question) const;

  const Chain& chain_;
  const IkOptions& options_;
  IkTask task_;
  IkPreference preference_;
  bool compares_all_ = false;  // no joints are to spare
  std::span<const LaneQuestion> questions_;
  std::span<Search> searches_;
  std::span<IkResult> answers_;
  FilterCall filtered_;
};

}  // namespace robocell::internal
