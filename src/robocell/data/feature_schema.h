// FeatureSchema: the observations and commands of a cell, feature by feature: plain data that an
// episode stores. Spaces of environments, columns and inputs of policies are views of it.
//
//   FeatureSchema schema = FeatureSchema::FromJson(episode.features_json());
//   const Feature& qpos = schema.Find("robots/rc7/arm/qpos");   // its unit, frame, names, range
//   if (auto why = schema.DifferenceFrom(other); !why.empty()) ...
//
// Its order is that of the numbers of a flat observation. Throws ArgumentError for a feature that
// is declared twice or whose ranges do not fit its shape, NotFoundError with the nearest names, and
// SpecError, with the feature and the field, for JSON that is not a schema.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/data/column.h"

namespace robocell {

enum class FeatureRole {
  kObservation,  // a robot's sensors and the cell's clock: also available outside of simulation
  kPrivileged,   // available in simulation only: poses of objects
  kAction,       // the commands
  kLabel,        // known about a row afterwards: reward, success, phase
};
std::string_view NameOf(FeatureRole role);  // "observation", "privileged", "action", "label"

// One named quantity of a cell.
struct Feature {
  ColumnSpec column;  // name, type, shape, units, frame, names, values, description
  FeatureRole role = FeatureRole::kObservation;
  // Smallest and largest value of each number, in row-major order; both empty without a range.
  std::vector<double> lower, upper;
  std::string source;  // its origin: "robot rc7", "object target", "feature of a user's own"

  int64_t size() const { return RowValues(column.shape); }
};

class FeatureSchema {
 public:
  void Add(Feature feature);
  const std::vector<Feature>& features() const { return features_; }
  bool empty() const { return features_.empty(); }
  const Feature& Find(std::string_view name) const;
  bool Has(std::string_view name) const;
  std::vector<std::string> Names(FeatureRole role) const;
  // The total number of values.
  int64_t size() const;

  // Returns an array with an object for each feature.
  std::string ToJson() const;
  // Accepts an empty array too. Rejects unknown fields, which may change the meaning of a number.
  static FeatureSchema FromJson(std::string_view text);

  // Returns "" if both have the same features, apart from their order, ranges, descriptions and
  // sources; else the first difference in words: "feature 'a' is (7) rad here and (6) rad there".
  // `here` and `there` are the words for the two.
  std::string DifferenceFrom(const FeatureSchema& other, std::string_view here = "here",
                             std::string_view there = "there") const;

 private:
  std::vector<Feature> features_;
};

}  // namespace robocell
