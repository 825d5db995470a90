// One model in the place of another, said by the environment: ROBOCELL_OVERRIDE_KINOVA_GEN3 is the
// file that `menagerie:kinova_gen3` means, ROBOCELL_OVERRIDE_TABLE the one that `table` means. The
// rest of the variable is the model's name as it is asked for, without `menagerie:`, in capitals
// and with `_` for everything that is no letter or digit. Paths are never replaced.
#pragma once

#include <optional>
#include <string>

namespace robocell::assets {

// `menagerie:` in front of the name is left out.
std::string OverrideVariable(const std::string& name);

// Absolute path of the file; unset when the variable is not. NotFoundError with the variable when
// its value is no file.
std::optional<std::string> OverrideFile(const std::string& name);

}  // namespace robocell::assets
