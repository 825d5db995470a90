// CellFeatures: all features of a cell in one schema: its observed state, row by row, and the
// commands of its robots. Recorders, environments and policies read from it and name its numbers by
// it.
//
//   CellFeatures features(scene, robots, {.objects = {"target"}});
//   std::span<const double> row = features.ReadState();   // as features.observed() names them
//   scene and robots act ...
//   std::span<const double> action = features.ReadActions();
//
// The sources of numbers come in this order: scene and objects, sensors, robots, a user's own
// features, those of the task (declared_features.h). Throws the errors of the sources. Threads:
// those of the scene.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/features/feature_source.h"
#include "robocell/features/observed_object.h"
#include "robocell/features/robot_features.h"
#include "robocell/robot/action.h"

namespace robocell {

struct CellFeatureOptions {
  std::vector<std::string> objects = {};     // names of the objects whose poses are observed
  ObjectOfName object_of = {};               // the objects that these names stand for at present
  std::vector<std::string> own = {};         // registered features (own_features.h)
  std::unique_ptr<FeatureSource> more = {};  // additional sources
};

// Returns the sources of all that is observed of a cell beside its task: the scene with the poses of
// `objects`, its sensors, the robots, and registered features.
std::vector<std::unique_ptr<FeatureSource>> SourcesOfCell(const Scene& scene,
                                                          const std::vector<Robot>& robots,
                                                          const std::vector<std::string>& objects,
                                                          const std::vector<std::string>& own,
                                                          const ObjectOfName& object_of = {});

class CellFeatures {
 public:
  CellFeatures(const CellFeatures&) = delete;
  CellFeatures(CellFeatures&&) = default;
  CellFeatures(const Scene& scene, const std::vector<Robot>& robots,
               CellFeatureOptions options = {});

  const FeatureSchema& observed() const { return observed_; }
  const FeatureSchema& commanded() const { return commanded_; }
  // Returns both schemas in one.
  FeatureSchema schema() const;

  // Returns the present values of observed(), one after another; valid until the next call. The
  // next action is relative to this state.
  std::span<const double> ReadState();
  // Returns the values that were read last.
  std::span<const double> state() const { return state_; }
  // Returns the numbers of commanded(), after the action was applied.
  std::span<const double> ReadActions();

  // Converts values of action features, by name, to commands of the robots. Throws NotFoundError
  // with the nearest names, and ArgumentError for two features of one group or a wrong number of
  // values.
  Action ToAction(const std::map<std::string, std::vector<double>>& values) const;

 private:
  std::vector<std::unique_ptr<FeatureSource>> sources_;
  std::vector<RobotActions> actions_;
  FeatureSchema observed_, commanded_;
  std::vector<double> state_, action_;
};

}  // namespace robocell
