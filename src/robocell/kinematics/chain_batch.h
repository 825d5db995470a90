// Kinematics and dynamics of many configurations of a chain at once, one in each lane of the
// processor's registers.
//
// All arrays have one row per configuration; the number of rows is that of the output. An input
// with one row applies to all configurations. Frames, units and meaning are those of the functions
// of Chain (chain.h), which are faster for a single configuration. A result does not depend on its
// batch; results of Chain, and of other instruction sets, differ from it by rounding.
//
// Throws ArgumentError, with the argument, for a number of values that does not fit and for values
// that are not finite. No allocation. Outputs may not overlap inputs.
//
//   std::vector<double> q(1000 * 7), torques(1000 * 7);
//   GravityTorquesBatch(chain, q, std::array{0.0, 0.0, -9.81}, torques);
#pragma once

#include <span>

#include "robocell/kinematics/chain.h"

namespace robocell {

// q (B, n); tips (B, 4, 4): poses of the tip in the base frame.
void FkBatch(const Chain& chain, std::span<const double> q, std::span<double> tips);
// q (B, n); jacobians (B, 6, n).
void JacobianBatch(const Chain& chain, std::span<const double> q, std::span<double> jacobians);
// Also computes tips (B, 4, 4) in the same pass: bit for bit those of FkBatch.
void JacobianBatch(const Chain& chain, std::span<const double> q, std::span<double> jacobians,
                   std::span<double> tips);
// q (B, n), gravity in the base frame (B, 3); torques (B, n).
void GravityTorquesBatch(const Chain& chain, std::span<const double> q,
                         std::span<const double> gravity_in_base, std::span<double> torques);
// q (B, n); masses (B, n, n).
void MassMatrixBatch(const Chain& chain, std::span<const double> q, std::span<double> masses);
// q, qd (B, n); torques (B, n): the part caused by the velocities.
void CoriolisTorquesBatch(const Chain& chain, std::span<const double> q, std::span<const double> qd,
                          std::span<double> torques);
// q, qd, qdd (B, n), gravity in the base frame (B, 3); torques (B, n).
void InverseDynamicsBatch(const Chain& chain, std::span<const double> q, std::span<const double> qd,
                          std::span<const double> qdd, std::span<const double> gravity_in_base,
                          std::span<double> torques);
// q (B, n); values (B,): see manipulability.h.
void ManipulabilityBatch(const Chain& chain, std::span<const double> q, std::span<double> values);

}  // namespace robocell
