// Turns the engine's message about an unreadable model file into one with the place first and the
// next step last:
//
//   arm.xml:5: <geom>: unrecognized attribute: 'typ'. Did you mean 'type'? Correct it there; ...
#pragma once

#include <string>

namespace robocell {

// `complaint` is the engine's text, `file` the model's, "" for a text without one. If the engine
// does not report the line, the place is the file alone.
std::string ParseProblem(const std::string& complaint, const std::string& file);

// Whether a warning of the engine reports a NaN in a model. Such models are rejected: the engine
// treats a mass of NaN as missing, and accepts a position of NaN.
bool IsAboutNan(const std::string& warning);
// The same for a NaN: "arm.xml:5: mass="nan" is no number. ...". Without a line where it is in a
// file that the model includes.
std::string NanProblem(const std::string& file);

}  // namespace robocell
