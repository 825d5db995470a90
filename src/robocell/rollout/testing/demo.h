// For tests only: the run of `make demo`.
#pragma once

#include "robocell/spec/run_config.h"
#include "robocell/testing/source_dir.h"

namespace robocell {

// Returns the demo run without file positions, as if it were made in code.
inline RunConfig Demo() {
  RunConfig run = RunConfig::Load(SourceDir() + "/examples/demo.yaml");
  run.locations = {};
  return run;
}

}  // namespace robocell
