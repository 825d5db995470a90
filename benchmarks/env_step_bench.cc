// A step of an environment, 33 steps of the engine, beside the bare engine with the same controls.
// Row P8 of RESULTS.md; env_step.py runs it, and the step from Python beside it.
//
//   build/release/env_step_bench [ROBOT.yaml ...]   default: the built-in rc7
#include <mujoco/mujoco.h>

#include <memory>
#include <string>
#include <vector>

#include "bench.h"

namespace robocell {
namespace {

constexpr int kSteps = 30;     // of the environment, per iteration
constexpr int kSubsteps = 33;  // of the engine, in each

// The same configuration as in env_side.py.
EnvConfig ConfigOf(const std::string& file) {
  EnvConfig config;
  config.robots["robot"] = RobotConfig::Load(file);
  config.add_floor = true;
  config.sim.async_control = true;
  config.sim.frequency = 1 / (kSubsteps * config.sim.timestep);
  return config;
}

// Swings far enough that every joint moves all the time.
struct Stepping {
  explicit Stepping(const std::string& file)
      : env(ConfigOf(file)), action(env.layout().action.size(), 0.0) {}
  void Reset() {
    env.Reset({.seed = 1});
    qpos.assign(env.scene().data()->qpos, env.scene().data()->qpos + env.scene().model()->nq);
  }
  void Run() {
    for (int i = 0; i < kSteps; ++i) {
      for (double& number : action) number = i % 2 == 0 ? 0.03 : -0.03;
      env.Step(action);
      mju_copy(&ctrl[i * nu], env.scene().data()->ctrl, nu);
    }
  }
  // Replays the same motion with the bare engine.
  void Replay() {
    mjData* data = env.scene().data();
    for (int i = 0; i < kSteps; ++i) {
      mju_copy(data->ctrl, &ctrl[i * nu], nu);
      for (int k = 0; k < kSubsteps; ++k) mj_step(env.scene().model(), data);
    }
  }

  Env env;
  std::vector<double> action, qpos;
  int nu = env.scene().model()->nu;
  std::vector<double> ctrl = std::vector<double>(kSteps * nu);  // of each step
};

void Register(const std::string& file) {
  const auto it = std::make_shared<Stepping>(file);
  const std::string robot = RobotConfig::Load(file).name;
  bench::Add({.row = robot,
              .side = "env",
              .count = kSteps,
              .prepare = [=] { it->Reset(); },
              .run = [=] { it->Run(); },
              .problem = [=]() -> std::string {
                const double* now = it->env.scene().data()->qpos;
                for (size_t i = 0; i < 7; ++i) {
                  if (now[i] == it->qpos[i]) return "a joint stood still";
                }
                return "";
              }});
  bench::Add({.row = robot,
              .side = "mj_step",
              .count = kSteps,
              .prepare =
                  [=] {
                    it->Reset();
                    it->Run();
                    it->Reset();
                  },
              .run = [=] { it->Replay(); }});
}

}  // namespace
}  // namespace robocell

int main(int argc, char** argv) {
  return robocell::bench::Main(argc, argv, robocell::Register,
                               robocell::assets::BuiltinRobotFile("rc7"));
}
