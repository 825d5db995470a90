// A spec as bytes to tell specs apart by: two specs have the same bytes when all their fields are
// equal, and different ones when a field differs. Many times quicker than their YAML; nothing reads
// them back, and another version of robocell may write other ones.
//
//   const std::string key = Fingerprint(SpecBytes(scene_spec));
#pragma once

#include <string>

namespace robocell {

struct SceneSpec;

std::string SpecBytes(const SceneSpec& spec);

}  // namespace robocell
