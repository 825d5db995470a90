#include "robocell/features/own_features.h"

#include <fmt/format.h>

#include <utility>

#include "robocell/base/call_hook.h"
#include "robocell/base/error.h"
#include "robocell/base/hook_error.h"
#include "robocell/base/paths.h"
#include "robocell/base/plugin.h"
#include "robocell/base/registry.h"
#include "robocell/data/episode_schema.h"
#include "robocell/features/feature_frames.h"

namespace robocell {
namespace {

struct OwnFeature {
  Feature feature;
  FeatureFunction function;
  FeatureCode code;
};
Registry<OwnFeature>& RegisteredFeatures() {
  static Registry<OwnFeature> registry("feature");
  return registry;
}

}  // namespace

void RegisterFeature(const std::string& name, Feature feature, FeatureFunction function,
                     bool replace, FeatureCode code) {
  if (const std::string& plugin = PluginBeingLoaded(); !code.files && !plugin.empty())
    code.files = [plugin] { return std::vector<std::string>{plugin}; };
  internal::RequireFileName("feature", name);
  if (!function) throw ArgumentError("feature '" + name + "' needs a function that reads it");
  if (feature.column.type != ColumnType::kFloat64)
    throw ArgumentError(
        fmt::format("feature '{}' must be float64, not {}", name, NameOf(feature.column.type)));
  feature.column.name = "features/" + name;
  feature.source = "feature of a user's own";
  FeatureSchema().Add(feature);  // its checks, and those of the column in an episode
  EpisodeSchema().AddColumn(feature.column);
  RegisteredFeatures().Register(name, {std::move(feature), std::move(function), std::move(code)},
                                replace);
}

std::vector<std::string> OwnFeatures() { return RegisteredFeatures().names(); }

bool IsOwnFeature(const std::string& name) { return RegisteredFeatures().Has(name); }

std::vector<std::string> CodeOfFeatures(const std::vector<std::string>& names) {
  std::vector<std::string> files;
  for (const std::string& name : names) {
    const OwnFeature own = RegisteredFeatures().Find(name);
    if (!own.code.files) continue;
    for (std::string& file : own.code.files()) files.push_back(std::move(file));
  }
  return files;
}

std::string OwnFeatureSource::Function::PlaceOfHook(const char* /*method*/) const {
  return code.place ? code.place() : "";
}

OwnFeatureSource::OwnFeatureSource(Scene scene, const std::vector<std::string>& names)
    : FeatureSource(std::move(scene)) {
  for (const std::string& name : names) {
    OwnFeature own = RegisteredFeatures().Find(name);
    Function function;
    function.read = std::move(own.function);
    function.code = std::move(own.code);
    const ColumnSpec& column = own.feature.column;
    if (const std::string why = internal::WhyNoFrame(this->scene(), column.frame); !why.empty()) {
      throw HookError(fmt::format("feature '{}': {}", column.name, why), function.PlaceOfHook(""));
    }
    Add(std::move(own.feature));
    functions_.push_back(std::move(function));
  }
}

void OwnFeatureSource::ReadNumbers(std::span<double> out) {
  for (size_t i = 0; i < functions_.size(); ++i) {
    const Function& function = functions_[i];
    const std::span<double> part = out.first(static_cast<size_t>(features()[i].size()));
    internal::CallHook(function, features()[i].column.name.c_str(),
                       [&] { function.read(scene().outer(), part); });
    out = out.subspan(part.size());
  }
}

std::string OwnFeatureSource::PlaceOf(size_t feature) const {
  return functions_[feature].PlaceOfHook("");
}

}  // namespace robocell
