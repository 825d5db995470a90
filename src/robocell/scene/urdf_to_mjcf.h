// Converts URDF to MJCF, as `robocell convert` and `robocell init` do.
//
//   const std::string mjcf = UrdfToMjcf("arm.urdf", "models", &notes);
//   AtomicWrite("models/arm.xml", mjcf);
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace robocell {

// Returns the MJCF of a URDF, with a position servo for each joint that nothing else moves.
// `folder` is where the text will lie: mesh files are named from there. `notes` (may be null)
// receives what was read differently than it may be meant, and the servos. Throws SpecError with
// all problems of the URDF, each with file, line and next step, and IoError if it cannot be read.
std::string UrdfToMjcf(const std::filesystem::path& file, const std::filesystem::path& folder,
                       std::vector<std::string>* notes);

}  // namespace robocell
