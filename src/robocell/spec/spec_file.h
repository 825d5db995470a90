// Reads spec files as text. The error for a missing file lists what is there instead.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace robocell {

inline constexpr uint64_t kMostSpecBytes = uint64_t{16} << 20;  // no spec file is bigger

// The content of the file; `type` is the spec that is wanted, "RobotConfig". IoError with
// MissingSpecFile when there is no such file, and for a larger one.
std::string ReadSpecFile(const std::string& path, const std::string& type);

// "no robot file 'xarm.yaml'. In /data: demo.yaml, xarm7.yaml. Did you mean 'xarm7.yaml'? ...";
// what a folder, a pipe or a device is; "" when `path` is a file.
std::string MissingSpecFile(const std::string& path, const std::string& type);

// SpecError unless `text` can be the text of a YAML file: UTF-8 without zero bytes. `source` stands
// for the file in messages.
void RequireText(std::string_view text, const std::string& source);

}  // namespace robocell
