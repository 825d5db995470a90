// Reset to a randomised state of the same scene, beside one mj_forward on it. Row P9 of RESULTS.md.
//
// A reset puts qpos, ctrl and targets back to home with noise on the arm and computes all poses;
// its lower bound is one mj_forward, which it contains.
//
//   build/release/reset_bench [ROBOT.yaml ...]   default: the built-in rc7
#include <mujoco/mujoco.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench.h"

namespace robocell {
namespace {

constexpr int kTimes = 200;  // per iteration

// Uses the same noise for every robot.
RobotConfig WithNoise(const std::string& file) {
  RobotConfig config = RobotConfig::Load(file);
  config.home_noise = {};
  config.home_noise["arm"] = {0.03};  // rad
  return config;
}

struct Resetting {
  explicit Resetting(const std::string& file)
      : scene(bench::SceneWith(WithNoise(file))),
        robot(Robot::Of(scene, "robot")),
        before(scene.state()) {}
  void Reset() { scene.Reset({.seed = ++seed}); }
  void Forward() { mj_forward(scene.model(), scene.data()); }
  // A randomised reset changes the state.
  std::string Problem() {
    std::vector<double> now = scene.state();
    std::swap(now, before);
    return now != before ? "" : "the reset changed nothing";
  }

  Scene scene;
  Robot robot;  // takes part in every reset
  std::vector<double> before;
  uint64_t seed = 0;
};

void Register(const std::string& file) {
  const auto it = std::make_shared<Resetting>(file);
  const std::string robot = RobotConfig::Load(file).name;
  bench::Add({.row = robot,
              .side = "reset",
              .count = kTimes,
              .run =
                  [=] {
                    for (int i = 0; i < kTimes; ++i) it->Reset();
                  },
              .problem = [=] { return it->Problem(); }});
  bench::Add({.row = robot, .side = "mj_forward", .count = kTimes, .run = [=] {
                for (int i = 0; i < kTimes; ++i) it->Forward();
              }});
}

}  // namespace
}  // namespace robocell

int main(int argc, char** argv) {
  return robocell::bench::Main(argc, argv, robocell::Register,
                               robocell::assets::BuiltinRobotFile("rc7"));
}
