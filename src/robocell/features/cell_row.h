// CellRow: the record of a state before an action, which experts and policies see and which an
// episode stores as one row: numbers and images. They are valid during the call that receives them.
#pragma once

#include <span>

#include "robocell/data/feature_schema.h"
#include "robocell/features/cell_images.h"

namespace robocell {

struct CellRow {
  const FeatureSchema& observed;
  std::span<const double> numbers;  // values of `observed`, concatenated
  const CellImages& images;
};

}  // namespace robocell
