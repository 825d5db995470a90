// Private to robot: where the commands of an arm stand, one port for each kind of number: joint
// positions, velocities, torques. The ports stay where they are while controllers come and go; the
// controller in use keeps its numbers in the port of its kind, if it has one.
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
  // From now on the values of the port count as commanded, even if they did not change.
  void SetCommanded(TargetKind kind);
  // Gives the controller its port, which takes over the controller's numbers; but where something
  // was written while the port was not in use, the controller is driven to that.
  void Connect(Controller& controller);
  // Restores the port from an earlier copy, if `controller` used one.
  void PutBack(const ArmPorts& before, Controller* controller);
  // Forgets what was written into ports that are not in use: the positions are where the arm is,
  // velocities and torques 0.
  void Reseed(const MoveGroup& arm);

 private:
  struct Port {
    std::vector<double> values;
    std::vector<double> seen;  // as it was left
    bool commanded = false;
  };
  static constexpr int kNone = -1;
  static int Index(TargetKind kind);
  static void Leave(Port& port);

  std::array<Port, 3> ports_;
  int in_use_ = kNone;
};

}  // namespace robocell::internal
