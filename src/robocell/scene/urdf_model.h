// Private to scene: makes an mjSpec of a URDF. The engine reads URDFs too, but gives two meshes of
// the same name in different folders the same shape, turns the inertia of a rotated <inertial>, and
// drops mimic joints and fixed links.
//
// Links become bodies of their names, fixed ones included; a root link `world` without shape is the
// model's world. Mimic joints become joint equalities. Visual geoms are in group 2; collision geoms
// are in group 3, or in group 0 if the robot has no visual ones. Efforts limit the forces on
// joints.
#pragma once

#include <string>
#include <vector>

#include "robocell/assets/urdf.h"
#include "robocell/mujoco/owners.h"

namespace robocell::internal {

// Returns the model without actuators; names of mesh files are absolute.
SpecPtr MakeUrdfSpec(const Urdf& urdf);

// Adds a position servo for every joint that neither follows another nor is a wheel or caster (a
// continuous joint that none of the file's transmissions names). Returns what was added, for the
// user; empty without joints.
std::vector<std::string> AddUrdfServos(const Urdf& urdf, mjSpec* spec);

}  // namespace robocell::internal
