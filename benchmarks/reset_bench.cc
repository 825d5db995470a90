// Reset to a randomised state of the same scene, beside one mj_forward on it. Row P9 of RESULTS.md.
//
// A reset puts qpos, ctrl and targets back to home with the configuration's noise and computes all
// poses; how far it can get is one mj_forward, which it contains.
//
//   build/release/reset_bench [ROBOT.yaml ...]   default: the built-in rc7
#include <benchmark/benchmark.h>
#include <robocell/robocell.h>
#include <mujoco/mujoco.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace robocell {
namespace {

constexpr int kResets = 200;  // per iteration

struct Bench {
  explicit Bench(const std::string& file)
      : scene(Build(file)), robot(Robot::Of(scene, "robot")), before(scene.state()) {}
  static Scene Build(const std::string& file) {
    SceneSpec spec{.name = "reset", .timestep = 0.002, .add_floor = true, .add_skybox = false};
    spec.robots.push_back({.name = "robot", .config = RobotConfig::Load(file)});
    return Scene::Build(spec);
  }
  // Whether the last reset changed the state, as a randomised one must.
  bool Moved() {
    std::vector<double> now = scene.state();
    std::swap(now, before);
    return now != before;
  }

  Scene scene;
  Robot robot;  // takes part in every reset
  std::vector<double> before;
  uint64_t seed = 0;
};

template <typename Function>
void Time(benchmark::State& state, Bench& bench, bool moves, Function function) {
  double total = 0;
  for (auto _ : state) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < kResets; ++i) function(bench);
    const double s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    state.SetIterationTime(s);
    total += s;
    if (moves && !bench.Moved()) return state.SkipWithError("the reset changed nothing");
  }
  state.counters["reset_s"] = total / static_cast<double>(state.iterations()) / kResets;
}

void Register(const std::string& file) {
  const auto bench = std::make_shared<Bench>(file);
  const std::string robot = RobotConfig::Load(file).name;
  const auto add = [&](const std::string& what, bool moves, auto function) {
    benchmark::RegisterBenchmark((robot + "/" + what).c_str(),
                                 [=](benchmark::State& s) { Time(s, *bench, moves, function); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  };
  add("reset", true, [](Bench& b) { b.scene.Reset({.seed = ++b.seed}); });
  add("mj_forward", false, [](Bench& b) { mj_forward(b.scene.model(), b.scene.data()); });
}

}  // namespace
}  // namespace robocell

int main(int argc, char** argv) try {
  benchmark::Initialize(&argc, argv);
  std::vector<std::string> files(argv + 1, argv + argc);
  if (files.empty()) files.push_back(robocell::assets::BuiltinRobotFile("rc7"));
  for (const std::string& file : files) robocell::Register(file);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
} catch (const robocell::Error& e) {
  std::fprintf(stderr, "error: %s\n", e.what());
  return 2;
}
