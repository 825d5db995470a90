// What the engine says of a model file that it cannot read, with the place first and the next step
// last:
//
//   arm.xml:5: <geom>: unrecognized attribute: 'typ'. Did you mean 'type'? Correct it there; ...
#pragma once

#include <string>

namespace robocell {

// `complaint` is the engine's text, `file` the model's, "" for a text without one. Where the engine
// does not tell the line, the place is the file alone.
std::string ParseProblem(const std::string& complaint, const std::string& file);

// Whether a warning of the engine's says that a model has a NaN. What has one is refused: the
// engine reads a mass of NaN as none given, and takes a place of NaN as it is.
bool IsAboutNan(const std::string& warning);
// The same for a NaN: "arm.xml:5: mass="nan" is no number. ...". Without a line where it is in a
// file that the model includes.
std::string NanProblem(const std::string& file);

}  // namespace robocell
