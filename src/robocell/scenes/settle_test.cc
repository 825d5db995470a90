#include "robocell/scenes/settle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/testing/pick_scene.h"

namespace robocell::internal {
namespace {

PickScene Dropped(double height) {
  SceneObject box = ObjectOnTheTable("box");
  (*box.pos)[2] += height;
  PickScene pick = MakePickScene(box);
  pick.scene.Reset();
  return pick;
}

TEST(Settle, EndsAtRest) {
  PickScene pick = Dropped(0.002);
  EXPECT_EQ(Settle(pick.scene, {&pick.robot, 1}, pick.target_body, {}), "");
  const Pose before = pick.scene.body_pose(pick.target_body);
  EXPECT_TRUE(pick.scene.StepN(100).ok());
  EXPECT_TRUE(pick.scene.body_pose(pick.target_body).is_close(before, 1e-4, 1e-3));
}

// The oracle for the rate of updates is a controller that counts them.
class Counting : public Controller {
 public:
  Counting(MoveGroup& group, int* count) : group_(group), count_(count), q_(group.joint_pos()) {}
  std::string_view kind() const override { return "counting"; }
  int target_size() const override { return group_.nq(); }
  void SetTarget(std::span<const double>) override {}
  std::span<const double> target() const override { return q_; }
  std::span<const double> commanded_joint_pos() const override { return q_; }
  std::span<double> command_port() override { return q_; }
  void Reset() override {}
  void Compute(std::span<double> ctrl) override {
    ++*count_;
    group_.CtrlForJointPos(q_, ctrl);
  }

 private:
  MoveGroup& group_;
  int* count_;
  std::vector<double> q_;
};

TEST(Settle, ControlsTheRobotAtTheControlRate) {
  for (const int sim_steps : {1, 4}) {
    PickScene pick = Dropped(0);
    int updates = 0;
    pick.robot.SetController("arm", std::make_unique<Counting>(pick.robot.arm(), &updates));
    EXPECT_EQ(Settle(pick.scene, {&pick.robot, 1}, pick.target_body, {.sim_steps = sim_steps}), "");
    EXPECT_NEAR(updates * sim_steps * pick.scene.timestep(), pick.scene.time(), 1e-9);
  }
}

TEST(Settle, RejectsATargetThatMoves) {
  PickScene pick = Dropped(0.3);
  EXPECT_EQ(Settle(pick.scene, {&pick.robot, 1}, pick.target_body, {}),
            "the target rolled away or fell off its support");
}

}  // namespace
}  // namespace robocell::internal
