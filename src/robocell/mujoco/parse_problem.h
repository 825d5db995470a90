// Turns the engine's message about an unreadable model file into one with the place first and the
// next step last:
//
//   arm.xml:5: <geom>: unrecognized attribute: 'typ'. Did you mean 'type'? Correct it there; ...
//
// It also finds meaningless numbers that the engine accepts.
#pragma once

#include <mujoco/mujoco.h>

#include <string>

namespace robocell::internal {

// `complaint` is the engine's text, `file` the model's, "" for a text without one. If the engine
// does not report the line, the place is the file alone.
std::string ParseProblem(const std::string& complaint, const std::string& file);

// Returns true if a warning of the engine reports a NaN in a model. Such models are rejected: the
// engine treats a mass of NaN as missing, and accepts a position of NaN.
bool IsAboutNan(const std::string& warning);
// Returns the same for a NaN: "arm.xml:5: mass="nan" is no number. ...". Without a line if it is in
// a file that the model includes.
std::string NanProblem(const std::string& file);

// Returns the first element with a number that is infinite or NaN. The engine compiles many of
// them, and only the simulation shows it: a body without a place, a changed mass. The text has the
// form of the engine's own messages: "Error: pos is 0 inf 0.1; ...\nElement name 'upper', id 2". ""
// if all are finite. Ranges, which may be open, user data, and values that the engine derives are
// not checked.
std::string NonFiniteElement(const mjModel* model);

}  // namespace robocell::internal
