#include "robocell/spec/yaml.h"

#include <fmt/format.h>

#include <filesystem>

#include "robocell/spec/env_config.h"
#include "robocell/spec/object_info.h"
#include "robocell/spec/spec_file.h"
#include "robocell/spec/yaml_reader.h"
#include "robocell/spec/yaml_writer.h"

namespace robocell {

namespace {

template <class T>
T ReadText(std::string_view text, internal::yaml::Reader& reader, const std::string& source) {
  T spec{};
  reader.ReadDocument(internal::yaml::ParseText(text, source), spec);
  reader.problems().Throw(source);
  return spec;
}

}  // namespace

template <class T>
T ParseYaml(std::string_view text, const std::string& source, const std::string& directory,
            const std::vector<std::string>& overrides) {
  internal::yaml::Reader reader(source, directory);
  for (const std::string& given : overrides)
    reader.AddOverride(internal::yaml::ParseOverride(given));
  return ReadText<T>(text, reader, source);
}

template <class T>
T LoadYaml(const std::string& path, const std::vector<std::string>& overrides) {
  internal::yaml::Reader reader(path, std::filesystem::path(path).parent_path().string());
  for (const std::string& text : overrides) reader.AddOverride(internal::yaml::ParseOverride(text));
  return ReadText<T>(ReadSpecFile(path, T::kTypeName), reader, path);
}

template <class T>
T LoadYaml(const std::string& path) {
  return LoadYaml<T>(path, {});
}

#define ROBOCELL_YAML_FILE(T)                                                       \
  template T ParseYaml<T>(std::string_view, const std::string&, const std::string&, \
                          const std::vector<std::string>&);                         \
  template T LoadYaml<T>(const std::string&);                                       \
  template T LoadYaml<T>(const std::string&, const std::vector<std::string>&);
#define ROBOCELL_YAML(T)                    \
  template std::string ToYaml<T>(const T&); \
  template T FromYamlUnchecked<T>(std::string_view);

template <class T>
std::string ToYaml(const T& spec) {
  return internal::yaml::TextOf(spec);
}

template <class T>
T FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<T>(text);
}

ROBOCELL_YAML_FILE(RobotConfig)
ROBOCELL_YAML_FILE(SceneSpec)
ROBOCELL_YAML_FILE(RunConfig)
ROBOCELL_YAML_FILE(RobotSpec)
ROBOCELL_YAML_FILE(SceneObject)
ROBOCELL_YAML_FILE(CameraSpec)
ROBOCELL_YAML_FILE(CameraSystemConfig)
ROBOCELL_YAML_FILE(AttachmentSpec)
ROBOCELL_YAML_FILE(EnvConfig)
ROBOCELL_YAML_FILE(ObjectInfo)

ROBOCELL_YAML(SceneSpec)
ROBOCELL_YAML(SimOptions)
ROBOCELL_YAML(RobotSpec)
ROBOCELL_YAML(RobotConfig)
ROBOCELL_YAML(BaseConfig)
ROBOCELL_YAML(MoveGroupConfig)
ROBOCELL_YAML(GripperCtrl)
ROBOCELL_YAML(GripperDistance)
ROBOCELL_YAML(GripperJointRange)
ROBOCELL_YAML(TaskSpaceConfig)
ROBOCELL_YAML(Edit)
ROBOCELL_YAML(AttachmentSpec)
ROBOCELL_YAML(ForceTorqueSensorSpec)
ROBOCELL_YAML(ToolFrameSpec)
ROBOCELL_YAML(SceneObject)
ROBOCELL_YAML(CameraSpec)
ROBOCELL_YAML(CameraConfig)
ROBOCELL_YAML(RenderQuality)
ROBOCELL_YAML(RendererConfig)
ROBOCELL_YAML(CameraSystemConfig)
ROBOCELL_YAML(RunConfig)
ROBOCELL_YAML(FilesScenes)
ROBOCELL_YAML(Rates)
ROBOCELL_YAML(ObjectPlace)
ROBOCELL_YAML(CameraSight)
ROBOCELL_YAML(StartCamera)
ROBOCELL_YAML(StartConfig)
ROBOCELL_YAML(RandomNumber)
ROBOCELL_YAML(RandomProperty)
ROBOCELL_YAML(RandomLights)
ROBOCELL_YAML(RandomLook)
ROBOCELL_YAML(RandomDynamics)
ROBOCELL_YAML(RandomClutter)
ROBOCELL_YAML(RandomizedValue)
ROBOCELL_YAML(RandomizeConfig)
ROBOCELL_YAML(AugmentConfig)
ROBOCELL_YAML(ActionNoiseConfig)
ROBOCELL_YAML(EnvConfig)
ROBOCELL_YAML(EnvObject)
ROBOCELL_YAML(CameraAdderConfig)
ROBOCELL_YAML(ObjectVariation)
ROBOCELL_YAML(SimSettings)
ROBOCELL_YAML(WrapperConfig)
ROBOCELL_YAML(ObjectInfo)
#undef ROBOCELL_YAML_FILE
#undef ROBOCELL_YAML

RobotConfig RobotConfig::Load(const std::string& path) { return LoadYaml<RobotConfig>(path); }
SceneSpec SceneSpec::Load(const std::string& path) { return LoadYaml<SceneSpec>(path); }
std::vector<RunImport> ImportsOfRunFile(const std::string& path) {
  std::vector<RunImport> imports;
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(path, unreadable)) return imports;
  const auto add = [&](const YAML::Node& module) {
    if (!module.IsScalar()) return;
    const YAML::Mark mark = module.Mark();
    imports.push_back(
        {module.Scalar(), fmt::format("{}:{}:{}", path, mark.line + 1, mark.column + 1)});
  };
  try {
    const YAML::Node root = YAML::LoadFile(path);
    if (!root.IsMap()) return imports;
    const YAML::Node listed = root["imports"];
    if (listed.IsDefined() && listed.IsScalar()) add(listed);
    if (!listed.IsDefined() || !listed.IsSequence()) return imports;
    for (const auto& module : listed) add(module);
  } catch (const YAML::Exception&) {
    return {};
  }
  return imports;
}

RunConfig RunConfig::Load(const std::string& path) { return LoadYaml<RunConfig>(path); }
EnvConfig EnvConfig::Load(const std::string& path) { return LoadYaml<EnvConfig>(path); }

}  // namespace robocell
