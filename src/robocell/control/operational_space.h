// Operational-space inertia of the TCP, the damping that makes its springs critically damped, and
// the joint torques of both: the small matrices of Cartesian impedance control (O. Khatib, "A
// unified approach for motion and force control of robot manipulators", 1987). It continues in the
// registers that link_kernel.h fills. Instruction sets round differently.
//
// Plain numbers only: code for every instruction set includes this header.
#pragma once

#include "robocell/kinematics/link_table.h"

namespace robocell {

namespace internal {
struct LinkAnswer;  // kinematics/link_kernel.h
}

// The springs that hold the TCP, along and about the axes of the robot base frame.
struct TcpSprings {
  double stiffness[6] = {};  // N/m, then Nm/rad
  double root[6] = {};       // its square root: the coordinates in which all springs are equal
};

TcpSprings MakeTcpSprings(const double* stiffness);

// The target pose of the TCP in the robot base frame.
struct TcpTarget {
  const double* position = nullptr;
  const double* axes = nullptr;  // the TCP's axes, one after the other
};

// The linear part before the angular part, in the axes of the base.
struct OperationalSpaceQuery {
  int n = 0;  // joints
  // Tip, Jacobian and inertia, and the torques that the joints need for their present motion
  // (LinkPart::kAll without accelerations).
  const internal::LinkAnswer* arm = nullptr;
  const double* wanted = nullptr;    // target joint accelerations
  const double* velocity = nullptr;  // joint velocities
  const TcpSprings* springs = nullptr;
  // Inputs of the torques: target pose, additional wrench (6), damping ratio.
  TcpTarget goal;
  const double* feedforward = nullptr;
  double damping_ratio = 1;
};

struct OperationalSpaceResult {
  // Critical damping force, against the velocity of the TCP: in coordinates in which all springs
  // are equal, the damping matrix is twice the square root of the operational-space inertia. Its
  // relative error is below 1e-4, and it never adds energy.
  double damping[6];
  // The force that accelerates the TCP like the target joint accelerations.
  double inertial_force[6];
  // Joint torques: those of the target accelerations, and those of the TCP force
  // stiffness * pose error - damping_ratio * damping + feedforward - inertial_force.
  alignas(64) LinkTable::Row torques;
};

void ComputeOperationalSpace(const OperationalSpaceQuery& query, OperationalSpaceResult* out);

// One part alone: the pose error of the TCP, displacement and rotation vector, 6.
void ComputeDeviation(const internal::LinkAnswer& arm, const TcpTarget& goal, double* deviation);
// One part alone: the inverse of the operational-space inertia (J M^-1 J^T), the lower triangle row
// by row.
void ComputeInverseInertia(int n, const internal::LinkAnswer& arm, double* inverse_inertia);
// The last part alone: the critical damping force at that inverse inertia.
void CriticalDamping(const double* stiffness, const double* inverse_inertia, const double* velocity,
                     double* out);

// Lower bound of the inverse inertia, 1/kg; the inertia is infinite at a singular pose.
inline constexpr double kLeastInverseInertia = 1e-6;

}  // namespace robocell
