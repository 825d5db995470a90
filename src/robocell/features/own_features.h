// A user's own features: functions of a scene, registered by name. Cells that name them observe and
// record them like built-in ones.
//
//   RegisterFeature("tcp_height", {.column = {.units = "m", .frame = "world"}},
//                   [](const Scene& scene, std::span<double> out) { out[0] = ...; });
//
// Errors: ArgumentError for a name that is taken or no file name, or a type other than float64;
// NotFoundError lists the names; HookError for a function that fails or writes numbers that are not
// finite.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/hook_error.h"
#include "robocell/features/feature_source.h"
#include "robocell/scene/scene.h"

namespace robocell {

// Writes the numbers of the feature for the scene's present state.
using FeatureFunction = std::function<void(const Scene& scene, std::span<double> out)>;

// Describes the code of a feature's function; called when needed.
struct FeatureCode {
  std::function<std::vector<std::string>()> files =
      {};                                   // source files of the function, stored by datasets
  std::function<std::string()> place = {};  // place for messages (base/hook_error.h)
};

// Registers a feature for all threads. Its full name is "features/" + `name`.
void RegisterFeature(const std::string& name, Feature feature, FeatureFunction function,
                     bool replace = false, FeatureCode code = {});
// Returns the code files of registered features.
std::vector<std::string> CodeOfFeatures(const std::vector<std::string>& names);
// Returns all names in alphabetical order.
std::vector<std::string> OwnFeatures();
bool IsOwnFeature(const std::string& name);

class OwnFeatureSource final : public FeatureSource {
 public:
  OwnFeatureSource(Scene scene, const std::vector<std::string>& names);

 private:
  struct Function : Hooks {
    FeatureFunction read;
    FeatureCode code;
    std::string PlaceOfHook(const char* method) const override;
  };
  void ReadNumbers(std::span<double> out) override;
  bool is_users() const override { return true; }
  std::string PlaceOf(size_t feature) const override;

  std::vector<Function> functions_;
};

}  // namespace robocell
