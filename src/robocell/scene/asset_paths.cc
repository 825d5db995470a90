// Files that a model refers to: meshes, height fields, skins, textures.
#include <mujoco/mujoco.h>

#include <filesystem>

#include "robocell/scene/part.h"
#include "robocell/scene/spec_tree.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

// Sets `file` to its absolute path when that file exists; the engine reports the others.
void MakeAbsolute(mjsElement* element, mjString* file, const mjString* asset_folder) {
  const std::string name = mjs_getString(file);
  if (name.empty()) return;
  const mjSpec* origin = mjs_getOriginSpec(element);
  const fs::path written = origin->strippath ? fs::path(name).filename() : fs::path(name);
  const fs::path model_folder = mjs_getString(origin->modelfiledir);
  const fs::path full = model_folder / mjs_getString(asset_folder) /
                        written;  // an absolute part replaces what is before
  std::error_code error;
  if (!fs::is_regular_file(full, error)) return;
  mjs_setString(file, fs::absolute(full, error).lexically_normal().c_str());
}

}  // namespace

void MakeAssetPathsAbsolute(mjSpec* spec) {
  for (mjsElement* e : SpecElements(spec, mjOBJ_MESH))
    MakeAbsolute(e, mjs_asMesh(e)->file, mjs_getCompiler(e)->meshdir);
  for (mjsElement* e : SpecElements(spec, mjOBJ_HFIELD)) {
    MakeAbsolute(e, mjs_asHField(e)->file, mjs_getCompiler(e)->meshdir);
  }
  for (mjsElement* e : SpecElements(spec, mjOBJ_SKIN))
    MakeAbsolute(e, mjs_asSkin(e)->file, mjs_getCompiler(e)->meshdir);
  for (mjsElement* e : SpecElements(spec, mjOBJ_TEXTURE)) {
    MakeAbsolute(e, mjs_asTexture(e)->file, mjs_getCompiler(e)->texturedir);
  }
}

}  // namespace robocell
