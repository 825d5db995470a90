// Tests tasks in environments, and restoring saved states.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <memory>
#include <tuple>

#include "robocell/base/error.h"
#include "robocell/base/hook_error.h"
#include "robocell/base/units.h"
#include "robocell/env/arm_target.h"
#include "robocell/env/env.h"
#include "robocell/env/testing/envs.h"
#include "robocell/mujoco/owners.h"
#include "robocell/robot/gripper_group.h"
#include "robocell/task/held.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/task/task_kind.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;

// A cube in front of the built-in robot on a floor that is the root frame's ground.
class EnvTaskTest : public ::testing::Test {
 protected:
  EnvConfig Picking(const Pose& root = Pose()) {
    EnvConfig config = Rc7Env(ControlMode::kCartesianTquat, RelativeTo::kNone);
    config.root_frame_to_world = root;
    config.add_floor = false;
    const std::string cube = folder_.Write("cube", R"(<worldbody><body name="cube"><freejoint/>
      <geom size="0.02 0.02 0.02" type="box" mass="0.05" friction="1 0.02 0.001" condim="4"/>
      </body></worldbody>)");
    const std::string ground = folder_.Write("ground", R"(<worldbody><body name="ground">
      <geom size="1 1 0.05" type="box" pos="0 0 -0.05"/></body></worldbody>)");
    config.root_frame_objects["cube"] = {.mjcf_path = cube,
                                         .offset = Pose(Eigen::Vector3d(0.45, 0, 0.02))};
    config.root_frame_objects["ground"] = {.mjcf_path = ground};
    config.task = PickTaskConfig{.object = "cube", .spread = {0.05, 0.1}};
    return config;
  }

  static Pose Object(const Env& env, size_t object = 0) {
    const VectorPart part = env.layout().objects[object].tquat;
    return internal::PoseOfAction(ControlMode::kCartesianTquat,
                                  env.observation().subspan(part.begin, part.size));
  }

  static EnvStep MoveTo(Env& env, const Pose& tcp_in_shared, double gripper) {
    std::vector<double> action(8);
    internal::PutTquat(tcp_in_shared, action);
    action[7] = gripper;
    return env.Step(action);
  }

  // Grasps the object from above and lifts it.
  static EnvStep PickUp(Env& env) {
    const Pose object = Object(env);
    const Pose grasp(
        object.translation(),
        Pose::FromRpy(Eigen::Vector3d::Zero(), {internal::kPi, 0, object.rpy().z()}).quaternion());
    const auto above = [&](double height) {
      return Pose(grasp.translation() + Eigen::Vector3d(0, 0, height), grasp.quaternion());
    };
    MoveTo(env, above(0.12), 1);
    MoveTo(env, above(0.06), 1);
    MoveTo(env, above(0.0), 1);
    MoveTo(env, above(0.0), 0);
    MoveTo(env, above(0.05), 0);
    return MoveTo(env, above(0.12), 0);
  }

  // The same cube, to be put down beside its start, or on a mat of 1 cm.
  EnvConfig Placing(const Pose& root = Pose(), bool mat = false) {
    EnvConfig config = Picking(root);
    config.sim.max_convergence_time = 2;
    PickAndPlaceTaskConfig task{.object = "cube", .spread = {0.05, 0.1}};
    task.goal = Vec3{0.4, 0.25, 0.02};
    task.goal_spread = {0.05, 0.02};
    config.task = task;
    if (!mat) return config;
    config.root_frame_objects["mat"] = {.offset = Pose(Eigen::Vector3d(0.4, 0.25, 0.005)),
                                        .shape = Shape::kBox,
                                        .size = Vec3{0.06, 0.06, 0.005},
                                        .mass = 0.5};
    task.goal = Vec3{0, 0, 0.025};
    task.goal_object = "mat";
    config.task = task;
    return config;
  }

  static Eigen::Vector3d Goal(const Env& env) {
    const std::span<const double> goal =
        env.observation().subspan(env.layout().signals[0].part.begin);
    return {goal[0], goal[1], goal[2]};
  }

  // Moves the held object above the goal and down, releases it and leaves.
  static std::vector<EnvStep> PutDown(Env& env) {
    const Eigen::Vector3d goal = Goal(env);
    const auto at = [&](double height) {
      return Pose::FromRpy(goal + Eigen::Vector3d(0, 0, height), {internal::kPi, 0, 0});
    };
    return {MoveTo(env, at(0.12), 0), MoveTo(env, at(0.003), 0), MoveTo(env, at(0.003), 1),
            MoveTo(env, at(0.12), 1)};
  }

 private:
  ModelFolder folder_;
};

// Collectors of other languages count on it (Scene::Weak::handles).
TEST_F(EnvTaskTest, HoldsASingleSceneHandle) {
  for (EnvConfig config : {Picking(), Placing(), Rc7Duo(ControlMode::kJoints, RelativeTo::kNone)}) {
    config.features.names = {"time", "robots/*"};
    config.camera_adds["view"] = {.offset = Pose(Eigen::Vector3d(0, 0, 2))};
    config.cameras.streams = {{.name = "view", .camera = "view", .width = 32, .height = 32}};
    Env env(config);
    const Scene::Weak scene(env.scene());
    EXPECT_EQ(scene.handles(), 1u);
    env.Reset();
    const Robot robot = Robot::Of(env.scene(), config.robots.keys().front());
    EXPECT_EQ(scene.handles(), 2u) << "of a user";
    std::vector<double> action(static_cast<size_t>(env.layout().action.size()));
    if (config.control_mode == ControlMode::kCartesianTquat) action[6] = 1;  // no rotation
    env.Step(action);
    EXPECT_EQ(scene.handles(), 2u);
  }
}

TEST_F(EnvTaskTest, PlacingSucceedsAtAnyRootPose) {
  for (const bool mat : {false, true}) {
    for (const Pose& root : {Pose(), Pose::FromRpy({1, -1, 0.3}, {0, 0, 2})}) {
      Env env(Placing(root, mat));
      env.Reset({.seed = 4});
      EXPECT_EQ(env.instruction(), mat ? "pick up the cube and put it on the mat"
                                       : "pick up the cube and put it down at the goal");
      const EnvStep lifted = PickUp(env);
      EXPECT_FALSE(lifted.success);
      EXPECT_GT(lifted.reward, 0.4);
      const std::vector<EnvStep> steps = PutDown(env);
      EXPECT_FALSE(steps[0].success) << "held above the goal";
      EXPECT_FALSE(steps[1].success) << "held at the goal";
      EXPECT_GT(steps[1].reward, steps[0].reward);
      EXPECT_TRUE(steps[3].success);
      EXPECT_EQ(steps[3].reward, 1);
      EXPECT_LT((Object(env).translation() - Goal(env)).norm(), 0.03);
    }
  }
}

// Each goal is rejected when the environment is made, since no episode could succeed.
TEST_F(EnvTaskTest, RejectsInfeasibleGoalsWithTheReason) {
  const auto placing = [&](const Vec3& goal) {
    EnvConfig config = Placing();
    config.root_frame_objects["shelf"] = {.offset = Pose(Eigen::Vector3d(0.3, -0.3, 0.15)),
                                          .fixed = true,
                                          .shape = Shape::kBox,
                                          .size = Vec3{0.1, 0.1, 0.15},
                                          .mass = 1};
    config.task->As<PickAndPlaceTaskConfig>().goal = goal;
    config.task->As<PickAndPlaceTaskConfig>().goal_spread = {0.02, 0.02};
    return config;
  };
  struct Case {
    Vec3 goal;
    std::string why;
  };
  for (const auto& [goal, why] :
       {Case{{3, 0, 0.02}, "task.goal [3, 0, 0.02] is out of reach: it is 3.0"},
        Case{{0.4, 0.2, -0.05},
             "'cube' cannot come to rest at task.goal [0.4, 0.2, -0.05]: there "
             "it is"},
        Case{{0.3, -0.3, 0.15}, "inside 'shelf'"},
        Case{{0.4, 0.2, 0.5}, "put down there it falls by"},
        Case{{0.3, -0.3, 0.45}, "put down there it falls by"},
        Case{{0.3, 0.3, 1.8}, "out of reach"}}) {
    ExpectThrow<HookError>([&, &goal = goal] { Env env(placing(goal)); }, why);
  }
  for (const Vec3& goal : {Vec3{0.4, 0.2, 0.02}, Vec3{0.4, 0.2, 0}, Vec3{0.3, -0.3, 0.32},
                           Vec3{0.41, -0.3, 0.32}, Vec3{0.3, -0.3, 0.345}})
    EXPECT_NO_THROW(Env{placing(goal)}) << goal[0] << " " << goal[1] << " " << goal[2];
}

TEST_F(EnvTaskTest, RejectsInfeasibleGoalsOnAnObject) {
  EnvConfig config = Placing({}, true);
  config.task->As<PickAndPlaceTaskConfig>().goal = Vec3{0, 0, 0.2};
  ExpectThrow<HookError>([&] { Env env(config); }, "in the frame of 'mat'");
  config.task->As<PickAndPlaceTaskConfig>().goal.reset();
  EXPECT_NO_THROW(Env{config});
}

TEST_F(EnvTaskTest, RejectsAnObjectOutOfReach) {
  EnvConfig config = Picking();
  config.root_frame_objects["ground"].offset = Pose(Eigen::Vector3d(2, 0, 0));
  config.root_frame_objects["cube"].offset = Pose(Eigen::Vector3d(2.6, 0, 0.02));
  ExpectThrow<SpecError>([&] { Env env(config); }, "'cube' is out of reach (it is 2.");
}

TEST_F(EnvTaskTest, RejectsAPlacementWithoutALift) {
  EnvConfig config = Placing();
  Env env(config);
  env.Reset();
  const Pose goal = env.scene().root_frame_to_world() * Pose(Goal(env));
  Scene(env.scene()).SetBodyPose("cube_cube", goal);
  const EnvStep step = MoveTo(env, Pose::FromRpy({0.4, 0, 0.4}, {internal::kPi, 0, 0}), 1);
  EXPECT_LT((Object(env).translation() - Goal(env)).norm(), 0.01);
  EXPECT_FALSE(step.success);
  EXPECT_LT(step.reward, 0.5);
}

TEST_F(EnvTaskTest, GoalsAreSpreadAndFarFromTheStart) {
  for (const bool mat : {false, true}) {
    EnvConfig config = Placing(Pose::FromRpy({1, -1, 0.3}, {0, 0, 2}), mat);
    config.task->As<PickAndPlaceTaskConfig>().goal_distance = 0.2;
    Env env(config);
    double least = 1, most = -1;
    for (int i = 0; i < 30; ++i) {
      env.Reset();
      least = std::min(least, Goal(env).x());
      most = std::max(most, Goal(env).x());
      EXPECT_NEAR(Goal(env).y(), 0.25, 0.02 + 1e-9);
      EXPECT_GE((Goal(env) - Object(env).translation()).norm(), 0.2);
      if (mat) {
        EXPECT_NEAR((Goal(env) - Object(env, 1).translation()).norm(), 0.025, 1e-9);
      }
    }
    EXPECT_LT(least, 0.37);
    EXPECT_GT(most, 0.43);
  }
  EnvConfig config = Placing();
  config.task->As<PickAndPlaceTaskConfig>().goal_distance = 2;
  ExpectThrow<HookError>([&] { Env env(config); },
                         "environment 'env': in 1000 tries 'cube' was never 2 m from its goal; "
                         "widen task.spread or task.goal_spread, or lower task.goal_distance");
}

TEST_F(EnvTaskTest, ResamplesGoalsWithoutTheirSupport) {
  EnvConfig config = Placing();
  config.task->As<PickAndPlaceTaskConfig>().goal_spread = {0.02, 0.12};
  // From y = 0.30 on, a block covers possible goals.
  config.root_frame_objects["block"] = {.offset = Pose(Eigen::Vector3d(0.4, 0.4, 0.05)),
                                        .fixed = true,
                                        .shape = Shape::kBox,
                                        .size = Vec3{0.1, 0.1, 0.05},
                                        .mass = 1};
  Env env(config);
  double most = 0, least = 1;
  for (int i = 0; i < 60; ++i) {
    env.Reset();
    most = std::max(most, Goal(env).y());
    least = std::min(least, Goal(env).y());
  }
  EXPECT_LE(most, 0.3);
  EXPECT_GT(most, 0.28);
  EXPECT_LT(least, 0.2);
}

TEST_F(EnvTaskTest, ResamplesAGoalObjectInCollision) {
  EnvConfig config = Placing({}, true);
  config.task->As<PickAndPlaceTaskConfig>().goal_spread = {0.02, 0.12};
  config.root_frame_objects["block"] = {.offset = Pose(Eigen::Vector3d(0.4, 0.45, 0.05)),
                                        .fixed = true,
                                        .shape = Shape::kBox,
                                        .size = Vec3{0.1, 0.1, 0.05},
                                        .mass = 1};
  Env env(config);
  double most = 0;
  for (int i = 0; i < 60; ++i) {
    env.Reset();
    most = std::max(most, Object(env, 1).translation().y());
  }
  EXPECT_LT(most, 0.35 - 0.06 + 0.003);
  EXPECT_GT(most, 0.26);
}

TEST_F(EnvTaskTest, ASpreadGoalNeedsAMovableObject) {
  EnvConfig config = Placing({}, true);
  config.root_frame_objects["mat"].fixed = true;
  ExpectThrow<HookError>([&] { Env env(config); },
                         "task.goal_spread moves task.goal_object 'mat', which is fixed; set "
                         "fixed: false in root_frame_objects.mat, or leave goal_spread out");
  config.task->As<PickAndPlaceTaskConfig>().goal_spread = {0, 0};
  Env env(config);
  env.Reset();
  EXPECT_NEAR(Goal(env).x(), 0.4, 1e-9);
}

// A custom task: the arm has to be high up.
struct BeHighConfig {
  double rise = 0.1;

  static constexpr const char* kKind = "be_high";
  static constexpr const char* kTypeName = "BeHighConfig";
  template <class V>
  static void Fields(V&& v) {
    v("rise", &BeHighConfig::rise, "Success: so far above the start, metres.", Bound::kPositive);
  }
};

class BeHigh : public Task {
 public:
  explicit BeHigh(const BeHighConfig& fields) : fields_(fields) {}
  void Bind(const Scene& scene, const TaskSetting& setting) override {
    robot_ = Robot::Of(scene, setting.robots.front());
  }
  void Begin(const Scene& scene) override { start_ = Height(scene); }
  TaskVerdict Judge(const Scene& scene) override {
    const double risen = Height(scene) - start_;
    return {.reward = risen, .success = risen > fields_.rise};
  }
  std::string instruction() const override { return "go up"; }
  std::vector<std::string> objects() const override { return {"ground"}; }
  std::vector<Feature> signals() const override {
    return {{.column = {.name = "height", .units = "m", .frame = "world"},
             .role = FeatureRole::kPrivileged,
             .lower = {0},
             .upper = {2}},
            {.column = {.name = "big", .shape = {2}, .names = {"much", "little"}},
             .lower = {-1, -1},
             .upper = {1, 1}}};
  }
  void Observe(const Scene& scene, std::span<double> out) const override {
    out[0] = Height(scene);
    out[1] = 5;
    out[2] = -5;
  }
  std::vector<double> memory() const override { return {start_}; }
  void Recall(std::span<const double> memory) override { start_ = memory[0]; }

 private:
  double Height(const Scene& /*scene*/) const { return robot_->tcp_in_world().translation().z(); }
  BeHighConfig fields_;
  std::optional<Robot> robot_;
  double start_ = 0;
};

TEST_F(EnvTaskTest, RegistersCustomTasks) {
  const auto kind = std::make_shared<TaskKindOf<BeHighConfig, BeHigh>>();
  RegisterTask<BeHighConfig>(kind);
  ExpectThrow<ArgumentError>([&] { RegisterTask<BeHighConfig>(kind); },
                             "task 'be_high' is registered already; choose another name");
  ExpectThrow<ArgumentError>([] { RegisterTask<BeHighConfig>(nullptr); }, "needs a TaskKind");
  EXPECT_THAT(TaskKinds(), IsSupersetOf({"be_high", "pick", "pick_and_place"}));
  EnvConfig config = Picking();
  ExpectThrow<NotFoundError>([&] { config.task = TaskSpec("be_hihg"); }, "Did you mean 'be_high'?");
  config.task = BeHighConfig();
  Env env(config);
  env.Reset();
  EXPECT_EQ(env.instruction(), "go up");
  EXPECT_EQ(env.layout().objects[0].object, "ground");
  const std::span<const double> task = env.observation().last(3);
  EXPECT_GT(task[0], 0.1);
  EXPECT_EQ(task[1], 1) << "cut to its range";
  EXPECT_EQ(task[2], -1);
  EXPECT_EQ(NameOfObservation(env.layout(), env.layout().observation.size() - 1), "task.big[1]");
  const Pose up = Pose::FromRpy({0.4, 0, task[0] + 0.12}, {internal::kPi, 0, 0});
  EnvStep step = MoveTo(env, up, 1);
  EXPECT_TRUE(step.success);
  EXPECT_GT(step.reward, 0.1);
}

struct ForgetfulConfig {
  double rise = 0.05;

  static constexpr const char* kKind = "forgetful";
  static constexpr const char* kTypeName = "ForgetfulConfig";
  template <class V>
  static void Fields(V&& v) {
    v("rise", &ForgetfulConfig::rise, "How far the TCP rises, metres.");
  }
};

// Keeps where the TCP was at the start, and has no memory.
class Forgetful final : public BeHigh {
 public:
  explicit Forgetful(const ForgetfulConfig&) : BeHigh(BeHighConfig()) {}
  std::vector<double> memory() const override { return {}; }
  void Recall(std::span<const double> /*memory*/) override {}
};

TEST_F(EnvTaskTest, RestoringAStartRestartsTheTask) {
  RegisterTask<ForgetfulConfig>(std::make_shared<TaskKindOf<ForgetfulConfig, Forgetful>>());
  EnvConfig config = Picking();
  config.task = ForgetfulConfig();
  Env env(config);
  env.Reset({.seed = 1});
  const EnvState start = env.state();
  const double height = env.observation().last(3)[0];
  const Pose up = Pose::FromRpy({0.4, 0, height + 0.12}, {internal::kPi, 0, 0});
  const double reward = MoveTo(env, up, 1).reward;
  ASSERT_GT(reward, 0.1);
  Env other(config);  // whose task has never begun
  other.SetState(start);
  EXPECT_EQ(MoveTo(other, up, 1).reward, reward);
}

// Refuses three starts of five for one reason, each with other numbers, and two for another.
struct PickyConfig {
  static constexpr const char* kKind = "picky_of_test";
  static constexpr const char* kTypeName = "PickyConfig";
  template <class V>
  static void Fields(V&&) {}
};

class Picky final : public Task {
 public:
  explicit Picky(const PickyConfig&) {}
  std::optional<Refusal> Arrange(Scene&, Rng&) override {
    if (++calls_ % 5 < 2) return Refusal{.reason = "too dark"};
    return Refusal{.reason = "too high", .detail = fmt::format("by {} m", calls_)};
  }
  TaskVerdict Judge(const Scene&) override { return {}; }
  std::string instruction() const override { return "please it"; }

 private:
  int calls_ = 0;
};

TEST_F(EnvTaskTest, CountsRefusalsByReason) {
  RegisterTask<PickyConfig>(std::make_shared<TaskKindOf<PickyConfig, Picky>>());
  EnvConfig config = Picking();
  config.task = PickyConfig();
  ExpectThrow<SpecError>([&] { Env env(config); },
                         "task 'picky_of_test' found no start in 100 tries: most often the "
                         "task refused: too high (by 99 m)");
}

// Rejects the starts whose cube lies on one side.
struct OneSidedConfig {
  static constexpr const char* kKind = "one_sided_of_test";
  static constexpr const char* kTypeName = "OneSidedConfig";
  template <class V>
  static void Fields(V&&) {}
};

class OneSided final : public Task {
 public:
  explicit OneSided(const OneSidedConfig&) {}
  BodyPoses Starts(Rng& rng) override {
    return {{"cube_cube", Pose::FromRpy({0.45, rng.Uniform(-0.1, 0.1), 0.02}, {})}};
  }
  std::optional<Refusal> CheckStart(const Scene& scene) override {
    if (scene.body_pose("cube_cube").translation().y() > 0) return std::nullopt;
    return Refusal{.reason = "on the right"};
  }
  TaskVerdict Judge(const Scene&) override { return {}; }
  std::string instruction() const override { return "stay on the left"; }
};

TEST_F(EnvTaskTest, DrawsAnotherStartIfTheTaskRejectsOne) {
  RegisterTask<OneSidedConfig>(std::make_shared<TaskKindOf<OneSidedConfig, OneSided>>());
  EnvConfig config = Picking();
  config.task = OneSidedConfig();
  Env env(config);
  for (int i = 0; i < 20; ++i) {
    env.Reset();
    EXPECT_GT(env.scene().body_pose("cube_cube").translation().y(), 0);
  }
}

TEST_F(EnvTaskTest, StartsSpreadAroundTheConfiguredPlace) {
  const Pose root = Pose::FromRpy({1, -1, 0.3}, {0, 0, 2});
  Env env(Picking(root));
  double least_x = 1, most_x = 0, most_turn = 0;
  for (int i = 0; i < 40; ++i) {
    env.Reset();
    const Pose start = Object(env);  // the shared frame is the root frame here
    EXPECT_NEAR(start.translation().x(), 0.45, 0.05 + 1e-9);
    EXPECT_NEAR(start.translation().y(), 0, 0.1 + 1e-9);
    EXPECT_NEAR(start.translation().z(), 0.02, 1e-9);
    EXPECT_TRUE(env.scene().body_pose("cube_cube").is_close(root * start, 1e-9, 1e-9));
    least_x = std::min(least_x, start.translation().x());
    most_x = std::max(most_x, start.translation().x());
    most_turn = std::max(most_turn, start.angle());
  }
  EXPECT_LT(least_x, 0.42);
  EXPECT_GT(most_x, 0.48);
  EXPECT_GT(most_turn, 2);
}

int evaluations = 0;

// Counts evaluations of the engine in a scope.
struct CountingEvaluations {
  CountingEvaluations() {
    evaluations = 0;
    mjcb_control = [](const mjModel*, mjData*) { ++evaluations; };
  }
  ~CountingEvaluations() { mjcb_control = nullptr; }
  CountingEvaluations(const CountingEvaluations&) = delete;
  CountingEvaluations& operator=(const CountingEvaluations&) = delete;
};

TEST_F(EnvTaskTest, AResetEvaluatesItsStartOnce) {
  Env env(Placing(Pose(), true));
  env.Reset({.seed = 1});
  const CountingEvaluations counting;
  env.Reset({.seed = 2});
  EXPECT_EQ(evaluations, 1);
}

// The reference is the engine's result for the same state in data of its own.
TEST_F(EnvTaskTest, AResetLeavesContactsAndPosesOfTheStart) {
  Env env(Placing(Pose::FromRpy({1, -1, 0.3}, {0, 0, 2}), true));
  const mjModel* m = env.scene().model();
  const DataPtr other = MakeData(m);
  for (uint64_t seed = 0; seed < 5; ++seed) {
    env.Reset({.seed = seed});
    const mjData* d = env.scene().data();
    mj_resetData(m, other.get());
    std::copy_n(d->qpos, m->nq, other->qpos);
    std::copy_n(d->ctrl, m->nu, other->ctrl);
    std::copy_n(d->act, m->na, other->act);
    mj_forward(m, other.get());
    EXPECT_GT(d->ncon, 0);
    ASSERT_EQ(d->ncon, other->ncon);
    for (int c = 0; c < d->ncon; ++c)
      EXPECT_THAT(d->contact[c].pos, ElementsAreArray(other->contact[c].pos));
    for (const auto& [is, wanted, size] :
         {std::tuple(d->xpos, other->xpos, 3 * m->nbody), std::tuple(d->qacc, other->qacc, m->nv),
          std::tuple(d->sensordata, other->sensordata, m->nsensordata)})
      EXPECT_THAT(std::span(is, size), ElementsAreArray(wanted, size));
    EXPECT_TRUE(Object(env).is_close(
        env.scene().shared_base_frame_to_world().inverse() * env.scene().body_pose("cube_cube"),
        1e-12, 1e-12));
  }
}

TEST_F(EnvTaskTest, PickingSucceedsAtAnyRootPose) {
  for (const Pose& root : {Pose(), Pose::FromRpy({1, -1, 0.3}, {0, 0, 2})}) {
    EnvConfig config = Picking(root);
    config.sim.max_convergence_time = 2;
    Env env(config);
    env.Reset({.seed = 3});
    EXPECT_EQ(env.instruction(), "pick up the cube");
    EnvStep step = MoveTo(env, Pose::FromRpy({0.4, 0, 0.3}, {internal::kPi, 0, 0}), 1);
    EXPECT_FALSE(step.success);
    EXPECT_GT(step.reward, 0);
    EXPECT_LT(step.reward, 0.5);
    step = PickUp(env);
    EXPECT_TRUE(step.success);
    EXPECT_EQ(step.reward, 1);
  }
}

// Judges objects at poses that the test sets: nothing is simulated. The cube is held between the
// closed fingers.
class EnvPickTest : public EnvTaskTest {
 protected:
  void Make(const Pose& root, const std::string& kind) {
    EnvConfig config = kind == "pick" ? Picking(root) : Placing(root);
    if (auto* pick = config.task->If<PickTaskConfig>()) pick->lift_height = 0.01;
    if (auto* place = config.task->If<PickAndPlaceTaskConfig>()) place->lift_height = 0.01;
    config.root_frame_objects["stone"] = {.offset = Pose(Eigen::Vector3d(0.45, 0.4, 0.02)),
                                          .shape = Shape::kBox,
                                          .size = Vec3{0.02, 0.02, 0.02},
                                          .mass = 0.1};
    env_ = std::make_unique<Env>(config);
    env_->Reset({.seed = 1});
    Robot robot = Robot::Of(env_->scene(), "robot");
    auto& gripper = dynamic_cast<internal::ActuatedGripper&>(robot.gripper());
    gripper.SetJointPos(std::vector{0.018, 0.018});  // 38 mm apart, and the cube has 40
    Scene(env_->scene()).Forward();
    held_.setZero();
    for (const int finger : {0, 1}) {
      const mjtNum* at = env_->scene().data()->geom_xpos + 3 * gripper.finger(finger).geoms[0];
      held_ += 0.5 * Eigen::Vector3d(at[0], at[1], at[2]);
    }
    // High above the ground, as on a stack: the height counts from the object's start.
    Put("cube_cube", 0);
    env_->task()->Begin(env_->scene());
  }

  // Puts a body `up` above the cube's start, along the world's z.
  void Put(const std::string& body, double up, double aside = 0) {
    Scene scene = env_->scene();
    scene.SetBodyPose(body, Pose(held_ + Eigen::Vector3d(aside, 0, up)));
    scene.Forward();
  }

  bool IsPicked() {
    const bool success = env_->task()->Judge(env_->scene()).success;
    // An object has to be lifted once before it can be put down.
    return env_->config().task->kind() == "pick" ? success : env_->task()->memory().back() == 1;
  }

  std::unique_ptr<Env> env_;

 private:
  Eigen::Vector3d held_ = Eigen::Vector3d::Zero();
};

TEST_F(EnvPickTest, PickedMeansHeldByRobotsACentimetreAboveTheStart) {
  for (const char* kind : {"pick", "pick_and_place"}) {
    for (const Pose& root : {Pose(), Pose::FromRpy({1, -1, 0.3}, {0.1, 0, 2})}) {
      Make(root, kind);
      EXPECT_FALSE(IsPicked()) << "at its start";
      Put("cube_cube", 0.009);
      EXPECT_TRUE(internal::OnlyRobotsTouch(env_->scene(), "cube_cube"));
      EXPECT_FALSE(IsPicked()) << "9 mm";
      Put("cube_cube", 0.1, 1);
      EXPECT_FALSE(IsPicked()) << "nobody touches it";
      Put("cube_cube", 0.011);
      Put("stone", 0.011 + 0.0395);
      EXPECT_FALSE(IsPicked()) << "a stone lies on it";
      EXPECT_LT(env_->task()->Judge(env_->scene()).reward, 1);
      Put("stone", 0.011 + 0.2, 1);
      EXPECT_TRUE(IsPicked()) << "11 mm";
      if (std::string(kind) == "pick") {
        EXPECT_EQ(env_->task()->Judge(env_->scene()).reward, 1);
      }
    }
  }
}

TEST_F(EnvTaskTest, APlaceIsRotatedWithItsObjectInTheRootFrame) {
  EnvConfig config = Picking();
  config.root_frame_objects["cube"].offset =
      Pose::FromRpy({0.45, 0, 0.02}, {0, 0, internal::kPi / 2});
  config.task->As<PickTaskConfig>().spread = {0, 0.1};
  config.task->As<PickTaskConfig>().rotate = false;
  Env env(config);
  for (int i = 0; i < 5; ++i) {
    env.Reset();
    EXPECT_NEAR(Object(env).translation().x(), 0.45, 1e-9) << "along the root frame's y";
    EXPECT_NEAR(Object(env).rpy().z(), internal::kPi / 2, 1e-9);
  }
}

TEST_F(EnvTaskTest, RejectsAFixedObjectAsATarget) {
  EnvConfig config = Picking();
  config.root_frame_objects["cube"].fixed = true;
  ExpectThrow<HookError>([&] { Env env(config); },
                         "environment 'env': task.object 'cube' is fixed, so that no robot can "
                         "pick it; set fixed: false in root_frame_objects.cube");
}

TEST_F(EnvTaskTest, ASavedStateReproducesATaskBitwise) {
  Env env(Picking());
  env.Reset({.seed = 1});
  MoveTo(env, Pose::FromRpy({0.4, 0.1, 0.2}, {internal::kPi, 0, 0}), 0);
  env.Save("before");
  const auto go_on = [&] {
    std::vector<double> seen;
    for (int i = 0; i < 4; ++i) {
      const EnvStep step = PickUp(env);
      seen.push_back(step.time);
      seen.push_back(step.reward);
      seen.insert(seen.end(), env.observation().begin(), env.observation().end());
    }
    return seen;
  };
  const std::vector<double> then(env.observation().begin(), env.observation().end());
  const std::vector<double> first = go_on();
  env.Reset();
  env.Restore("before");
  EXPECT_EQ(std::vector<double>(env.observation().begin(), env.observation().end()), then);
  EXPECT_EQ(go_on(), first);
  EXPECT_THAT(env.saved(), ElementsAre("before"));
  ExpectThrow<NotFoundError>([&] { env.Restore("befor"); },
                             "environment 'env': no saved state 'befor'. Its saved states: before. "
                             "Did you mean 'before'?");
  env.Forget("before");
  EXPECT_THAT(env.saved(), IsEmpty());
}

TEST_F(EnvTaskTest, SavingAStateRequiresAResetAndTheSameModel) {
  Env env(Picking());
  ExpectThrow<Error>([&] { env.Save("start"); }, "call reset before the first step");
  env.Reset();
  env.Save("start");
  Scene(env.scene()).AddObject(BoxObject("box", {2, 2, 1}));
  ExpectThrow<Error>(
      [&] { env.Restore("start"); },
      "the scene was compiled again since 'start' was saved, so that there is no way "
      "back to it");
}

}  // namespace
}  // namespace robocell
