// Turns the engine's message about an unreadable model file into one with the place first and the
// next step last:
//
//   arm.xml:5: <geom>: unrecognized attribute: 'typ'. Did you mean 'type'? Correct it there; ...
//
// Finds numbers, too, that the engine accepts and that mean nothing.
#pragma once

#include <mujoco/mujoco.h>

#include <string>

namespace robocell::internal {

// `complaint` is the engine's text, `file` the model's, "" for a text without one. If the engine
// does not report the line, the place is the file alone.
std::string ParseProblem(const std::string& complaint, const std::string& file);

// Whether a warning of the engine reports a NaN in a model. Such models are rejected: the engine
// treats a mass of NaN as missing, and accepts a position of NaN.
bool IsAboutNan(const std::string& warning);
// The same for a NaN: "arm.xml:5: mass="nan" is no number. ...". Without a line where it is in a
// file that the model includes.
std::string NanProblem(const std::string& file);

// The first element that is made of a number that is infinite or none at all. The engine compiles
// many of them, and only the simulation shows it: a body that is nowhere, a mass that is another one.
// As the engine words its own complaints:
// "Error: pos is 0 inf 0.1; ...\nElement name 'upper', id 2". "" when all are finite. Ranges, which
// may be open, user data, and what the engine derives are not looked at.
std::string NonFiniteElement(const mjModel* model);

}  // namespace robocell::internal
