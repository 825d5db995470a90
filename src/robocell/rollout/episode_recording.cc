#include "robocell/rollout/episode_recording.h"

#include <mujoco/mujoco.h>

#include <utility>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/spec/yaml.h"

namespace robocell::internal {
namespace {

using Json = nlohmann::json;

void AddAll(FeatureSchema& all, const FeatureSchema& more) {
  for (const Feature& feature : more.features()) all.Add(feature);
}

std::vector<FeatureColumns> ColumnsOf(EpisodeSchema& schema,
                                      const std::vector<const FeatureSchema*>& features) {
  std::vector<FeatureColumns> columns;
  for (const FeatureSchema* each : features) columns.emplace_back(schema, *each);
  return columns;
}

}  // namespace

Json EpisodeMetadata(const Scene& scene, const PortableScene& portable,
                     const std::string& instruction, const EpisodeRates& rates) {
  Json meta = {{"instruction", instruction},
               {"scene_spec", ToYaml(portable.spec)},
               {"engine", EngineRecord(scene)},
               {"timestep", scene.timestep()},
               {"rates", {{"control_ms", rates.control_ms}, {"sim_ms", rates.sim_ms}}}};
  if (rates.rows) {
    meta["rates"]["policy_ms"] = (rates.rows->inverse() * 1000).value();
    meta["rates"]["policy_hz"] = {rates.rows->num, rates.rows->den};
  }
  return meta;
}

EpisodeRecording::EpisodeRecording(Scene scene, const Columns& columns)
    : scene_(std::move(scene)),
      generation_(scene_.generation()),
      observed_(schema_, columns.observed),
      commanded_(schema_, columns.commanded),
      more_(ColumnsOf(schema_, columns.more)),
      outcome_(schema_, scene_, columns.phases, columns.subtasks) {
  AddAll(features_, columns.observed);
  AddAll(features_, columns.commanded);
  for (const FeatureSchema* more : columns.more) AddAll(features_, *more);
}

void EpisodeRecording::AddCameras(std::span<const CellImage> images, const Ratio& rate,
                                  FrameTimes times) {
  cameras_.emplace(schema_, scene_, images, rate, times);
}

ColumnId EpisodeRecording::AddLabel(ColumnSpec column, const std::string& source) {
  labels_.Add({.column = column, .role = FeatureRole::kLabel, .source = source});
  return schema_.AddColumn(std::move(column));
}

void EpisodeRecording::Begin(const std::filesystem::path& dataset, const std::string& id,
                             const std::string& metadata_json, const PortableScene& portable,
                             const std::vector<ConstantSpec>& constants) {
  Describe(dataset, id, metadata_json, portable, constants);
  Open();
}

void EpisodeRecording::Describe(const std::filesystem::path& dataset, const std::string& id,
                                const std::string& metadata_json, const PortableScene& portable,
                                const std::vector<ConstantSpec>& constants) {
  const std::vector<double> state = scene_.state();
  schema_.AddConstant(
      {.name = "initial_state",
       .shape = {static_cast<int64_t>(state.size())},
       .description = "The engine's full state before the first action (mjSTATE_INTEGRATION)."},
      state);
  for (const ConstantSpec& constant : constants)
    schema_.AddConstant(constant.column, constant.values);
  FeatureSchema features = features_;
  AddAll(features, outcome_.labels());
  AddAll(features, labels_);
  dataset_ = dataset;
  id_ = id;
  options_ = {.metadata_json = metadata_json,
              .versions_json = Json{{"mujoco", mj_versionString()}}.dump(),
              .features = std::move(features)};
  portable_ = &portable;
}

void EpisodeRecording::Open() {
  writer_.reset();  // an episode has one writer at a time
  writer_.emplace(dataset_, id_, schema_, options_);
  for (const auto& [name, files] : portable_->models) writer_->AddModel(name, files);
}

void EpisodeRecording::RequireSameScene(const std::string& place,
                                        const std::string& next_step) const {
  if (scene_.generation() == generation_) return;
  throw Error(place +
              ": objects were added or removed while an episode is recorded, whose rows have "
              "numbers for those it began with; " +
              next_step);
}

void EpisodeRecording::PutState(std::span<const double> observed, int phase) {
  observed_.Put(*writer_, observed);
  outcome_.PutPhase(*writer_, phase);
}

void EpisodeRecording::PutCommands(std::span<const double> commanded) {
  commanded_.Put(*writer_, commanded);
}

void EpisodeRecording::PutMore(size_t which, std::span<const double> numbers) {
  more_[which].Put(*writer_, numbers);
}

void EpisodeRecording::PutImages(std::span<const CellImage> images, std::span<const double> times) {
  if (cameras_) cameras_->Put(*writer_, images, times);
}

}  // namespace robocell::internal
