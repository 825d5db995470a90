// Spec files as text. A file that is not there is told with what is there instead.
#pragma once

#include <string>
#include <string_view>

namespace robocell {

// The content of the file; `type` is the spec that is wanted, "RobotConfig". IoError with
// MissingSpecFile when there is no such file.
std::string ReadSpecFile(const std::string& path, const std::string& type);

// "no robot file 'xarm.yaml'. In /data: demo.yaml, xarm7.yaml. Did you mean 'xarm7.yaml'? ...";
// "" when `path` is a file.
std::string MissingSpecFile(const std::string& path, const std::string& type);

// SpecError unless `text` can be the text of a YAML file: UTF-8 without zero bytes. `source` stands
// for the file in messages.
void RequireText(std::string_view text, const std::string& source);

}  // namespace robocell
