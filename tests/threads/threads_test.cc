// Everything that users may do from several threads at once, each with its own scene. `make
// check-tsan` runs it under ThreadSanitizer, which also detects races without a visible effect.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <thread>

#include "robocell/base/error.h"
#include "robocell/data/dataset.h"
#include "robocell/data/verify.h"
#include "robocell/env/stepper.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/render/renderer.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/rollout/prepare.h"
#include "robocell/rollout/runner.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/source_dir.h"

namespace robocell {
namespace {

constexpr int kThreads = 3;

// Runs work(0), work(1) ... at the same time.
void InParallel(const std::function<void(int)>& work) {
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) threads.emplace_back(work, t);
  for (std::thread& thread : threads) thread.join();
}

SceneSpec Cell(const std::string& name) {
  SceneSpec spec = SceneWith({.name = "rc7", .config = Rc7()});
  spec.name = name;
  spec.objects.push_back(BoxObject("cube", {0.4, 0, 0.02}));
  return spec;
}

// Builds, resets and drives a cell; returns its final state.
std::vector<double> Drive() {
  Scene scene = Scene::Build(Cell("cell"));
  int resets = 0;
  scene.AddResetHook([&](ResetContext&) { ++resets; });
  scene.Reset({.seed = 3});
  Stepper stepper(scene, RobotsOf(scene), {.control_ticks = 10});
  const GroupCommand turn = GroupCommand::RelativeJoints({0.1, 0, 0, 0, 0, 0, 0});
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(
        stepper.Advance({{"rc7", {{"arm", turn}, {"gripper", GroupCommand::Opening(0)}}}}).ok());
  }
  EXPECT_EQ(resets, 1);
  return scene.state();
}

TEST(Threads, BuildAndDriveSeparateScenes) {
  const std::vector<double> alone = Drive();
  InParallel([&](int) {
    for (int i = 0; i < 2; ++i) EXPECT_EQ(Drive(), alone);
  });
}

TEST(Threads, ShareAFrozenModel) {
  const auto compiled = CompileScene(Cell("shared"));
  compiled->Freeze();
  std::vector<std::vector<double>> ends(kThreads);
  InParallel([&](int t) {
    Scene scene = Scene::FromCompiled(compiled);
    scene.Reset();
    EXPECT_TRUE(scene.StepN(50).ok());
    EXPECT_NE(scene.body_pose("cube").translation().z(), 0);
    ends[t] = scene.state();
  });
  for (const auto& end : ends) EXPECT_EQ(end, ends[0]);
}

std::vector<uint8_t> Picture(Renderer& renderer, const Scene& scene) {
  std::vector<uint8_t> rgb(3 * 64 * 48);
  const OrbitCamera camera{.lookat = {0.3, 0, 0.2}, .distance = 1.5};
  renderer.SetModel(scene.model());
  renderer.Render(scene.data(), {.camera = camera, .width = 64, .height = 48}, {.rgb = rgb});
  return rgb;
}

TEST(Threads, RenderWithSeparateRenderers) {
  const Scene scene = Scene::Build(Cell("seen"));
  const std::vector<uint8_t> alone = Picture(*MakeRenderer(), scene);
  InParallel([&](int) {
    const Scene own = Scene::Build(Cell("seen"));
    const auto renderer = MakeRenderer();
    for (int i = 0; i < 2; ++i) EXPECT_EQ(Picture(*renderer, own), alone);
  });
}

TEST(Threads, OfABatchMatchASingleOne) {
  Robot robot = RobotAlone(Rc7());
  std::vector<Pose> targets;
  for (int i = 0; i < 40; ++i) {
    std::vector<double> q(7, 0.02 * i);
    q[3] = 0.8;
    targets.push_back(robot.FkFrame(q));
  }
  const IkBatchResult one = IkBatch(robot.chain(), targets);
  InParallel([&](int) {
    const IkBatchResult result = IkBatch(robot.chain(), targets, {}, {.threads = kThreads});
    EXPECT_EQ(result.q, one.q);
  });
}

TEST(Threads, GetTheirOwnEngineErrors) {
  ModelFolder folder;
  const std::string small = folder.Write("small", R"(<size memory="5000K"/>)");
  InParallel([&](int t) {
    SceneSpec spec = EmptyScene();
    spec.name = "crowd" + std::to_string(t);
    spec.options.jacobian = JacobianKind::kDense;  // with any engine the same memory
    spec.base = small;
    for (int i = 0; i < 30; ++i)
      spec.objects.push_back(
          BoxObject("box" + std::to_string(i), {0.02 * (i % 6), 0.02 * (i / 6), 0.03}));
    for (int i = 0; i < 3; ++i) {
      ExpectThrow<EngineError>([&] { Scene::Build(spec); },
                               "scene '" + spec.name + "': mj_stackAlloc: out of memory");
    }
  });
}

void GenerateEpisodes(RunConfig run) {
  const TempDir folder;
  run.output = (folder / "out").string();
  PrepareDataset(run);
  const std::vector<PlanItem> plan = MakePlan(run);
  InParallel([&](int t) { EXPECT_TRUE(Runner(run).Run(plan[t]).success); });
  EXPECT_EQ(Dataset(run.output).size(), static_cast<size_t>(kThreads));
  EXPECT_TRUE(Verify(run.output).ok());
}

TEST(Threads, GenerateEpisodesOfOneDataset) {
  RunConfig run = RunConfig::Load(SourceDir() + "/examples/demo.yaml");
  run.cameras.streams = {};
  GenerateEpisodes(run);
}

// Rows are drawn and written by a thread of each rollout.
TEST(Threads, GenerateEpisodesWithImagesOfOneDataset) {
  for (const RenderWhen render : {RenderWhen::kAlways, RenderWhen::kKept}) {
    RunConfig run = RunConfig::Load(SourceDir() + "/examples/demo.yaml");
    run.cameras.resolution = {64, 48};
    run.cameras.renderer.backend = "soft";
    run.render = render;
    GenerateEpisodes(run);
  }
}

}  // namespace
}  // namespace robocell
