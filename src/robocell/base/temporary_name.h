// The hidden names of what is being written: ".steps.h5.4711.3.partial", the 3rd of process 4711.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace robocell::internal {

struct TemporaryName {
  static constexpr std::string_view kSuffix = ".partial";

  std::string name;     // what it will be called; the beginning of a long one
  int64_t process = 0;  // who writes it
  uint64_t number = 0;  // of the writes of that process

  std::string Text() const;
  // Unset for names of another making.
  static std::optional<TemporaryName> Parse(std::string_view file_name);
};

}  // namespace robocell::internal
