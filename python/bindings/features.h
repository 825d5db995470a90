// A feature schema in Python.
#pragma once

#include <nanobind/nanobind.h>

#include <map>
#include <string>
#include <vector>

#include "robocell/data/feature_schema.h"

namespace robocell::python {

// Converts {name: numbers}, the form of actions.
std::map<std::string, std::vector<double>> ToNumbersByName(const nanobind::dict& values);
// Flattens numbers of any shape, including a single one. Returns other values unchanged.
nanobind::object Ravel(nanobind::handle value);
// A list of Feature objects.
nanobind::list FeatureList(const FeatureSchema& schema);

}  // namespace robocell::python
