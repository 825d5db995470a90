// Tests when a task whose goal is relations is done. Objects are put in place; nothing is simulated
// but time.
#include "robocell/task/relation_task.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/joint_opening.h"
#include "robocell/task/relation_tasks.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

constexpr double kStacked = 1e-4;  // m, penetration of touching cubes

SceneObject Cube(const std::string& name, const Vec3& pos) { return BoxObject(name, pos); }

// Two cubes and a panel with buttons; no robot.
class RelationTaskTest : public ::testing::Test {
 protected:
  RelationTaskTest() {
    SceneSpec spec = EmptyScene();
    spec.objects.push_back(Cube("red", {0, 0, 0.02}));
    spec.objects.push_back(Cube("blue", {0.3, 0, 0.02}));
    spec.objects.push_back(
        {.name = "panel", .mjcf_path = "button_panel", .pos = Vec3{1, 0, 0}, .fixed = true});
    scene_.emplace(Scene::Build(spec));
    scene_->Reset();
  }
  void Put(const std::string& cube, const Eigen::Vector3d& at) {
    scene_->SetBodyPose(cube, Pose(at));
    scene_->Forward();
  }
  void Wait(double seconds) { scene_->data()->time += seconds; }
  RelationsTask Begun(const RelationsTaskConfig& fields) {
    RelationsTask task(fields);
    task.Begin(*scene_);
    return task;
  }

  std::optional<Scene> scene_;
};

TEST_F(RelationTaskTest, IsDoneOnceAllRelationsHaveHeldForTheTime) {
  RelationsTask task =
      Begun({.goal = {"red on blue", "blue in_region 0.3 0 0.05"}, .hold_seconds = 0.5});
  TaskVerdict verdict = task.Judge(*scene_);
  EXPECT_FALSE(verdict.success);
  EXPECT_EQ(verdict.subtask, 0);
  EXPECT_NEAR(verdict.progress, 0.5, 1e-9);  // the second relation holds
  Put("red", {0.3, 0, 0.06 - kStacked});
  EXPECT_FALSE(task.Judge(*scene_).success);
  Wait(0.4);
  EXPECT_FALSE(task.Judge(*scene_).success);
  Wait(0.1);
  EXPECT_TRUE(task.Judge(*scene_).success);
  EXPECT_EQ(task.Judge(*scene_).progress, 1);
  Put("red", {0, 0, 0.02});  // undone: the time begins again
  EXPECT_FALSE(task.Judge(*scene_).success);
  Put("red", {0.3, 0, 0.06 - kStacked});
  EXPECT_FALSE(task.Judge(*scene_).success);
}

TEST_F(RelationTaskTest, APressedButtonStaysPressedForTheEpisode) {
  RelationsTask task = Begun({.goal = {"panel_red_button pressed 0.7"}, .hold_seconds = 0});
  JointOpening button = JointOpening::Of(*scene_, "panel_red_button");
  button.Put(0.69);
  scene_->Forward();
  EXPECT_FALSE(task.Judge(*scene_).success);
  button.Put(0.71);
  scene_->Forward();
  EXPECT_TRUE(task.Judge(*scene_).success);
  button.Put(0);
  scene_->Forward();
  EXPECT_TRUE(task.Judge(*scene_).success);
  task.Begin(*scene_);
  EXPECT_FALSE(task.Judge(*scene_).success);
}

TEST_F(RelationTaskTest, RemembersWhatHasHeld) {
  const RelationsTaskConfig fields{.goal = {"panel_red_button pressed", "red on blue"}};
  RelationsTask task = Begun(fields), other = Begun(fields);
  JointOpening button = JointOpening::Of(*scene_, "panel_red_button");
  button.Put(1);
  scene_->Forward();
  task.Judge(*scene_);
  button.Put(0);
  scene_->Forward();
  const std::vector<double> memory = task.memory();
  EXPECT_EQ(other.WhyNotRecalled(memory), "");
  EXPECT_NE(other.Judge(*scene_).progress, task.Judge(*scene_).progress);
  other.Recall(memory);
  EXPECT_EQ(other.Judge(*scene_).progress, task.Judge(*scene_).progress);
  EXPECT_EQ(other.memory(), task.memory());
  std::vector<double> wrong = memory;
  wrong[0] = std::nan("");
  EXPECT_NE(other.WhyNotRecalled(wrong), "");
  wrong = memory, wrong[1] = 3;
  EXPECT_NE(other.WhyNotRecalled(wrong), "");
}

TEST_F(RelationTaskTest, JoinsTheWordsOfItsGoals) {
  const RelationsTask task({.objects = {"red=box", "blue=box"},
                            .goal = {"red next_to blue", "panel_red_button pressed"}});
  EXPECT_EQ(task.instruction(), "put the red next to the blue and press the panel red button");
  EXPECT_THAT(task.subtasks(),
              ElementsAre("put the red next to the blue", "press the panel red button"));
  EXPECT_EQ(StackTask({.cubes = 3}).instruction(),
            "put the blue cube on the red cube and put the green cube on the blue cube");
}

// Robots without hands, plates, hold a cube between them: the subject or the reference of the goal.
TEST(RelationTask, IsNotDoneWhileARobotHoldsAFreeObjectOfTheGoal) {
  ModelFolder folder;
  const std::string plate = folder.Write("plate", R"(<worldbody><body name="plate">
      <geom type="box" size=".01 .05 .05"/></body></worldbody>)");
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.name = "left", .path = plate, .prefix = "left_", .pos = {-0.0299, 0, 1}});
  spec.robots.push_back(
      {.name = "right", .path = plate, .prefix = "right_", .pos = {0.0299, 0, 1}});
  spec.objects.push_back(Cube("red", {0, 0, 1}));
  spec.objects.push_back(Cube("blue", {0.3, 0, 0.02}));
  Scene scene = Scene::Build(spec);
  scene.Reset();
  scene.Forward();
  const auto is_released = [&](const std::vector<std::string>& goal) {
    RelationsTask task({.goal = NameList{goal}});
    task.Bind(scene, {.place = "test", .robots = {}});
    task.Begin(scene);
    return task.IsReleased(scene);
  };
  EXPECT_FALSE(is_released({"red in_region 0 0 1"}));
  EXPECT_FALSE(is_released({"blue next_to red 1"}));
  EXPECT_TRUE(is_released({"blue in_region 0 0 1"}));
  EXPECT_TRUE(is_released({"blue next_to red 1", "red held"}));
}

TEST_F(RelationTaskTest, RemembersOnlyWhatItCanHaveSaved) {
  const RelationsTask task = Begun({.goal = {"panel_red_button pressed"}});
  for (const double wrong : {2.0, -1.0, std::nan("")})
    EXPECT_NE(task.WhyNotRecalled(std::vector<double>{0, 0, wrong}), "") << wrong;
  EXPECT_EQ(task.WhyNotRecalled(std::vector<double>{0, 0, 1}), "");
}

// Its second choice has two goals, the first one has one.
class TaskWithChoices final : public RelationTask {
 public:
  void Choose(size_t chosen) override { chosen_ = chosen; }

 private:
  void AddObjects(SceneSpec& /*spec*/, Rng& /*rng*/) override {}
  std::vector<std::string> StatedGoal() const override {
    if (chosen_ == 0) return {"panel_red_button pressed"};
    return {"panel_red_button pressed", "red on blue"};
  }
  size_t chosen() const override { return chosen_; }
  size_t choices() const override { return 2; }

  size_t chosen_ = 0;
};

TEST_F(RelationTaskTest, RecallsTheMemoryOfWhatWasChosen) {
  TaskWithChoices task, other;
  task.Choose(1);
  for (TaskWithChoices* each : {&task, &other}) each->Begin(*scene_);
  task.Judge(*scene_);
  other.Recall(task.memory());
  EXPECT_EQ(other.memory(), task.memory());
  EXPECT_EQ(other.goals().size(), 2u);
  ExpectThrow<ArgumentError>(
      [&] {
        other.Recall(std::vector<double>{0, 1, 1});
      },
      "the memory has 3 numbers, and the goal of what the start has drawn "
      "remembers 4");
}

TEST_F(RelationTaskTest, SaysWhichGoalIsNotReached) {
  RelationsTask task = Begun({.goal = {"blue in_region 0.3 0 0.05", "red on blue"}});
  EXPECT_EQ(task.why_not_done(), "not done: red on blue");
}

TEST_F(RelationTaskTest, RejectsFieldsThatAFileCouldNotHave) {
  ExpectThrow<SpecError>([] { RelationsTask({}); }, "write at least one relation");
  ExpectThrow<SpecError>([] { StackTask({.cubes = 7}); }, "a stack has 2 to 6 cubes");
  ExpectThrow<SpecError>([] { StackTask::NamesOf(7); }, "a stack has 2 to 6 cubes");
  ExpectThrow<SpecError>([] { StackTask({.edge = 0}); }, "edge");
  ExpectThrow<SpecError>([] { PushTask({.distance = {0.01, 0.1}}); }, "within the region");
  ExpectThrow<SpecError>(
      [] {
        JointTask(OpenTaskConfig{.start_opening = {0, 0.9}});
      },
      "leave something to open");
}

// A start whose relation has no free place is refused, and one that has is made.
TEST_F(RelationTaskTest, PutsObjectsWhereTheStartHoldsAndNothingElseIs) {
  Rng rng = Rng::Stream(0, "starts");
  RelationsTask task({.start = {"red in_region 0.3 0 0.06"}, .goal = {"red on blue"}});
  task.Begin(*scene_);
  const auto held = BindRelation(*scene_, ParseRelation("red in_region 0.3 0 0.06"));
  for (int i = 0; i < 10; ++i) {
    Put("red", {0, 0, 0.02});
    const std::optional<Refusal> refused = task.Arrange(*scene_, rng);
    ASSERT_FALSE(refused.has_value()) << refused->reason;
    EXPECT_TRUE(held->Holds());
    EXPECT_THAT(task.resting_objects(), ElementsAre("red"));
    const Eigen::Vector3d apart =
        scene_->body_pose("red").translation() - scene_->body_pose("blue").translation();
    EXPECT_GT(apart.norm(), 0.039);  // blue is in the region already
  }
  RelationsTask full({.start = {"red in_region 0.3 0 0.005"}, .goal = {"red on blue"}});
  full.Begin(*scene_);
  Put("red", {0, 0, 0.02});
  const std::optional<Refusal> refusal = full.Arrange(*scene_, rng);
  ASSERT_TRUE(refusal.has_value());
  EXPECT_EQ(refusal->reason, "no free place for the start");
}

TEST_F(RelationTaskTest, NamesWhatTheSceneDoesNotHave) {
  const std::string why =
      ExpectThrow<NotFoundError>([&] { Begun({.goal = {"red on blu"}}); }, "goal \"red on blu\"");
  EXPECT_NE(why.find("Did you mean 'blue'?"), std::string::npos) << why;
  ExpectThrow<ArgumentError>([&] { Begun({.goal = {"red inside blue"}}); }, "has no hollow");
  ExpectThrow<ArgumentError>([&] { Begun({.goal = {"panel open"}}); }, "has 6 joints");
}

}  // namespace
}  // namespace robocell
