// Specs from and to YAML. Every problem of a file is reported at once, with file:line:column, the
// nearest field for a misspelled key, and the values an option can have. The reader follows the
// field declarations; see fields.h.
//
//   RobotConfig robot = LoadYaml<RobotConfig>("xarm7.yaml");
//   std::string text = ToYaml(robot);
//
// Nothing in a file is executed or imported.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace robocell {

// T: RobotConfig, SceneSpec, RunConfig, RobotSpec, SceneObject, CameraSpec, CameraSystemConfig,
// AttachmentSpec, EnvConfig. SpecError when the file is not valid, IoError when it cannot be read.
template <class T>
T LoadYaml(const std::string& path);

// `source` stands for the file name in messages; relative paths inside start at `directory`;
// `overrides` as LoadYaml takes them.
template <class T>
T ParseYaml(std::string_view text, const std::string& source = "yaml",
            const std::string& directory = "", const std::vector<std::string>& overrides = {});

template <class T>
std::string ToYaml(const T& spec);

// What ToYaml wrote, also of a spec that is not finished: no validation. Any spec struct, not only
// those above; SpecError for text that ToYaml did not write.
template <class T>
T FromYamlUnchecked(std::string_view text);

// Like LoadYaml, with values of single fields replaced first, as in "start.base_distance=[0.2,
// 0.4]". The replacements go through the same checks, and messages name them as "--set
// start.base_distance=...".
template <class T>
T LoadYaml(const std::string& path, const std::vector<std::string>& overrides);

}  // namespace robocell
