// The cost of the control loop: Robot::Update() with joint position control and one engine step,
// beside the bare engine stepping with the very controls that loop produced. Row P7 of RESULTS.md.
//
// Each iteration is one simulated second from the same start, the arm swinging around its home.
// The replay must end at the same bits, or the row is an error.
//
//   build/release/control_loop_bench [ROBOT.yaml ...]   default: the built-in rc7
#include <benchmark/benchmark.h>
#include <robocell/robocell.h>
#include <mujoco/mujoco.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace robocell {
namespace {

constexpr double kAmplitude = 0.2;  // rad around home
constexpr double kSeconds = 1;

class Swing {
 public:
  explicit Swing(const std::string& file) : scene_(Build(file)) {
    scene_.Reset();
    robot_.emplace(Robot::Of(scene_, "robot"));
    home_.assign(robot_->jnt_pos_cmd().begin(), robot_->jnt_pos_cmd().end());
    ticks_ = static_cast<int>(std::lround(kSeconds / scene_.timestep()));
    start_ = scene_.state();
    Record();
  }

  // One second of the loop that a control program has.
  void Loop() {
    for (int tick = 0; tick < ticks_; ++tick) {
      Command(tick);
      robot_->Update();
      (void)robot_->Step();  // where it ends is checked
    }
  }
  // The same second by the engine alone.
  void Replay() {
    const mjModel* m = scene_.model();
    for (int tick = 0; tick < ticks_; ++tick) {
      mju_copy(scene_.data()->ctrl, controls_.data() + tick * m->nu, m->nu);
      mj_step(m, scene_.data());
    }
  }
  void Rewind() { scene_.SetState(start_); }
  bool EndsWhereRecorded() const { return scene_.state() == end_; }
  int ticks() const { return ticks_; }

 private:
  static Scene Build(const std::string& file) {
    SceneSpec spec{.name = "swing", .timestep = 0.002, .add_floor = true, .add_skybox = false};
    spec.robots.push_back({.name = "robot", .config = RobotConfig::Load(file)});
    return Scene::Build(spec);
  }
  void Command(int tick) {
    const double offset = kAmplitude * std::sin(2 * M_PI * tick / ticks_);
    for (size_t j = 0; j < home_.size(); ++j) robot_->jnt_pos_cmd()[j] = home_[j] + offset;
  }
  void Record() {
    const mjModel* m = scene_.model();
    for (int tick = 0; tick < ticks_; ++tick) {
      Command(tick);
      robot_->Update();
      controls_.insert(controls_.end(), scene_.data()->ctrl, scene_.data()->ctrl + m->nu);
      (void)robot_->Step();
    }
    end_ = scene_.state();
    Rewind();
  }

  Scene scene_;
  std::optional<Robot> robot_;
  std::vector<double> home_, start_, end_, controls_;
  int ticks_ = 0;
};

// Runs `second` once per iteration; only it is timed. The counter `tick` is the time per tick.
template <typename Second>
void Time(benchmark::State& state, Swing& swing, Second second) {
  double total = 0;
  for (auto _ : state) {
    swing.Rewind();
    const auto begin = std::chrono::steady_clock::now();
    second(swing);
    const double s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    state.SetIterationTime(s);
    total += s;
    if (!swing.EndsWhereRecorded()) return state.SkipWithError("ends elsewhere than recorded");
  }
  state.counters["tick_s"] = total / static_cast<double>(state.iterations()) / swing.ticks();
}

void Register(const std::string& file) {
  const auto swing = std::make_shared<Swing>(file);
  const std::string robot = RobotConfig::Load(file).name;
  const auto add = [&](const std::string& what, auto second) {
    benchmark::RegisterBenchmark(
        (robot + "/" + what).c_str(),
        [swing, second](benchmark::State& state) { Time(state, *swing, second); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  };
  add("update+step", [](Swing& s) { s.Loop(); });
  add("mj_step", [](Swing& s) { s.Replay(); });
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
