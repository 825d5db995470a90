// Private to scene: where the elements of a model stand in its files, and whose element it is that
// the engine complains about when a model does not compile.
#pragma once

#include <optional>
#include <string>

#include "robocell/scene/part.h"

namespace robocell::internal {

// The engine's text (of Compile's SpecError) with file and element as the part has them and, for
// what is known, what to do about it. Nothing when the text is about no element of this part.
// `prefix` is the part's in the scene.
std::optional<std::string> CompileProblem(const std::string& text, const Part& part,
                                          const std::string& prefix);

// The duplicate in the engine's message: "body", "l3".
struct Repeated {
  std::string kind, name;
};
std::optional<Repeated> RepeatedName(const std::string& text);
// Returns true if the part, with its prefix in the scene, brings such an element.
bool HasElement(const Part& part, const std::string& prefix, const Repeated& element);

// The file of the part's element of that name: "arm.xml", or "arm.xml or a tool of it" where that
// is not known.
std::string FileWith(const Part& part, const std::string& name);

// Returns the place of the part's joint or actuator of that name: "arm.xml:12", or the file alone
// if the line is not known.
std::string PlaceInModel(const Part& part, mjtObj kind, const std::string& name);

}  // namespace robocell::internal
