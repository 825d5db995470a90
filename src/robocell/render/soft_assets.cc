#include "robocell/render/soft_assets.h"

#include <algorithm>
#include <cstddef>

namespace robocell::internal {
namespace {

// Returns the meshes of visible geoms.
std::vector<bool> SeenMeshes(const mjModel* m, const Visibility& visibility) {
  std::vector<bool> seen(static_cast<size_t>(m->nmesh), false);
  for (int g = 0; g < m->ngeom; ++g) {
    const int mesh = m->geom_dataid[g], type = m->geom_type[g];
    if (mesh < 0 || (type != mjGEOM_MESH && type != mjGEOM_SDF)) continue;
    const int group = std::clamp(m->geom_group[g], 0, mjNGROUP - 1);
    if (visibility.geom_groups[static_cast<size_t>(group)]) seen[static_cast<size_t>(mesh)] = true;
  }
  return seen;
}

template <class T>
const T* At(const std::vector<T>& from, int index) {
  return index >= 0 && static_cast<size_t>(index) < from.size() ? &from[static_cast<size_t>(index)]
                                                                : nullptr;
}

}  // namespace

SoftAssets::SoftAssets(const mjModel* m, const Visibility& visibility)
    : shapes_(m->vis.quality.numslices, m->vis.quality.numstacks) {
  const std::vector<bool> seen = SeenMeshes(m, visibility);
  for (int i = 0; i < m->nmesh; ++i) {
    meshes_.push_back(seen[static_cast<size_t>(i)] ? MeshOfModel(m, i) : SoftMesh{});
  }
  for (int g = 0; g < m->ngeom; ++g) {
    if (m->geom_type[g] == mjGEOM_PLANE) planes_.push_back(PlaneOfModel(m, g));
  }
  for (int i = 0; i < m->nhfield; ++i) fields_.push_back(HeightFieldOfModel(m, i));
  for (int i = 0; i < m->ntex; ++i) textures_.emplace_back(m, i);
  texels_.assign(m->tex_data, m->tex_data + m->ntexdata);
  TakeMaterials(m);
}

void SoftAssets::TakeChanges(const mjModel* m) {
  for (int i = 0; i < m->ntex; ++i) {
    const auto begin = static_cast<std::ptrdiff_t>(m->tex_adr[i]);
    const std::ptrdiff_t end = i + 1 < m->ntex ? static_cast<std::ptrdiff_t>(m->tex_adr[i + 1])
                                               : static_cast<std::ptrdiff_t>(m->ntexdata);
    if (std::equal(m->tex_data + begin, m->tex_data + end, texels_.begin() + begin)) continue;
    std::copy(m->tex_data + begin, m->tex_data + end, texels_.begin() + begin);
    textures_[static_cast<size_t>(i)] = SoftTexture(m, i);
  }
  TakeMaterials(m);
}

void SoftAssets::TakeMaterials(const mjModel* m) {
  materials_.clear();
  for (int i = 0; i < m->nmat; ++i) {
    Material& material = materials_.emplace_back();
    material.texture = m->mat_texid[i * mjNTEXROLE + mjTEXROLE_RGB];
    material.uniform = m->mat_texuniform[i] != 0;
    std::copy_n(m->mat_texrepeat + 2 * i, 2, material.repeat);
  }
}

const SoftMesh* SoftAssets::Mesh(int data) const {
  const SoftMesh* mesh = At(meshes_, data / 2);  // odd ones are convex hulls
  return data >= 0 && mesh && mesh->triangles > 0 ? mesh : nullptr;
}

const SoftMesh* SoftAssets::Plane(int data) const { return At(planes_, data); }

const SoftMesh* SoftAssets::HeightField(int data) const { return At(fields_, data); }

const SoftTexture* SoftAssets::TextureOf(const mjvGeom& geom) const {
  const Material* material = At(materials_, geom.matid);
  if (!material) return nullptr;
  const SoftTexture* texture = At(textures_, geom.texid >= 0 ? geom.texid : material->texture);
  return texture && texture->levels > 0 ? texture : nullptr;
}

const SoftTexture* SoftAssets::Sky() const {
  const auto sky = std::find_if(textures_.begin(), textures_.end(),
                                [](const SoftTexture& texture) { return texture.sky; });
  return sky == textures_.end() || sky->levels == 0 ? nullptr : &*sky;
}

bool SoftAssets::TextureIsUniform(const mjvGeom& geom) const {
  if (geom.texid >= 0) return geom.texuniform != 0;
  const Material* material = At(materials_, geom.matid);
  return material && material->uniform;
}

void SoftAssets::TextureRepeat(const mjvGeom& geom, float repeat[2]) const {
  const Material* material = At(materials_, geom.matid);
  const float* from = geom.texid >= 0 || !material ? geom.texrepeat : material->repeat;
  std::copy_n(from, 2, repeat);
}

}  // namespace robocell::internal
