#include "robocell/spec/field_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "robocell/spec/env_config.h"
#include "robocell/spec/run_config.h"

namespace robocell {
namespace {

// A part of a spec.
struct Part {
  std::string_view owner;  // type
  const char* path;        // path in a file
  std::vector<std::string> fields;
};

const std::vector<Part>& Parts() {
  constexpr const char* kRun = RunConfig::kTypeName;
  constexpr const char* kEnv = EnvConfig::kTypeName;
  constexpr const char* kCameras = CameraSystemConfig::kTypeName;
  static const std::vector<Part> kParts = {
      {kCameras, "cameras.renderer", FieldNames<RendererConfig>()},
      {kCameras, "cameras.renderer.quality", FieldNames<RenderQuality>()},
      {RendererConfig::kTypeName, "cameras.renderer.quality", FieldNames<RenderQuality>()},
      {kRun, "cameras", FieldNames<CameraSystemConfig>()},
      {kRun, "cameras.renderer", FieldNames<RendererConfig>()},
      {kRun, "rates", FieldNames<Rates>()},
      {kRun, "options", FieldNames<SimOptions>()},
      {kEnv, "cameras", FieldNames<CameraSystemConfig>()},
      {kEnv, "cameras.renderer", FieldNames<RendererConfig>()},
      {kEnv, "sim", FieldNames<SimSettings>()},
  };
  return kParts;
}

}  // namespace

std::string PlaceHint(std::string_view type, const std::string& name) {
  for (const Part& part : Parts()) {
    if (part.owner == type && std::ranges::find(part.fields, name) != part.fields.end())
      return fmt::format(" It is a field of `{0}`: {0}.{1}", part.path, name);
  }
  return "";
}

std::string KindKeyHint(std::string_view key, const std::string& name) {
  const bool meant = name == "kind" || name == "source";
  return meant && name != key ? fmt::format(" The kind is named by `{}`", key) : "";
}

}  // namespace robocell
