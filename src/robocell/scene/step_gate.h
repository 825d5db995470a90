// StepGate: an observer that is asked before each step of a scene and notified after it. A viewer is
// one: it pauses the simulation, applies the forces of the mouse, draws and paces, and ends the
// loops of programs once its window was closed.
//
//   scene.AddObserver(gate);   // held weakly, as any observer; the last one that was added counts,
//                              // so a viewer does not open beside another one
//
// While it holds, StepN() makes no further step and returns the number of steps made. Once it
// stops, every step returns StepResult::kStopped with the reason. Without a gate a step costs
// nothing more. Threads: those of the scene.
// Internal to scene/, viewer/ and hardware/.
#pragma once

#include <string>

#include "robocell/scene/scene.h"

namespace robocell::internal {

// Key of the observer of a scene that is stepped by episodes, which no window may stop: those of
// environments and rollouts.
inline constexpr const char* kEpisodesKey = "episodes";

class StepGate : public SceneObserver {
 public:
  enum Answer { kGo, kHold, kStop };

  virtual Answer BeforeStep() = 0;
  // Called after each step that it let go, also one that diverged or threw an exception.
  virtual void EndStep() noexcept = 0;
  virtual void AfterStep() = 0;  // not called for a step that diverged
  // Returns the reason of kStop, for the message of the result.
  virtual std::string StopReason() const = 0;
};

// A gate that ties the scene to a real arm (hardware/arm_link.h). All that were added count, beside
// a viewer's: they are asked after it, and notified before it.
class StepLink : public StepGate {};

}  // namespace robocell::internal
