// For tests only: a gate that answers as it is told, like a viewer's (scene/step_gate.h).
#pragma once

#include <memory>
#include <string>

#include "robocell/scene/scene.h"
#include "robocell/scene/step_gate.h"

namespace robocell {

class GateForTests final : public internal::StepGate {
 public:
  // The scene holds it weakly.
  static std::shared_ptr<GateForTests> Of(Scene scene, Answer answer) {
    auto gate = std::make_shared<GateForTests>();
    gate->answer = answer;
    scene.AddObserver(gate);
    return gate;
  }

  Answer BeforeStep() override {
    ++asked;
    return answer;
  }
  void EndStep() noexcept override { ++ended; }
  void AfterStep() override { ++good; }
  std::string StopReason() const override { return "stopped: the window is closed"; }

  Answer answer = kGo;
  int asked = 0, ended = 0, good = 0;
};

}  // namespace robocell
