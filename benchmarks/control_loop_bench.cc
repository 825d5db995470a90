// The cost of the control loop: the work of a control program in a tick (a command,
// Robot::Update()) and one engine step, beside the bare engine stepping with the controls that this
// loop produced. Row P7 of RESULTS.md, for each kind of control with a row there.
//
// The arm swings around its home for a simulated second. Loop and replay take turns with each tenth
// of it, from the same state, and must end in the same bits, otherwise the row is an error.
//
//   build/release/control_loop_bench [ROBOT.yaml ...]   default: the built-in rc7
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "bench.h"
#include "turns.h"

namespace robocell {
namespace {

constexpr double kAmplitude = 0.2;  // rad around home
constexpr double kSeconds = 1;
constexpr size_t kParts = 10;  // up to a millisecond each: most turns are undisturbed

// The command of a program in a tick; computing it does not belong to the loop.
struct Control {
  std::string name;
  CtrlMode mode = CtrlMode::kPosition;
  std::string controller;  // "": the mode's own
};
const std::vector<Control> kControls = {
    {"joint position"},
    {"joint impedance", CtrlMode::kTorque, "joint_impedance"},
    {"gravity torques", CtrlMode::kTorque},
    {"Cartesian impedance", CtrlMode::kTorque, "cartesian_impedance"}};

class Swing {
 public:
  Swing(const std::string& file, const Control& control)
      : control_(control),
        scene_(bench::SceneWith(Config(file, control))),
        robot_(Robot::Of(scene_, "robot")) {
    scene_.Reset();
    const std::span<double> home = robot_.jnt_pos_cmd();
    MakeTargets({home.begin(), home.end()});
    if (control.mode != CtrlMode::kPosition) robot_.set_ctrl_mode(control.mode);
    if (!control.controller.empty()) UseController();
    Record();
  }

  // Runs a part with the loop of a control program.
  void Loop() {
    for (size_t tick = begin(); tick < end(); ++tick) {
      Command(tick);
      robot_.Update();
      (void)robot_.Step();  // the final state is checked
    }
  }
  // Runs the same part with the engine alone.
  void Replay() {
    const mjModel* m = scene_.model();
    for (size_t tick = begin(); tick < end(); ++tick) {
      mju_copy(scene_.data()->ctrl, controls_.data() + tick * static_cast<size_t>(m->nu), m->nu);
      mj_step(m, scene_.data());
    }
  }
  void NextPart() { part_ = (part_ + 1) % kParts; }
  void Rewind() { scene_.SetState(states_[part_]); }
  std::string Problem() const {
    return scene_.state() == states_[part_ + 1] ? "" : "ends elsewhere than recorded";
  }
  double ticks_of_part() const { return static_cast<double>(targets_.size()) / kParts; }

 private:
  // Otherwise the engine carries the arm, and there is nothing to compensate.
  static RobotConfig Config(const std::string& file, const Control& control) {
    RobotConfig config = RobotConfig::Load(file);
    config.gravcomp = control.mode == CtrlMode::kPosition;
    return config;
  }
  size_t begin() const { return part_ * targets_.size() / kParts; }
  size_t end() const { return (part_ + 1) * targets_.size() / kParts; }
  void UseController() {
    const std::string arm = robot_.arm().name();
    robot_.SetController(arm, control_.controller);
    cartesian_ = dynamic_cast<CartesianImpedanceController*>(&robot_.controller(arm));
  }
  void Command(size_t tick) {
    if (cartesian_) {
      cartesian_->SetPose(poses_[tick]);
    } else if (floats_) {
      robot_.GravityTorques(robot_.jnt_trq_cmd());
    } else {
      std::copy(targets_[tick].begin(), targets_[tick].end(), robot_.jnt_pos_cmd().begin());
    }
  }
  void MakeTargets(const std::vector<double>& home) {
    const int ticks = static_cast<int>(std::lround(kSeconds / scene_.timestep()));
    for (int tick = 0; tick < ticks; ++tick) {
      const double offset = kAmplitude * std::sin(2 * M_PI * tick / ticks);
      targets_.push_back(home);
      for (double& q : targets_.back()) q += offset;
      poses_.push_back(robot_.FkFrame(targets_.back()));
    }
  }
  void Record() {
    const mjModel* m = scene_.model();
    states_.push_back(scene_.state());
    for (part_ = 0; part_ < kParts; ++part_) {
      for (size_t tick = begin(); tick < end(); ++tick) {
        Command(tick);
        robot_.Update();
        controls_.insert(controls_.end(), scene_.data()->ctrl, scene_.data()->ctrl + m->nu);
        (void)robot_.Step();
      }
      states_.push_back(scene_.state());
    }
    part_ = 0;
  }

  Control control_;
  bool floats_ = control_.controller.empty() && control_.mode == CtrlMode::kTorque;
  Scene scene_;
  Robot robot_;
  CartesianImpedanceController* cartesian_ = nullptr;
  std::vector<std::vector<double>> targets_;  // of each tick
  std::vector<Pose> poses_;
  std::vector<double> controls_;
  std::vector<std::vector<double>> states_;  // the beginnings of parts, and the end of the last one
  size_t part_ = 0;
};

void Register(const std::string& file) {
  for (const Control& control : kControls) {
    const auto swing = std::make_shared<Swing>(file, control);
    const auto side = [&](void (Swing::*run)()) {
      return bench::Side{.row = control.name + ", " + RobotConfig::Load(file).name,
                         .count = swing->ticks_of_part(),
                         .prepare = [=] { swing->Rewind(); },
                         .run = [=] { ((*swing).*run)(); },
                         .problem = [=] { return swing->Problem(); }};
    };
    const auto next = [=] { swing->NextPart(); };
    bench::AddPair({.ours = side(&Swing::Loop), .peer = side(&Swing::Replay), .next = next});
  }
}

}  // namespace
}  // namespace robocell

int main(int argc, char** argv) {
  return robocell::bench::MainOfPairs(argc, argv, robocell::Register,
                                      robocell::assets::BuiltinRobotFile("rc7"));
}
