// Reads the file references of one XML file of a model, with the engine's own parser (tinyxml2).
// Internal to assets/; model_files.h looks for the files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace robocell::assets {

enum class NameKind { kAsset, kInclude, kModel };

struct FileName {
  NameKind kind = NameKind::kAsset;
  std::string name;  // with `/` between folders; the engine takes `\` for the same
};

struct ModelText {
  std::string problem;  // why it is no XML; "" when it is
  std::vector<FileName> names;
  std::vector<std::string> folders;  // of assets: meshdir, texturedir, assetdir
  bool strips_paths = false;         // assets are named without their folders
};

ModelText ReadModelText(std::string_view xml);

}  // namespace robocell::assets
