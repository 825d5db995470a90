// Resolves the files that a model refers to: meshes, height fields, skins, textures.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <filesystem>

#include "robocell/base/files.h"
#include "robocell/base/real_file.h"
#include "robocell/base/suggestions.h"
#include "robocell/scene/part.h"
#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

// A missing file.
struct MissingPath {
  std::string element;  // "mesh 'link1'"
  std::string written;  // text in the model
  std::string line;     // "line 12", may be empty
  fs::path path;        // searched path
};

class AssetPaths {
 public:
  explicit AssetPaths(mjSpec* spec) {
    for (mjsElement* e : SpecElements(spec, mjOBJ_MESH))
      Visit(e, "mesh", *mjs_asMesh(e), mjs_getCompiler(e)->meshdir);
    for (mjsElement* e : SpecElements(spec, mjOBJ_HFIELD))
      Visit(e, "height field", *mjs_asHField(e), mjs_getCompiler(e)->meshdir);
    for (mjsElement* e : SpecElements(spec, mjOBJ_SKIN))
      Visit(e, "skin", *mjs_asSkin(e), mjs_getCompiler(e)->meshdir);
    for (mjsElement* e : SpecElements(spec, mjOBJ_TEXTURE))
      Visit(e, "texture", *mjs_asTexture(e), mjs_getCompiler(e)->texturedir);
  }

  const std::vector<MissingPath>& missing() const { return missing_; }

 private:
  // Makes the path of the element's file absolute, or records that it does not exist.
  template <class Asset>
  void Visit(mjsElement* element, const char* kind, Asset& asset, const mjString* asset_folder) {
    const std::string name = mjs_getString(asset.file);
    if (name.empty() || name.find(':') != std::string::npos) return;  // a plugin's resource
    const mjSpec* origin = mjs_getOriginSpec(element);
    const fs::path written = origin->strippath ? fs::path(name).filename() : fs::path(name);
    const fs::path model_folder = mjs_getString(origin->modelfiledir);
    const fs::path full = model_folder / mjs_getString(asset_folder) /
                          written;  // an absolute part replaces the preceding one
    std::error_code error;
    const fs::path absolute = fs::absolute(full, error).lexically_normal();
    if (fs::is_regular_file(full, error)) return void(mjs_setString(asset.file, absolute.c_str()));
    const std::string own = SpecName(element);
    missing_.push_back({own.empty() ? kind : fmt::format("{} '{}'", kind, own), name,
                        mjs_getString(asset.info), absolute});
  }

  std::vector<MissingPath> missing_;
};

std::string InFolder(const MissingPath& file) {
  std::error_code error;
  const fs::path folder = file.path.parent_path();
  if (!fs::is_directory(folder, error))
    return fmt::format("there is no folder {}", folder.string());
  if (fs::exists(file.path, error))
    return fmt::format("{} is {}", file.path.string(), WhatIsAt(file.path));
  const std::string near = DidYouMean(file.path.filename().string(), FolderNamesIfAny(folder));
  return fmt::format("there is no {}{}{}", file.path.string(), near.empty() ? "" : ".", near);
}

std::string Sentence(const std::string& text) { return text.ends_with('?') ? text : text + "."; }

std::string Text(const std::string& model, const std::vector<MissingPath>& missing) {
  const MissingPath& first = missing.front();
  const std::string line = first.line.empty() ? "" : ", " + first.line;
  std::string text = fmt::format("{} refers to the file '{}' ({}{}), but {}", model, first.written,
                                 first.element, line, InFolder(first));
  text = Sentence(text);
  if (missing.size() > 1) {
    std::vector<std::string> others;
    for (size_t i = 1; i < missing.size(); ++i) others.push_back(missing[i].written);
    text += " Also missing: " + ListNames(others, 4) + ".";
  }
  return text +
         " Get the model with all its files, or correct `file`, `meshdir` or `texturedir` in it";
}

}  // namespace

bool MakeAssetPathsAbsolute(mjSpec* spec, const std::string& file, const std::string& place,
                            const std::string& field, CompileLog& log) {
  const AssetPaths paths(spec);
  if (paths.missing().empty()) return true;
  log.Missing(place, Text(file, paths.missing()), field);
  return false;
}

}  // namespace robocell::internal
