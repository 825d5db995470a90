// A column of an episode as Python sees it: what is known of it, and its rows, read when asked for.
#pragma once

#include "bindings.h"

#include <cstdint>
#include <optional>
#include <string>

#include "robocell/data/episode_reader.h"

namespace robocell::python {

namespace nb = nanobind;

// Belongs to an episode, which must live as long.
struct Column {
  const Episode* episode;
  const ColumnInfo* info;
};

// A range of rows as a new array; of a constant its value.
nb::object ReadRows(const Column& column, int64_t first, std::optional<int64_t> count);

}  // namespace robocell::python
