// Specs from and to YAML. Every problem of a file is reported at once, with file:line:column, the
// nearest field for a misspelled key, and the values that an option can have. The reader follows
// the field declarations; see fields.h.
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
// AttachmentSpec, EnvConfig. Throws SpecError if the file is not valid, IoError if it cannot be
// read.
template <class T>
T LoadYaml(const std::string& path);

// `source` stands for the file name in messages; relative paths inside start at `directory`;
// `overrides` as for LoadYaml.
template <class T>
T ParseYaml(std::string_view text, const std::string& source = "yaml",
            const std::string& directory = "", const std::vector<std::string>& overrides = {});

template <class T>
std::string ToYaml(const T& spec);

// Reads the output of ToYaml, also of an unfinished spec: no validation. Works for any spec struct,
// not only those above; throws SpecError for other text.
template <class T>
T FromYamlUnchecked(std::string_view text);

// Like LoadYaml, but first replaces values of single fields, as in "start.base_distance=[0.2,
// 0.4]". The replacements go through the same checks, and messages name them as "--set
// start.base_distance=...".
template <class T>
T LoadYaml(const std::string& path, const std::vector<std::string>& overrides);

}  // namespace robocell
