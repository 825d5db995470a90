// DeclaresFeatures: an interface for adding features to a cell, as tasks do. DeclaredFeatures: the
// source that reads them, the same in environments and runs.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/hook_error.h"
#include "robocell/features/feature_source.h"
#include "robocell/scene/scene.h"

namespace robocell {

class DeclaresFeatures : public Hooks {
 public:
  // Returns the features that it adds to the observation: name, shape, unit, frame, names and range
  // of each, float64; privileged or not. Called once.
  virtual std::vector<Feature> signals() const { return {}; }
  // Writes the numbers of all signals, one after another, into `out`.
  virtual void Observe(const Scene& /*scene*/, std::span<double> /*out*/) const {}
};

// Returns a pointer without ownership, for readers of a source that its owner keeps longer.
template <class Source>
std::shared_ptr<const Source> Lent(const std::shared_ptr<Source>& owner) {
  return {std::shared_ptr<void>(), owner.get()};
}

class DeclaredFeatures final : public FeatureSource {
 public:
  // Full names are `path` + "/" + the declared ones. With a null `of` there are none. Throws
  // HookError for invalid features.
  DeclaredFeatures(Scene scene, std::shared_ptr<const DeclaresFeatures> of,
                   const std::string& path);

 private:
  void ReadNumbers(std::span<double> out) override;
  bool is_users() const override { return true; }
  std::string PlaceOf(size_t feature) const override;

  std::shared_ptr<const DeclaresFeatures> of_;
};

}  // namespace robocell
