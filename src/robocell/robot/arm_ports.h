// Private to robot: the commands of an arm, one port for each kind: joint positions, velocities,
// torques. The ports stay in place while controllers come and go; the present controller keeps its
// numbers in the port of its kind, if there is one.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "robocell/robot/controller.h"

namespace robocell::internal {

class ArmPorts {
 public:
  void Resize(int nq, int nv);
  // Returns the port of kJointPositions, kJointVelocities or kJointTorques.
  std::span<double> of(TargetKind kind);
  // Marks the values of the port as commanded from now on, even if they did not change.
  void SetCommanded(TargetKind kind);
  // Gives the controller its port, which takes over the controller's numbers; but if values were
  // written while the port was not in use, the controller is driven to these.
  void Connect(Controller& controller);
  // Restores the port from an earlier copy, if `controller` used one.
  void PutBack(const ArmPorts& before, Controller* controller);
  // Forgets values written into unused ports: positions become those of the arm, velocities and
  // torques 0.
  void Reseed(const MoveGroup& arm);

 private:
  struct Port {
    std::vector<double> values;
    std::vector<double> seen;  // the values after the last use
    bool commanded = false;
  };
  static constexpr int kNone = -1;
  static int Index(TargetKind kind);
  static void Leave(Port& port);

  std::array<Port, 3> ports_;
  int in_use_ = kNone;
};

}  // namespace robocell::internal
