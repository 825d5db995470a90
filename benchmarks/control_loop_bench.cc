// The cost of the control loop: Robot::Update() with joint position control and one engine step,
// beside the bare engine stepping with the very controls that loop produced. Row P7 of RESULTS.md.
//
// Each iteration is one simulated second from the same start, the arm swinging around its home.
// The replay must end at the same bits, or the row is an error.
//
//   build/release/control_loop_bench [ROBOT.yaml ...]   default: the built-in rc7
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "bench.h"

namespace robocell {
namespace {

constexpr double kAmplitude = 0.2;  // rad around home
constexpr double kSeconds = 1;

class Swing {
 public:
  explicit Swing(const std::string& file)
      : scene_(bench::SceneWith(RobotConfig::Load(file))), robot_(Robot::Of(scene_, "robot")) {
    scene_.Reset();
    ticks_ = static_cast<int>(std::lround(kSeconds / scene_.timestep()));
    start_ = scene_.state();
    MakeTargets();
    Record();
  }

  // One second of the loop that a control program has.
  void Loop() {
    for (int tick = 0; tick < ticks_; ++tick) {
      Command(tick);
      robot_.Update();
      (void)robot_.Step();  // where it ends is checked
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
  std::string Problem() const {
    return scene_.state() == end_ ? "" : "ends elsewhere than recorded";
  }
  int ticks() const { return ticks_; }

 private:
  // What a program commands; where it has that from is not part of the loop.
  void Command(int tick) {
    std::copy_n(targets_.data() + static_cast<size_t>(tick) * joints_, joints_,
                robot_.jnt_pos_cmd().begin());
  }
  void MakeTargets() {
    const std::vector<double> home(robot_.jnt_pos_cmd().begin(), robot_.jnt_pos_cmd().end());
    joints_ = home.size();
    for (int tick = 0; tick < ticks_; ++tick) {
      const double offset = kAmplitude * std::sin(2 * M_PI * tick / ticks_);
      for (const double q : home) targets_.push_back(q + offset);
    }
  }
  void Record() {
    const mjModel* m = scene_.model();
    for (int tick = 0; tick < ticks_; ++tick) {
      Command(tick);
      robot_.Update();
      controls_.insert(controls_.end(), scene_.data()->ctrl, scene_.data()->ctrl + m->nu);
      (void)robot_.Step();
    }
    end_ = scene_.state();
    Rewind();
  }

  Scene scene_;
  Robot robot_;
  std::vector<double> targets_, start_, end_, controls_;
  size_t joints_ = 0;
  int ticks_ = 0;
};

void Register(const std::string& file) {
  const auto swing = std::make_shared<Swing>(file);
  const auto add = [&](const std::string& side, auto second) {
    bench::Add({.row = RobotConfig::Load(file).name,
                .side = side,
                .count = static_cast<double>(swing->ticks()),
                .prepare = [=] { swing->Rewind(); },
                .run = [=] { second(*swing); },
                .problem = [=] { return swing->Problem(); }});
  };
  add("update+step", [](Swing& s) { s.Loop(); });
  add("mj_step", [](Swing& s) { s.Replay(); });
}

}  // namespace
}  // namespace robocell

int main(int argc, char** argv) {
  return robocell::bench::Main(argc, argv, robocell::Register,
                               robocell::assets::BuiltinRobotFile("rc7"));
}
