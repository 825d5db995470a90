// The values of `randomize:` as a dictionary.
#pragma once

#include "bindings.h"
#include "robocell/spec/randomize_config.h"

namespace robocell::python {

// Returns {"light/0/intensity": 0.4, "cube/colour": [1, 0, 0.2], "table/texture": "wood"}.
nb::dict RandomizedDict(const RandomizedValues& values);

}  // namespace robocell::python
