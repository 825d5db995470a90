// Tests the step of a cell: commands, ticks, going back, and the verdict.
#include "robocell/env/cell.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <limits>
#include <string>
#include <vector>

#include "robocell/base/hook_error.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

// Judges the time that has passed.
class CellClockTask : public Task {
 public:
  void Begin(const Scene&) override { ++begun; }
  TaskVerdict Judge(const Scene& scene) override { return {.reward = scene.time() + offset}; }
  std::string instruction() const override { return "wait"; }
  std::vector<std::string> subtasks() const override { return {"wait", "rest"}; }

  int begun = 0;
  double offset = 0;
};

class CellTest : public ::testing::Test {
 protected:
  Cell Make(Task* of) { return Cell(robot.scene(), {robot}, {5, 2}, of, "test"); }
  static constexpr double kStep = 0.002;

  Robot robot = RobotAlone(Rc7());
  Scene scene = robot.scene();
  CellClockTask task;
};

TEST_F(CellTest, AStepSendsCommandsSimulatesAndJudges) {
  Cell cell = Make(&task);
  cell.Begin();
  EXPECT_EQ(task.begun, 1);
  EXPECT_EQ(cell.subtasks(), (std::vector<std::string>{"wait", "rest"}));
  std::vector<double> ticks;
  cell.set_on_control_tick([&](const mjModel*, const mjData* d) { ticks.push_back(d->time); });
  int sent = 0;
  const auto send = [&] {
    EXPECT_TRUE(ticks.empty()) << "commands come before the simulation";
    ++sent;
    return cell.Send({});
  };
  const CellStep step = cell.Step({.send = send});
  EXPECT_TRUE(step.ok());
  EXPECT_EQ(sent, 1);
  EXPECT_EQ(ticks.size(), 5u);
  EXPECT_EQ(step.step.steps, 10);
  EXPECT_NEAR(step.verdict.reward, 10 * kStep, 1e-12);
}

TEST_F(CellTest, AStepEndsAfterItsTicksOrWhenItIsDone) {
  Cell cell = Make(nullptr);
  const auto send = [&] { return cell.Send({}); };
  EXPECT_EQ(cell.Step({.send = send, .most_ticks = 3}).step.steps, 6);
  int ticks = 0;
  EXPECT_EQ(cell.Step({.send = send, .done = [&] { return ++ticks == 2; }}).step.steps, 4);
  EXPECT_EQ(cell.Step({.send = send}).verdict.reward, 0) << "there is no task";
  EXPECT_TRUE(cell.subtasks().empty());
}

TEST_F(CellTest, ARevokedStepIsSimulatedAgainAndJudgedOnce) {
  Cell cell = Make(&task);
  const std::vector<double> before = scene.state();
  int ticks = 0, sent = 0;
  cell.set_on_control_tick([&](const mjModel*, const mjData*) { ++ticks; });
  const CellStep step = cell.Step({.send = [&] { return ++sent, cell.Send({}); },
                                   .goes_back = [&] { return scene.SetState(before), true; }});
  EXPECT_EQ(sent, 1);
  EXPECT_EQ(ticks, 10);
  EXPECT_NEAR(step.verdict.reward, 10 * kStep, 1e-12) << "of the second simulation alone";
}

TEST_F(CellTest, ADivergedStepHasNoVerdictAndIsNotRevoked) {
  Cell cell = Make(&task);
  const auto send = [&] {
    scene.data()->qvel[0] = 1e12;
    return StepOutcome();
  };
  bool was_called = false;
  const CellStep step =
      cell.Step({.send = send, .goes_back = [&] { return was_called = true, false; }});
  EXPECT_FALSE(step.ok());
  EXPECT_FALSE(was_called);
  EXPECT_EQ(step.verdict.reward, 0);
}

TEST_F(CellTest, AVerdictThatIsNotANumberNamesThePlace) {
  Cell cell = Make(&task);
  task.offset = std::numeric_limits<double>::infinity();
  ExpectThrow<HookError>([&] { cell.Step({.send = [&] { return cell.Send({}); }}); },
                         "test: the task's reward is inf");
  cell.DropTask();
  EXPECT_EQ(cell.Step({.send = [&] { return cell.Send({}); }}).verdict.reward, 0);
}

}  // namespace
}  // namespace robocell::internal
