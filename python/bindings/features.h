// A feature schema in Python.
#pragma once

#include <nanobind/nanobind.h>

#include <map>
#include <string>
#include <vector>

#include "robocell/data/feature_schema.h"

namespace robocell::python {

// {name: numbers}, as actions are given.
std::map<std::string, std::vector<double>> ToNumbersByName(const nanobind::dict& values);
// Numbers of any shape, a single one too, in a row. What are no numbers stays what it is.
nanobind::object Ravel(nanobind::handle value);
// A list of Feature objects.
nanobind::list FeatureList(const FeatureSchema& schema);

}  // namespace robocell::python
