// The hidden names of files being written: ".steps.h5.4711.3.partial", the 3rd of process 4711.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace robocell::internal {

struct TemporaryName {
  static constexpr std::string_view kSuffix = ".partial";

  std::string name;     // its final name; the beginning of a long one
  int64_t process = 0;  // the writer
  uint64_t number = 0;  // counts the writes of that process

  std::string Text() const;
  // Returns unset for other names.
  static std::optional<TemporaryName> Parse(std::string_view file_name);
};

}  // namespace robocell::internal
