// Shadow maps of the software renderer: the nearness of the first surface to each light. A map is
// drawn again only if its light has moved, and the part of it where something that casts a shadow
// has moved; it does not depend on the camera, so that several cameras share it. Internal to
// render/.
//
//   SoftShadows shadows;
//   shadows.Begin(model, list, camera);
//   shadows.AddCaster(mesh, in_world);            // everything that casts
//   shadows.Draw(&threads);
//   const SoftShadow* shadow = shadows.Of(light);
#pragma once

#include <mujoco/mujoco.h>

#include <cstdint>
#include <vector>
#include <Eigen/Geometry>

#include "robocell/render/camera_model.h"
#include "robocell/render/soft_frame.h"
#include "robocell/render/soft_threads.h"

namespace robocell::internal {

// A rectangle of tiles: columns and rows.
struct SoftTiles {
  int begin[2] = {0, 0}, end[2] = {0, 0};

  bool empty() const { return begin[0] >= end[0] || begin[1] >= end[1]; }
  bool Meets(const SoftTiles& other) const;
  void Extend(const SoftTiles& other);
};

class SoftShadows {
 public:
  // Empties all maps, because the meshes have changed.
  void Clear();

  // Takes the lights of the list that cast shadows. `size`: side of a map in pixels.
  void Begin(const mjModel* model, const mjvScene& list, const CameraModel& camera, int size);
  // `bends`: the mesh has changed.
  void AddCaster(const SoftMesh* mesh, const Eigen::Affine3d& in_world, bool bends);
  void Draw(SoftThreads* threads);

  // Returns the shadow of a light of the list; null if it casts none.
  const SoftShadow* Of(int light) const;

 private:
  struct Caster {
    const SoftMesh* mesh = nullptr;
    bool bends = false;
    float in_world[12];
    bool operator==(const Caster& other) const;
  };
  struct Map {
    int light = -1;  // index in the present list
    SoftShadow shadow;
    SoftShadowMap map;
    Eigen::Affine3d to_light;
    // The values of the last drawing.
    bool drawn = false;
    Eigen::Affine3d drawn_to_light;
    SoftView drawn_view;
    std::vector<Caster> drawn_casters;
    std::vector<SoftInstance> instances;  // the casters as the light sees them
    std::vector<SoftTiles> tiles;         // where they may be drawn
  };

  // The caster as the light sees it.
  static SoftInstance InLight(const Caster& caster, const Map& map);
  // `is_same_light`: only casters have moved.
  void DrawMap(SoftThreads* threads, bool is_same_light, Map* map) const;

  std::vector<Map> maps_;
  int used_ = 0;
  std::vector<Caster> casters_;
};

}  // namespace robocell::internal
