// A column of an episode in Python: its description, and its rows, read on demand.
#pragma once

#include "bindings.h"

#include <cstdint>
#include <optional>
#include <string>

#include "robocell/data/episode_reader.h"

namespace robocell::python {

namespace nb = nanobind;

// Belongs to an episode, which must outlive it.
struct Column {
  const Episode* episode;
  const ColumnInfo* info;
};

// Returns a range of rows as a new array; for a constant its value.
nb::object ReadRows(const Column& column, int64_t first, std::optional<int64_t> count);

}  // namespace robocell::python
