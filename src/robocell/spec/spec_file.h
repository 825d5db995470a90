// Reads spec files as text. The error for a missing file lists the existing ones.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace robocell {

inline constexpr uint64_t kMostSpecBytes = uint64_t{16} << 20;  // the largest spec file

// Returns the content of the file; `type` is the expected spec, "RobotConfig". Throws IoError with
// MissingSpecFile if there is no such file, and for a larger one.
std::string ReadSpecFile(const std::string& path, const std::string& type);

// Returns "no robot file 'xarm.yaml'. In /data: demo.yaml, xarm7.yaml. Did you mean 'xarm7.yaml'?
// ...", or a description of a folder, a pipe or a device; "" if `path` is a file.
std::string MissingSpecFile(const std::string& path, const std::string& type);

// Throws SpecError unless `text` can be the text of a YAML file: UTF-8 without zero bytes. `source`
// stands for the file in messages.
void RequireText(std::string_view text, const std::string& source);

}  // namespace robocell
