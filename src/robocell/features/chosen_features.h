// ChosenFeatures: selected features of a cell, by name, in the order of selection: what an
// environment observes beside its robots, objects and task.
//
//   ChosenFeatures chosen(scene, robots, {"tcp_height", "robots/*/sensors/*"});
//   chosen.keys();      // "tcp_height", "robots/left/sensors/touch"
//   chosen.Read(out);   // their numbers
//
// A registered feature (own_features.h) is selected by its name; all others have the names that
// they have in datasets, with "*" for any part. Other features are not read; reading allocates
// nothing. Throws NotFoundError with the nearest names, and the errors of the sources.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robocell/features/feature_source.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

class ChosenFeatures final : public FeatureSource {
 public:
  ChosenFeatures(const Scene& scene, const std::vector<Robot>& robots,
                 const std::vector<std::string>& names);
  // Returns how each was selected: a registered feature without "features/", all others by their
  // names.
  const std::vector<std::string>& keys() const { return keys_; }

 private:
  // Numbers of a source.
  struct Part {
    size_t source, begin, size;
  };
  void ReadNumbers(std::span<double> out) override;
  void Choose(const std::string& name, const std::vector<std::unique_ptr<FeatureSource>>& all);
  void AddPart(size_t source, size_t begin, const Feature& feature);

  std::vector<std::unique_ptr<FeatureSource>> sources_;
  std::vector<std::vector<double>> numbers_;  // numbers of each source
  std::vector<Part> parts_;                   // position of each feature
  std::vector<std::string> keys_;
};

// Returns the names that are registered features.
std::vector<std::string> OwnAmong(const std::vector<std::string>& names);

}  // namespace robocell::internal
