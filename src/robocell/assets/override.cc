#include "robocell/assets/override.h"

#include <fmt/format.h>

#include <filesystem>
#include <string_view>

#include "robocell/assets/roots.h"
#include "robocell/base/error.h"

namespace robocell::assets {

namespace fs = std::filesystem;

std::string OverrideVariable(const std::string& name) {
  std::string variable = "ROBOCELL_OVERRIDE_";
  constexpr std::string_view kMenagerie = "menagerie:";
  const size_t start = name.starts_with(kMenagerie) ? kMenagerie.size() : 0;
  for (const char c : name.substr(start)) {
    const bool lower = c >= 'a' && c <= 'z';
    const bool other = (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    variable += lower ? static_cast<char>(c - 'a' + 'A') : other ? c : '_';
  }
  return variable;
}

std::optional<std::string> OverrideFile(const std::string& name) {
  const std::string variable = OverrideVariable(name);
  const std::string value = internal::Environment(variable.c_str());
  if (value.empty()) return std::nullopt;
  std::error_code error;
  if (fs::is_regular_file(value, error)) return fs::absolute(value, error).lexically_normal();
  throw NotFoundError(
      fmt::format("{} is '{}', which is no file; it takes the place of the model '{}': correct the "
                  "variable or unset it",
                  variable, value, name));
}

}  // namespace robocell::assets
