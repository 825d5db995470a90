#include "robocell/testing/source_dir.h"

namespace robocell {

std::string SourceDir() { return ROBOCELL_SOURCE_DIR; }

}  // namespace robocell
