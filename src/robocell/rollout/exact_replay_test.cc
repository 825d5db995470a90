#include "robocell/rollout/exact_replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "robocell/rollout/testing/rollout_test_base.h"
#include "robocell/scene/body_handle.h"

namespace robocell::internal {
namespace {

using ExactReplayTest = RolloutTest;

// Done while the target is higher than at its start.
class Raised : public Task {
 public:
  explicit Raised(std::string body) : body_(std::move(body)) {}
  void Begin(const Scene& scene) override { start_ = Height(scene), ++begun; }
  TaskVerdict Judge(const Scene& scene) override {
    const bool raised = Height(scene) > start_ + 0.1;
    return {.reward = raised ? 1.0 : 0.0, .success = raised};
  }
  std::string instruction() const override { return "raise it"; }

  int begun = 0;

 private:
  double Height(const Scene& scene) const { return scene.body_pose(body_).translation().z(); }
  std::string body_;
  double start_ = 0;
};

// Raises the target without touching it: nothing that controls would do again.
class Telekinesis : public Commanding {
 public:
  Telekinesis(const Pose& leaf, std::string body) : Commanding(leaf, 3), body_(std::move(body)) {}
  Action Act(const Scene& scene, Rng& rng) override {
    Scene moved = scene;
    const Pose now = scene.body_pose(body_);
    moved.SetBodyPose(body_,
                      Pose(now.translation() + Eigen::Vector3d(0, 0, 0.3), now.quaternion()));
    return Commanding::Act(scene, rng);
  }

 private:
  std::string body_;
};

TEST_F(ExactReplayTest, ASuccessThatControlsDoNotRepeatIsAFailure) {
  const std::string body = start->scene.compiled()->object(start->target_object).root_body;
  auto task = std::make_shared<Raised>(body);
  start->task = task;
  Telekinesis expert(Robot::Of(start->scene, "rc7").FkFrame(), body);
  Rng rng = Rng::Stream(2, "expert");
  const std::vector<double> state = start->scene.state();
  for (const bool judge : {false, true}) {
    start->scene.SetState(state);
    Telekinesis again = expert;
    const RolloutResult result = RunRollout(run, *start, again, rng,
                                            {.dataset = folder.path(),
                                             .episode_id = judge ? "judged" : "plain",
                                             .metadata_json = "{}",
                                             .judge_replay = judge});
    EXPECT_EQ(result.success, !judge);
    EXPECT_EQ(result.committed, !judge);
    EXPECT_EQ(result.failure, judge ? "no success on exact replay" : "");
  }
  EXPECT_EQ(task->begun, 3);  // twice for the judged one
}

}  // namespace
}  // namespace robocell::internal
