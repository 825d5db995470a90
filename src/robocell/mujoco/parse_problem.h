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

}  // namespace robocell
