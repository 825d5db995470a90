#include "robocell/features/cell_features.h"

#include <fmt/format.h>

#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/features/own_features.h"
#include "robocell/features/scene_features.h"
#include "robocell/features/sensor_features.h"

namespace robocell {

std::vector<std::unique_ptr<FeatureSource>> SourcesOfCell(const Scene& scene,
                                                          const std::vector<Robot>& robots,
                                                          const std::vector<std::string>& objects,
                                                          const std::vector<std::string>& own,
                                                          const ObjectOfName& object_of) {
  std::vector<std::unique_ptr<FeatureSource>> sources;
  sources.push_back(std::make_unique<internal::SceneFeatures>(scene, robots, objects, object_of));
  sources.push_back(std::make_unique<internal::SensorFeatures>(scene));
  for (const Robot& robot : robots) sources.push_back(std::make_unique<RobotFeatures>(robot));
  if (!own.empty()) sources.push_back(std::make_unique<OwnFeatureSource>(scene, own));
  return sources;
}

CellFeatures::CellFeatures(const Scene& scene, const std::vector<Robot>& robots,
                           CellFeatureOptions options) {
  sources_ = SourcesOfCell(scene, robots, options.objects, options.own, options.object_of);
  if (options.more) sources_.push_back(std::move(options.more));
  for (const auto& source : sources_) {
    for (const Feature& feature : source->features()) observed_.Add(feature);
  }
  for (const Robot& robot : robots) {
    actions_.emplace_back(robot);
    for (const Feature& feature : actions_.back().features()) commanded_.Add(feature);
  }
  state_.resize(static_cast<size_t>(observed_.size()));
  action_.resize(static_cast<size_t>(commanded_.size()));
}

FeatureSchema CellFeatures::schema() const {
  FeatureSchema all = observed_;
  for (const Feature& feature : commanded_.features()) all.Add(feature);
  return all;
}

std::span<const double> CellFeatures::ReadState() {
  std::span<double> rest = state_;
  for (const auto& source : sources_) {
    source->Read(rest.first(static_cast<size_t>(source->size())));
    rest = rest.subspan(static_cast<size_t>(source->size()));
  }
  for (RobotActions& actions : actions_) actions.Begin();
  return state_;
}

std::span<const double> CellFeatures::ReadActions() {
  std::span<double> rest = action_;
  for (const RobotActions& actions : actions_) {
    actions.Read(rest);
    for (const Feature& feature : actions.features())
      rest = rest.subspan(static_cast<size_t>(feature.size()));
  }
  return action_;
}

Action CellFeatures::ToAction(const std::map<std::string, std::vector<double>>& values) const {
  Action action;
  std::map<std::pair<std::string, std::string>, std::string> by_group;
  for (const auto& [name, numbers] : values) {
    commanded_.Find(name);
    for (const RobotActions& actions : actions_) {
      if (!actions.Has(name)) continue;
      auto [group, command] = actions.Command(name, numbers);
      const auto [other, is_new] = by_group.try_emplace({actions.robot(), group}, name);
      if (!is_new) {
        throw ArgumentError(fmt::format(
            "actions '{}' and '{}' both move group '{}' of robot '{}'; give one of them",
            other->second, name, group, actions.robot()));
      }
      action[actions.robot()][group] = std::move(command);
    }
  }
  return action;
}

}  // namespace robocell
