#include "robocell/features/declared_features.h"

#include <fmt/format.h>

#include <utility>

#include "robocell/base/call_hook.h"
#include "robocell/data/episode_schema.h"
#include "robocell/features/feature_frames.h"

namespace robocell {
namespace {

void RequireSignal(const Feature& feature) {
  const std::string& name = feature.column.name;
  if (name.empty()) throw ArgumentError("a signal needs a name");
  if (feature.column.type != ColumnType::kFloat64) {
    throw ArgumentError(
        fmt::format("signal '{}' must be float64, not {}", name, NameOf(feature.column.type)));
  }
  if (feature.role != FeatureRole::kObservation && feature.role != FeatureRole::kPrivileged) {
    throw ArgumentError(fmt::format("signal '{}' must be an observation, privileged or not, got {}",
                                    name, NameOf(feature.role)));
  }
}

}  // namespace

DeclaredFeatures::DeclaredFeatures(Scene scene, std::shared_ptr<const DeclaresFeatures> of,
                                   const std::string& path)
    : FeatureSource(std::move(scene)), of_(std::move(of)) {
  if (!of_) return;
  internal::CallHook(*of_, "signals", [&] {
    FeatureSchema schema;   // its checks
    EpisodeSchema columns;  // and those of the columns that an episode will have
    for (Feature feature : of_->signals()) {
      RequireSignal(feature);
      const std::string why = internal::WhyNoFrame(this->scene(), feature.column.frame);
      if (!why.empty())
        throw ArgumentError(fmt::format("signal '{}': {}", feature.column.name, why));
      schema.Add(feature);
      feature.column.name = path + "/" + feature.column.name;
      columns.AddColumn(feature.column);
      if (feature.source.empty()) feature.source = path;
      Add(std::move(feature));
    }
  });
}

void DeclaredFeatures::ReadNumbers(std::span<double> out) {
  if (out.empty()) return;
  internal::CallHook(*of_, "observe", [&] { of_->Observe(scene().outer(), out); });
}

std::string DeclaredFeatures::PlaceOf(size_t /*feature*/) const {
  return of_->PlaceOfHook("observe");
}

}  // namespace robocell
