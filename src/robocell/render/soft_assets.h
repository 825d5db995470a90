// The assets of a model for the software renderer: meshes, planes, height fields, textures.
// Internal to render/.
#pragma once

#include <mujoco/mujoco.h>

#include <vector>

#include "robocell/render/renderer.h"
#include "robocell/render/soft_mesh.h"
#include "robocell/render/soft_shapes.h"
#include "robocell/render/soft_texture.h"

namespace robocell::internal {

class SoftAssets {
 public:
  SoftAssets() = default;
  // Takes the meshes that can be visible, and all textures.
  SoftAssets(const mjModel* model, const Visibility& visibility);

  // Takes the textures that changed since, and the materials. Meshes stay, and so do the addresses of
  // textures.
  void TakeChanges(const mjModel* model);

  const SoftShapes& shapes() const { return shapes_; }
  // Returns the mesh by mjvGeom::dataid. Null for a missing one.
  const SoftMesh* Mesh(int data) const;
  const SoftMesh* Plane(int data) const;
  const SoftMesh* HeightField(int data) const;
  // Returns the texture of the geom; null if it has none.
  const SoftTexture* TextureOf(const mjvGeom& geom) const;
  const SoftTexture* Sky() const;
  // Returns true if the texture of the geom is sized in metres, and its repetitions.
  bool TextureIsUniform(const mjvGeom& geom) const;
  void TextureRepeat(const mjvGeom& geom, float repeat[2]) const;

 private:
  struct Material {
    int texture = -1;
    bool uniform = false;
    float repeat[2] = {1, 1};
  };

  void TakeMaterials(const mjModel* model);

  SoftShapes shapes_;
  std::vector<SoftMesh> meshes_, planes_, fields_;
  std::vector<SoftTexture> textures_;
  std::vector<mjtByte> texels_;  // of the model, when the textures were taken
  std::vector<Material> materials_;
};

}  // namespace robocell::internal
