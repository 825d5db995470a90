#include "robocell/task/task_judge.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/base/hook_error.h"
#include "robocell/base/log.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;

// Returns the verdict that a test gives it.
class Obedient : public Task {
 public:
  void Begin(const Scene&) override { ++begun; }
  TaskVerdict Judge(const Scene&) override {
    if (throws) throw NotFoundError("no body 'cubee'");
    return verdict;
  }
  std::string instruction() const override { return "obey"; }
  std::vector<std::string> subtasks() const override { return ++calls, names; }
  std::string PlaceOfHook(const char* method) const override {
    return std::string("task.py:7, in ") + method;
  }

  TaskVerdict verdict;
  std::vector<std::string> names;
  bool throws = false;
  int begun = 0;
  mutable int calls = 0;
};

struct TaskJudgeTest : ::testing::Test {
  std::string WhyNot(const TaskVerdict& verdict) {
    task.verdict = verdict;
    return ExpectThrow<HookError>([&] { judge.Judge(); }, "duo: the task's ");
  }

  Obedient task;
  TaskJudge judge{task, RobotAlone(Rc7()).scene(), "duo"};
};

TEST_F(TaskJudgeTest, ForwardsAVerdict) {
  task.names = {"reach", "lift"};
  task.verdict = {.reward = -3, .success = true, .progress = 0.5, .subtask = 1};
  judge.Begin();
  const TaskVerdict verdict = judge.Judge();
  EXPECT_EQ(task.begun, 1);
  EXPECT_EQ(verdict.reward, -3);
  EXPECT_TRUE(verdict.success);
  EXPECT_EQ(verdict.progress, 0.5);
  EXPECT_EQ(verdict.subtask, 1);
  EXPECT_THAT(judge.subtasks(), ElementsAre("reach", "lift"));
}

TEST_F(TaskJudgeTest, RejectsInvalidVerdicts) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(WhyNot({.reward = kNan}),
            "duo: the task's reward is nan at t = 0.000 s; rewards must be finite numbers "
            "(task.py:7, in judge)");
  WhyNot({.reward = -INFINITY});
  EXPECT_EQ(WhyNot({.progress = 7}),
            "duo: the task's progress is 7 at t = 0.000 s; it must be a number from 0 to 1 "
            "(task.py:7, in judge)");
  WhyNot({.progress = -0.01});
  WhyNot({.progress = kNan});
}

TEST_F(TaskJudgeTest, AcceptsRoundingErrorsOfProgress) {
  for (const double progress : {-1e-12, 1 + 1e-12}) {
    task.verdict = {.progress = progress};
    EXPECT_EQ(judge.Judge().progress, std::round(progress));
  }
}

TEST_F(TaskJudgeTest, RejectsASubtaskWithoutAName) {
  EXPECT_EQ(WhyNot({.subtask = 1}),
            "duo: the task's subtask is 1; subtasks() is empty, so it must be 0 "
            "(task.py:7, in judge)");
  task.names = {"reach", "lift"};
  judge.Begin();
  for (const int subtask : {-1, 2, 9}) {
    EXPECT_EQ(WhyNot({.subtask = subtask}),
              fmt::format("duo: the task's subtask is {}; it must be 0 to 1, an index into "
                          "subtasks(): reach, lift (task.py:7, in judge)",
                          subtask));
  }
}

TEST_F(TaskJudgeTest, QueriesTheNamesOnceAnEpisode) {
  task.names = {"reach", "lift"};
  judge.Begin();
  judge.Judge();
  EXPECT_EQ(task.calls, 0) << "index 0 needs no names";
  task.verdict.subtask = 1;
  for (int i = 0; i < 3; ++i) judge.Judge();
  EXPECT_EQ(task.calls, 1);
}

TEST_F(TaskJudgeTest, ErrorsOfHooksNameTheirPlace) {
  task.throws = true;
  ExpectThrow<HookError>([&] { judge.Judge(); }, "no body 'cubee' (task.py:7, in judge)");
}

TEST_F(TaskJudgeTest, WarnsOnceAboutAnEmptyInstruction) {
  std::vector<std::string> lines;
  const auto keep = [&](LogLevel, std::string_view text) { lines.emplace_back(text); };
  const ScopedLogSink capture(keep);
  WarnOfNoWords(task, "wordy", "obey");
  WarnOfNoWords(task, "mute", "");
  WarnOfNoWords(task, "mute", " \t");
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0],
            "task 'mute': instruction() has no words, and episodes are recorded and policies act "
            "without any; return what is to be done, such as 'pick up the mug' (task.py:7, in "
            "instruction)");
}

}  // namespace
}  // namespace robocell::internal
