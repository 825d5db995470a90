#include "robocell/task/task_calls.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "robocell/base/hook_error.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;

// Each hook does what the test says, or raises.
class Failing final : public Task {
 public:
  void Prepare(SceneSpec&, Rng&) override { Fail(); }
  void Bind(const Scene&, const TaskSetting&) override { Fail(); }
  BodyPoses Starts(Rng&) override { return Fail(), starts; }
  std::optional<Refusal> Arrange(Scene&, Rng&) override { return Fail(), Refusal{"mine"}; }
  TaskVerdict Judge(const Scene&) override { return {}; }
  std::string instruction() const override { return Fail(), "fail"; }
  std::vector<std::string> resting_objects() const override { return Fail(), resting; }
  Map<ObjectPlace> places() const override { return Fail(), Map<ObjectPlace>(); }
  std::string why_not_done() const override { return Fail(), "not yet"; }
  std::vector<std::string> subtasks() const override { return Fail(), std::vector<std::string>(); }
  std::vector<double> memory() const override { return Fail(), std::vector<double>{1}; }
  void Recall(std::span<const double>) override { Fail(); }
  bool CanRecall(std::span<const double>) const override { return Fail(), true; }
  bool HoldsElsewhere(std::span<const double>) const override { return Fail(), true; }
  std::string PlaceOfHook(const char* method) const override {
    return std::string("task.py:7, in ") + method;
  }

  BodyPoses starts;
  std::vector<std::string> resting;
  bool fails = false;

 private:
  void Fail() const {
    if (fails) throw std::runtime_error("no luck");
  }
};

struct TaskCallsTest : ::testing::Test {
  SceneSpec spec = [] {
    SceneSpec made{.name = "cube", .timestep = 0.002, .add_floor = false, .add_skybox = false};
    made.objects.push_back(BoxObject("cube", {0, 0, 1}));
    return made;
  }();
  Scene scene = Scene::Build(spec);
  Rng rng = Rng::Stream(0, "task calls");
  Failing task;
  TaskCalls calls{task};
};

TEST_F(TaskCallsTest, ReturnsWhatTheHooksReturn) {
  task.starts = {{"cube", Pose(Eigen::Vector3d(1, 2, 3))}};
  task.resting = {"cube"};
  EXPECT_EQ(calls.Starts(rng).size(), 1);
  EXPECT_EQ(calls.Arrange(scene, rng)->reason, "mine");
  EXPECT_THAT(calls.RestingObjects(scene), ElementsAre("cube"));
  EXPECT_TRUE(calls.Places().empty());
  EXPECT_EQ(calls.Instruction(), "fail");
  EXPECT_EQ(calls.WhyNotDone(), "not yet");
  EXPECT_THAT(calls.Memory(), ElementsAre(1));
  EXPECT_TRUE(calls.CanRecall({}));
  EXPECT_TRUE(calls.HoldsElsewhere({}));
}

TEST_F(TaskCallsTest, AFailureOfAnyHookNamesItsPlace) {
  task.fails = true;
  const std::map<std::string, std::function<void()>> hooks = {
      {"prepare", [&] { calls.Prepare({}, spec, rng, "failing"); }},
      {"bind", [&] { calls.Bind(scene, {}); }},
      {"starts", [&] { calls.Starts(rng); }},
      {"arrange", [&] { calls.Arrange(scene, rng); }},
      {"resting_objects", [&] { calls.RestingObjects(scene); }},
      {"places", [&] { calls.Places(); }},
      {"instruction", [&] { calls.Instruction(); }},
      {"why_not_done", [&] { calls.WhyNotDone(); }},
      {"subtasks", [&] { calls.Subtasks(); }},
      {"memory", [&] { calls.Memory(); }},
      {"recall", [&] { calls.Recall({}); }}};
  for (const auto& [hook, call] : hooks) {
    EXPECT_THAT(ExpectThrow<HookError>(call, "in " + hook + ": no luck"),
                EndsWith("(task.py:7, in " + hook + ")"));
  }
}

TEST_F(TaskCallsTest, PutsBodiesAtTheirStarts) {
  const Pose pose(Eigen::Vector3d(1, 2, 3));
  calls.Put(scene, {{"cube", pose}});
  EXPECT_TRUE(scene.body_pose("cube").is_close(pose, 1e-12, 1e-12));
  scene.Reset();
  calls.Reset(scene, {.body_poses = {{"cube", pose}}});
  EXPECT_TRUE(scene.body_pose("cube").is_close(pose, 1e-12, 1e-12));
}

TEST_F(TaskCallsTest, AStartOfAnUnknownBodyIsAnErrorOfStarts) {
  const BodyPoses lost = {{"cubee", Pose()}};
  for (const std::function<void()>& put :
       {std::function<void()>([&] { calls.Put(scene, lost); }),
        std::function<void()>([&] { calls.Reset(scene, {.body_poses = lost}); })}) {
    EXPECT_THAT(ExpectThrow<HookError>(put, "no body 'cubee'"), EndsWith("(task.py:7, in starts)"));
  }
}

TEST_F(TaskCallsTest, OtherErrorsOfAResetAreNotErrorsOfStarts) {
  scene.AddResetHook([](const ResetContext&) { throw NotFoundError("no lamp"); });
  const std::string text = ExpectThrow<NotFoundError>(
      [&] {
        calls.Reset(scene, {.body_poses = {{"cube", Pose()}}});
      },
      "no lamp");
  EXPECT_EQ(text, "no lamp");
}

TEST_F(TaskCallsTest, RejectsARestingObjectThatTheSceneLacks) {
  task.resting = {"cubee"};
  ExpectThrow<HookError>([&] { calls.RestingObjects(scene); }, "no object 'cubee'");
}

}  // namespace
}  // namespace robocell::internal
