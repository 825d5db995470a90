// A feature schema in Python.
#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "values.h"
#include "robocell/data/feature_schema.h"
#include "robocell/features/cell_images.h"

namespace robocell::python {

// Returns true for {"robots/left/action/arm": numbers}, an action by the names of columns in
// datasets. Throws ArgumentError if a robot's name is beside such names: an action has one form.
bool IsByName(nanobind::handle action);
// Returns {name: numbers or image} as a dict whose error for another name has the nearest one.
nanobind::object NamedRow(const nanobind::dict& row);
// Converts {name: numbers}, the form of actions.
std::map<std::string, std::vector<double>> ToNumbersByName(const nanobind::dict& values);
// Flattens numbers of any shape, including a single one. Returns other values unchanged.
nanobind::object Ravel(nanobind::handle value);
// Writes the numbers of a value into `out`, which has those of `shape`; True and False are 1 and 0.
// A single number may be a row of one. Throws ArgumentError with both shapes for another one.
void PutValues(nanobind::handle value, const std::vector<int64_t>& shape, const FieldPath& path,
               std::span<double> out);
// Returns the numbers of features, one after another, as arrays by their names.
nanobind::dict ToArrays(const FeatureSchema& schema, std::span<const double> numbers);
// Adds an image of a cell: {name, name + ".depth", name + ".segmentation": array}.
void PutImage(nanobind::dict& arrays, const CellImage& image);
// A list of Feature objects.
nanobind::list FeatureList(const FeatureSchema& schema);

}  // namespace robocell::python
