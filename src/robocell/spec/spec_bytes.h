// Converts a spec to bytes for comparing specs: two specs have the same bytes if all their fields
// are equal, and different ones otherwise. This is many times faster than YAML. Nothing reads the
// bytes back, and another version of robocell may write others.
//
//   const std::string key = Fingerprint(SpecBytes(scene_spec));
#pragma once

#include <string>

namespace robocell {
struct SceneSpec;
}

namespace robocell::internal {

std::string SpecBytes(const SceneSpec& spec);

}  // namespace robocell::internal
