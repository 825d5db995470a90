// Private to scene: finds the places of a model's elements in its files, and the part that the
// engine's message is about when a model does not compile.
#pragma once

#include <optional>
#include <string>

#include "robocell/scene/part.h"

namespace robocell::internal {

// Returns the engine's text (of Compile's SpecError) with the file and element as the part names
// them and, for known problems, the next step. Unset if the text is about no element of this part.
// `prefix` is the part's in the scene.
std::optional<std::string> CompileProblem(const std::string& text, const Part& part,
                                          const std::string& prefix);

// The duplicate in the engine's message: "body", "l3".
struct Repeated {
  std::string kind, name;
};
std::optional<Repeated> RepeatedName(const std::string& text);
// Returns true if the part, with its prefix in the scene, contains such an element.
bool HasElement(const Part& part, const std::string& prefix, const Repeated& element);

// Returns the file of the part's named element: "arm.xml", or "arm.xml or a tool of it" where it is
// not known.
std::string FileWith(const Part& part, const std::string& name);

// Returns the place of the part's joint or actuator of that name: "arm.xml:12", or the file alone
// if the line is not known.
std::string PlaceInModel(const Part& part, mjtObj kind, const std::string& name);

}  // namespace robocell::internal
