#include "robocell/env/env_batch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <thread>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/env/arm_target.h"
#include "robocell/env/testing/envs.h"
#include "robocell/features/cell_features.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/joint_group.h"
#include "robocell/robot/robot.h"
#include "robocell/spec/randomize_config.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

constexpr int kCopies = 5;

EnvConfig Noisy() {
  EnvConfig config = Rc7Env();
  config.robots["robot"].home_noise["arm"] = {0.05};
  config.sim.async_control = true;
  return config;
}

std::vector<std::optional<uint64_t>> Seeds() { return {3, 4, 5, 6, 7}; }

// Returns a different action for every copy and step.
std::vector<double> Actions(const EnvBatch& batch, int step) {
  std::vector<double> actions;
  for (int i = 0; i < batch.size(); ++i) {
    for (int k = 0; k < batch.layout().action.size(); ++k)
      actions.push_back(0.05 * std::sin(i + 2 * k + 3 * step));
  }
  return actions;
}

TEST(EnvBatch, MatchesSingleEnvironmentsOnAnyNumberOfThreads) {
  std::vector<double> alone;
  for (int i = 0; i < kCopies; ++i) {
    Env env(Noisy());
    env.Reset({.seed = Seeds()[i]});
    EnvBatch shape(Noisy(), kCopies, 1);
    for (int step = 0; step < 4; ++step) {
      const std::vector<double> actions = Actions(shape, step);
      const size_t width = actions.size() / kCopies;
      env.Step(std::span(actions).subspan(i * width, width));
    }
    alone.insert(alone.end(), env.observation().begin(), env.observation().end());
  }
  for (const int threads : {1, 2, 7}) {
    EnvBatch batch(Noisy(), kCopies, threads);
    batch.Reset(Seeds());
    for (int step = 0; step < 4; ++step) batch.Step(Actions(batch, step));
    const std::vector<double> seen(batch.observations().begin(), batch.observations().end());
    EXPECT_EQ(seen, alone) << threads;
  }
}

TEST(EnvBatch, EpisodesAreTruncatedAndReset) {
  EnvBatch batch(Noisy(), kCopies, 2, 3);
  batch.Reset(Seeds());
  for (int step = 0; step < 3; ++step) {
    const BatchStep& out = batch.Step(Actions(batch, step));
    EXPECT_EQ(out.truncated, std::vector<uint8_t>(kCopies, step == 2));
    EXPECT_EQ(out.terminated, std::vector<uint8_t>(kCopies, 0));
  }
  const std::vector<bool> some = {true, false, true, false, false};
  const BatchStep& out = batch.Step(Actions(batch, 0), some);
  EXPECT_EQ(out.truncated, (std::vector<uint8_t>{0, 1, 0, 1, 1}));
  EXPECT_EQ(batch.env(0).scene().time(), 0);
  EXPECT_GT(batch.env(1).scene().time(), 0);
  batch.Reset({}, {false, true, false, false, false});
  EXPECT_EQ(batch.env(1).scene().time(), 0);
}

TEST(EnvBatch, AnInvalidActionMovesNoCopy) {
  EnvBatch batch(Noisy(), kCopies, 2);
  batch.Reset(Seeds());
  std::vector<double> actions = Actions(batch, 0);
  actions[3 * batch.layout().action.size() + 2] = NAN;
  ExpectThrow<ArgumentError>([&] { batch.Step(actions); },
                             "environment 'env[3]' / robot 'robot': number 2 of its joints is nan");
  EXPECT_EQ(batch.env(0).scene().time(), 0);
  ExpectThrow<ArgumentError>([&] { batch.Step(std::vector<double>(3)); },
                             "step of 5 copies: expected 8 numbers for each, got 3 in all");
  ExpectThrow<ArgumentError>([&] { batch.Reset(std::vector<std::optional<uint64_t>>(2)); },
                             "reset of 5 copies: seeds for 2 were given");
}

TEST(EnvBatch, UnseededCopiesHaveDistinctReproducibleStarts) {
  const auto starts = [] {
    EnvBatch batch(Noisy(), kCopies, 2);
    batch.Reset({});
    return std::vector<double>(batch.observations().begin(), batch.observations().end());
  };
  const std::vector<double> seen = starts();
  EXPECT_EQ(starts(), seen);
  const size_t width = seen.size() / kCopies;
  for (size_t a = 0; a < kCopies; ++a) {
    for (size_t b = 0; b < a; ++b)
      EXPECT_FALSE(std::equal(&seen[a * width], &seen[a * width] + width, &seen[b * width]));
  }
}

TEST(EnvBatch, LimitsThreadsToCopiesAndRejectsInvalidCounts) {
  EnvBatch many(Noisy(), 2, 1 << 20);
  many.Reset({});
  ExpectThrow<ArgumentError>([] { EnvBatch(Noisy(), 2, -1); },
                             "threads is -1; 0 for one for each core, or more");
  ExpectThrow<ArgumentError>(
      [] { EnvBatch(Noisy(), 2, 1, 0); },
      "batch of environment 'env': max_episode_steps is 0; at least 1, or leave it out");
}

TEST(EnvBatch, CloseClosesAllCopies) {
  EnvBatch batch(Noisy(), 2);
  batch.Reset({});
  batch.Close();
  batch.Close();
  EXPECT_TRUE(batch.env(1).scene().closed());
  ExpectThrow<ClosedError>([&] { batch.Reset({}); }, "batch of environment 'env' is closed");
  ExpectThrow<ClosedError>([&] { batch.Step(Actions(batch, 0)); }, "is closed");
}

TEST(EnvBatch, RequiresAtLeastOneCopy) {
  ExpectThrow<ArgumentError>([] { EnvBatch(Noisy(), 0); },
                             "batch of environment 'env': 0 copies; at least 1");
}

// The oracle is single environments with the same seeds, each compiled by itself.
TEST(EnvBatch, ObjectsVaryIndependentlyInEachCopy) {
  EnvConfig config = Rc7WithCube();
  config.variations["cube"] = {.mass = {0.5, 2}, .friction = {0.5, 1.5}};
  EnvBatch batch(config, 3, 2);
  const std::vector<std::optional<uint64_t>> seeds = {3, 4, 3};
  batch.Reset(seeds);
  const auto cube_mass = [](const Env& env) {
    const mjModel* m = env.scene().model();
    return m->body_mass[RequireId(m, mjOBJ_BODY, "cube", "test")];
  };
  for (int i = 0; i < 3; ++i) {
    Env alone(config);
    alone.Reset({.seed = seeds[i]});
    EXPECT_EQ(SaveBinaryString(batch.env(i).scene().model()),
              SaveBinaryString(alone.scene().model()));
    EXPECT_EQ(batch.env(i).scene().ToXml(), alone.scene().ToXml());
  }
  EXPECT_EQ(cube_mass(batch.env(0)), cube_mass(batch.env(2)));
  EXPECT_NE(cube_mass(batch.env(0)), cube_mass(batch.env(1)));
}

// The oracle is single environments with the same seeds, each with a renderer of its own.
TEST(EnvBatch, ImagesMatchSingleEnvironmentsWithVaryingObjects) {
  for (const bool varied : {false, true}) {
    EnvConfig config = Rc7WithCube();
    if (varied) config.variations["cube"] = {.colour = 0.3};
    config.cameras.resolution = {32, 24};
    config.cameras.streams.push_back({.name = "eye", .camera = "exo_camera", .depth = true});
    EnvBatch batch(config, 2, 2);
    batch.Reset(std::vector<std::optional<uint64_t>>{1, 2});
    std::vector<double> action(8);
    internal::PutTquat(Pose::FromRpy({0.4, 0, 0.3}, {internal::kPi, 0, 0}), action);
    std::vector<double> actions = action;
    actions.insert(actions.end(), action.begin(), action.end());
    batch.Step(actions);
    for (int i = 0; i < 2; ++i) {
      Env single(config);
      single.Reset({.seed = i + 1});
      single.Step(action);
      const CellImage &seen = batch.env(i).frames()[0], &alone = single.frames()[0];
      EXPECT_EQ(seen.rgb, alone.rgb) << varied << i;
      EXPECT_EQ(seen.depth_mm, alone.depth_mm);
      EXPECT_EQ(seen.time, alone.time);
    }
    EXPECT_NE(batch.env(0).frames()[0].rgb, batch.env(1).frames()[0].rgb);
  }
}

// The oracle is single environments with the same seeds, each with a renderer of its own.
TEST(EnvBatch, PicturesOfCopiesShowTheirOwnTextures) {
  EnvConfig config = Rc7WithCube();
  config.randomize = FromYamlUnchecked<RandomizeConfig>(
      "lights: {number: {choice: [1, 2]}}\n"
      "appearance: {ground: {texture: [checker, marble, dots]}, cube: {specular: {uniform: [0, "
      "1]}, colour: {uniform: [0, 1]}}}\n");
  config.cameras.renderer.backend = "soft";
  config.cameras.resolution = {32, 24};
  config.cameras.streams.push_back({.name = "eye", .camera = "exo_camera"});
  EnvBatch batch(config, 2, 1);
  for (const uint64_t round : {0, 2, 4}) {
    batch.Reset(std::vector<std::optional<uint64_t>>{round + 1, round + 2});
    for (int i = 0; i < 2; ++i) {
      Env single(config);
      single.Reset({.seed = round + static_cast<uint64_t>(i) + 1});
      EXPECT_EQ(batch.env(i).frames()[0].rgb, single.frames()[0].rgb) << round << " " << i;
    }
    EXPECT_NE(batch.env(0).frames()[0].rgb, batch.env(1).frames()[0].rgb);
  }
}

TEST(EnvBatch, AnExceptionOfThePollEndsTheStepsOfAllThreads) {
  struct Enough {};
  for (const int threads : {1, 2}) {
    EnvConfig config = Noisy();
    config.sim.frequency = 1e-3;  // the test does not wait for it
    EnvBatch batch(config, kCopies, threads);
    batch.Reset(Seeds());
    const std::vector<double> zeros(static_cast<size_t>(kCopies) *
                                    static_cast<size_t>(batch.layout().action.size()));
    const std::thread::id caller = std::this_thread::get_id();
    int calls = 0;
    const auto poll = [&] {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      if (++calls == 20) throw Enough();
    };
    EXPECT_THROW(batch.Step(zeros, {}, poll), Enough);
    EXPECT_EQ(calls, 20);
    for (int i = 0; i < kCopies; ++i) EXPECT_LT(batch.env(i).scene().time(), 1e3);
    ExpectThrow<Error>([&] { batch.Step(zeros, {}, poll); }, "call reset to go on");
    batch.Reset(Seeds());
    calls = 0;
    EXPECT_THROW(batch.Step(zeros, {}, poll), Enough) << "and again";
  }
}

std::vector<double> Zeros(const EnvBatch& batch) {
  return std::vector<double>(static_cast<size_t>(batch.size()) *
                             static_cast<size_t>(batch.layout().action.size()));
}

TEST(EnvBatch, AnInterruptedStepRequiresAResetOfAllCopies) {
  struct Enough {};
  EnvConfig config = Noisy();
  config.sim.frequency = 125;  // four steps of the engine
  const std::vector<std::optional<uint64_t>> seeds = {3, 4, 5};
  for (const int threads : {1, 2}) {
    EnvBatch batch(config, 3, threads);
    const std::vector<double> zeros = Zeros(batch);
    int calls = 0, last = 0;
    const auto poll = [&] {
      if (++calls == last) throw Enough();
    };
    batch.Reset(seeds);
    batch.Step(zeros, {}, poll);
    EXPECT_TRUE(threads == 2 || calls == 3 * 5) << "before each copy, and after each engine step";
    const std::vector<double> whole(batch.observations().begin(), batch.observations().end());
    for (last = 1; last <= 3 * 5; ++last) {
      batch.Reset(seeds);
      calls = 0;
      bool ended = false;
      try {
        batch.Step(zeros, {}, poll);
      } catch (const Enough&) {
        ended = true;
      }
      EXPECT_EQ(ended, threads == 1 || calls >= last) << last;
      if (!ended) continue;  // the other thread did that much of the work
      ExpectThrow<Error>([&] { batch.Step(zeros); },
                         "'env[0]': an error ended its last reset or step halfway; call reset");
      batch.Reset({}, {true, true, false});
      ExpectThrow<Error>([&] { batch.Step(zeros); }, "'env[2]': an error ended its last reset");
    }
    batch.Reset(seeds);
    batch.Step(zeros);
    const std::vector<double> again(batch.observations().begin(), batch.observations().end());
    EXPECT_EQ(again, whole);
  }
}

TEST(EnvBatch, AnErrorOfOneCopyRequiresAResetOfAll) {
  for (const int threads : {1, 2}) {
    EnvBatch batch(Noisy(), 3, threads);
    batch.Reset({});
    // Adds a controller that the environment cannot use, without its knowledge.
    Robot robot = Robot::Of(batch.env(1).scene(), "robot");
    robot.SetController("arm", "cartesian_pose");
    robot.SetController("arm", "differential_ik");
    ExpectThrow<ArgumentError>([&] { batch.Step(Zeros(batch)); }, "takes a twist");
    robot.SetController("arm", "joint_position");
    batch.Reset({}, {false, true, false});
    ExpectThrow<Error>([&] { batch.Step(Zeros(batch)); },
                       "'env[0]': an error ended its last reset or step halfway; call reset");
    batch.Reset({});
    batch.Step(Zeros(batch));
  }
}

constexpr const char* kArmAction = "robots/robot/action/arm";
constexpr const char* kGripperAction = "robots/robot/action/gripper";

// Returns joint targets for copy `i`, other ones in each step.
std::vector<double> ArmTarget(const Env& env, int i, int step) {
  const auto home = Robot::Of(env.scene(), "robot").controller("arm").commanded_joint_pos();
  std::vector<double> target(home.begin(), home.end());
  for (size_t k = 0; k < target.size(); ++k)
    target[k] += 0.03 * std::sin(i + 2.0 * static_cast<double>(k) + 3 * step);
  return target;
}

// Returns the commands of copy `i`; those of odd steps leave out the gripper, which keeps its
// target.
EnvBatch::RowsByName CommandsOf(const Env& env, int i, int step) {
  EnvBatch::RowsByName commands = {{kArmAction, ArmTarget(env, i, step)}};
  if (step % 2 == 0) commands[kGripperAction] = {0.2 * i};
  return commands;
}

// Appends the rows of one copy to those of the previous ones.
void Append(const EnvBatch::RowsByName& own, EnvBatch::RowsByName& all) {
  for (const auto& [name, numbers] : own)
    all[name].insert(all[name].end(), numbers.begin(), numbers.end());
}

EnvBatch::RowsByName RowOf(Env& env) {
  EnvBatch::RowsByName row;
  std::span<const double> rest = env.features().ReadState();
  for (const Feature& feature : env.features().observed().features()) {
    const auto own = rest.first(static_cast<size_t>(feature.size()));
    row[feature.column.name].assign(own.begin(), own.end());
    rest = rest.subspan(own.size());
  }
  return row;
}

// The oracle is single environments with the same seeds and commands.
TEST(EnvBatch, CommandsAndRowsByNameAreThoseOfSingleEnvironmentsToTheBit) {
  for (const int threads : {1, 2}) {
    EnvBatch batch(Noisy(), 3, threads);
    batch.Reset(std::vector<std::optional<uint64_t>>{3, 4, 5});
    std::vector<std::unique_ptr<Env>> singles;
    for (const int seed : {3, 4, 5}) {
      singles.push_back(std::make_unique<Env>(Noisy()));
      singles.back()->Reset({.seed = seed});
    }
    for (int step = 0; step < 4; ++step) {
      EnvBatch::RowsByName commands, rows;
      std::vector<double> seen, times;
      for (int i = 0; i < 3; ++i) {
        Env& env = *singles[i];
        const EnvBatch::RowsByName own = CommandsOf(env, i, step);
        times.push_back(env.Act(own).time);
        Append(own, commands);
        Append(RowOf(env), rows);
        seen.insert(seen.end(), env.observation().begin(), env.observation().end());
      }
      const BatchStep& out = batch.Act(commands);
      for (int i = 0; i < 3; ++i) EXPECT_EQ(out.steps[i].time, times[i]);
      EXPECT_EQ(std::vector<double>(batch.observations().begin(), batch.observations().end()),
                seen);
      EXPECT_EQ(batch.Row(), rows) << threads << " " << step;
    }
  }
}

TEST(EnvBatch, CommandsByNameLeaveOutCopiesThatResetInstead) {
  EnvBatch batch(Noisy(), 2, 2);
  batch.Reset(std::vector<std::optional<uint64_t>>{3, 4});
  std::vector<double> targets = ArmTarget(batch.env(0), 0, 0);
  targets.resize(2 * targets.size(), NAN);
  batch.Act({{kArmAction, targets}}, {false, true});
  EXPECT_GT(batch.env(0).scene().time(), 0);
  EXPECT_EQ(batch.env(1).scene().time(), 0);
}

TEST(EnvBatch, InvalidCommandsByNameMoveNoCopy) {
  EnvBatch batch(Noisy(), 3, 2);
  std::vector<double> q = ArmTarget(batch.env(0), 0, 0);
  const size_t n = q.size();
  q.resize(3 * n, 0.1);
  ExpectThrow<Error>([&] { batch.Act({{kArmAction, q}}); }, "call reset before the first step");
  batch.Reset({});
  ExpectThrow<NotFoundError>(
      [&] {
        batch.Act({{"robots/robot/action/amr", q}});
      },
      "Did you mean 'robots/robot/action/arm'?");
  ExpectThrow<NotFoundError>(
      [&] {
        batch.Act({{"robots/robot/arm/qpos", q}});
      },
      "no feature 'robots/robot/arm/qpos'");
  ExpectThrow<ArgumentError>(
      [&] {
        batch.Act({{kArmAction, std::vector<double>(n)}});
      },
      "step of 3 copies: expected 7 numbers of 'robots/robot/action/arm' for each, got 7 in all");
  ExpectThrow<ArgumentError>(
      [&] {
        batch.Act({{kArmAction, q}, {"robots/robot/action/arm_relative", q}});
      },
      "both move group 'arm'");
  std::vector<double> bad = q;
  bad[2 * n + 1] = NAN;
  ExpectThrow<ArgumentError>(
      [&] {
        batch.Act({{kArmAction, bad}});
      },
      "environment 'env[2]': action 'robots/robot/action/arm' is not finite");
  for (int i = 0; i < 3; ++i) EXPECT_EQ(batch.env(i).scene().time(), 0) << i;
  batch.Act({});
  EXPECT_GT(batch.env(2).scene().time(), 0) << "all keep their targets";
}

TEST(EnvBatch, RejectsChoicesOfCopiesInAnotherNumber) {
  EnvBatch batch(Noisy(), 3, 1);
  batch.Reset({});
  ExpectThrow<ArgumentError>([&] { batch.Step(Zeros(batch), {true}); },
                             "step of 3 copies: choices for 1 were given");
  ExpectThrow<ArgumentError>([&] { batch.Act({}, {true}); },
                             "step of 3 copies: choices for 1 were given");
}

// A group of one joint beside the arm and the gripper.
class Shoulder : public JointGroup {
 public:
  explicit Shoulder(const Scene& scene)
      : JointGroup(scene,
                   {.robot = "robot",
                    .group = "shoulder",
                    .joints = {"robotrobot_joint1"},
                    .root = {false, "robotrobot_link1"},
                    .leaf = {false, "robotrobot_link1"},
                    .robot_base = {false, "robotrobot_base_link"}},
                   MoveGroupKind::kGeneric) {}
};

TEST(EnvBatch, RowsRequireTheSameFeaturesOfAllCopies) {
  EnvBatch batch(Noisy(), 2, 1);
  batch.Reset({});
  batch.Row();
  Robot robot = Robot::Of(batch.env(1).scene(), "robot");
  robot.SetGroup(std::make_shared<Shoulder>(batch.env(1).scene()));
  batch.Reset({});
  ExpectThrow<Error>([&] { batch.Row(); },
                     "batch of environment 'env': the features of copy 1 are not those of copy 0: "
                     "feature 'robots/robot/shoulder/qpos' is in copy 1 and not in copy 0");
  batch.Close();
  ExpectThrow<ClosedError>([&] { batch.Row(); }, "is closed");
  ExpectThrow<ClosedError>([&] { batch.Act({}); }, "is closed");
}

// The oracle is a separate renderer for each single environment.
TEST(EnvBatch, DrawsAPictureOfEachCopy) {
  EnvConfig config = Rc7WithCube();
  config.variations["cube"] = {.colour = 0.3};
  EnvBatch batch(config, 2, 2);
  batch.Reset(std::vector<std::optional<uint64_t>>{1, 2});
  const OrbitCamera view{.lookat = {0.4, 0, 0.1}, .distance = 1, .azimuth = 120, .elevation = -30};
  const std::vector<uint8_t> pictures = batch.Draw(view, 32, 24);
  const size_t one = 32 * 24 * 3;
  ASSERT_EQ(pictures.size(), 2 * one);
  for (int i = 0; i < 2; ++i) {
    Env single(config);
    single.Reset({.seed = i + 1});
    const std::unique_ptr<Renderer> renderer = MakeRenderer();
    renderer->SetModel(single.scene().model());
    std::vector<uint8_t> alone(one);
    renderer->Render(single.scene().data(), {.camera = view, .width = 32, .height = 24},
                     {.rgb = alone});
    EXPECT_TRUE(std::equal(alone.begin(), alone.end(), pictures.begin() + i * one)) << i;
  }
  EXPECT_FALSE(std::equal(pictures.begin(), pictures.begin() + one, pictures.begin() + one));
  ExpectThrow<ArgumentError>([&] { batch.Draw(view, 0, 24); }, "an image of 0 x 24 pixels");
  batch.Close();
  ExpectThrow<ClosedError>([&] { batch.Draw(view, 32, 24); }, "is closed");
}

}  // namespace
}  // namespace robocell
