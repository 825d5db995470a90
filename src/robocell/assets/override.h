// Replaces one model by another through the environment: ROBOCELL_OVERRIDE_KINOVA_GEN3 is the file
// that `menagerie:kinova_gen3` means, ROBOCELL_OVERRIDE_TABLE the one that `table` means. The rest
// of the variable is the requested name of the model, without `menagerie:`, in capitals and with
// `_` for every character other than a letter or digit. Paths are never replaced.
#pragma once

#include <optional>
#include <string>

namespace robocell::assets {

// Returns the variable's name; `menagerie:` in front of the model's name is left out.
std::string OverrideVariable(const std::string& name);

// Returns the absolute path of the file; unset if the variable is not set. Throws NotFoundError
// with the variable if its value is not a file.
std::optional<std::string> OverrideFile(const std::string& name);

}  // namespace robocell::assets
