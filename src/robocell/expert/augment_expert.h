// AugmentExpert: repeats a demonstration (demonstration.h) from another start. Each of its segments is
// moved with the object that it refers to, and replayed as poses of the TCP with a small displacement;
// between segments the arm moves on newly planned paths, with the object in its hand as part of it.
//
// It chooses one of its sources for the present start: of those with the same kind of object and with
// all that the goal names, one that the arm can follow, near ones first. In a segment with an object
// in the hand it leads the object, not the TCP, where the source led it: a grasp that is a little
// different does not move the place. failure() is one of few texts.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/expert/demonstration.h"
#include "robocell/expert/expert.h"
#include "robocell/expert/guided_arm.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/task_sampler.h"

namespace robocell::internal {

class AugmentExpert final : public Expert {
 public:
  // For the robot, rates and noise of a run with `augment`. `sources` have segments.
  AugmentExpert(const RunConfig& run, const EpisodeStart& start, Demonstrations sources);

  void Begin(const Scene& scene, Rng& rng) override;
  Action Act(const Scene& scene, Rng& rng) override;
  bool done() const override { return finished_; }
  std::string failure() const override { return failure_; }
  int phase() const override;
  // "move" and the phases of the source, or "replay" if it has none.
  std::vector<std::string> phase_names() const override;
  // {"augmented": {"source": id of the episode, "segments": "labels" or "gripper", ...}}
  std::string results_json() const override;

 private:
  enum class Phase { kOpen, kMove, kReplay, kHold };

  const Demonstration* ChooseSource(const Scene& scene, Rng& rng);
  std::vector<const Demonstration*> FittingSources(const Scene& scene) const;
  bool Fits(const Scene& scene, const Demonstration& demo) const;
  bool CanFollow(const Scene& scene, const Demonstration& demo) const;
  double DistanceOf(const Scene& scene, const Demonstration& demo) const;
  std::string BodyOf(const Scene& scene, const std::string& name) const;
  std::string ReferenceOf(const Demonstration& demo, const DemoSegment& segment) const;
  Pose Displacement(const Scene& scene, const Demonstration& demo,
                    const DemoSegment& segment) const;
  std::vector<Pose> Targets(const Demonstration& demo, const DemoSegment& segment,
                            const Pose& displacement, const Pose& in_tcp) const;
  std::vector<JointPath> Follow(const std::vector<Pose>& tcp_in_world) const;
  const DemoSegment& segment() const { return demo_->segments[segment_]; }
  int RowAt(int tick) const;

  void Enter(Phase phase);
  void EnterNext();
  void Plan(const Scene& scene, Rng& rng);
  bool PlanMove(const Scene& scene, const std::vector<JointPath>& replays, Rng& rng);
  void Advance(const Scene& scene, Rng& rng);
  bool HasLost(const Scene& scene) const;
  void GiveUp(const std::string& why);

  RunConfig run_;
  std::shared_ptr<Task> task_;
  std::string object_kind_;
  Demonstrations sources_;
  double tick_;

  std::optional<Robot> robot_;
  const Demonstration* demo_ = nullptr;
  size_t segment_ = 0;
  std::optional<GuidedArm> arm_;
  JointPath replay_;
  JointVector target_;
  double opening_ = 1;
  Pose held_in_tcp_;  // at the start of the move
  Phase phase_ = Phase::kOpen;
  int ticks_ = 0;  // in this phase
  bool finished_ = false;
  std::string failure_;
};

}  // namespace robocell::internal
