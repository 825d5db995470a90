// The engine's list of visible elements, in the form of the software renderer's kernels. Internal
// to render/.
//
//   SoftScene scene;
//   scene.SetModel(model, visibility);
//   scene.Update(model, list, bodies, camera, {.shadows = true});
//
// No allocation once the largest list has been taken.
#pragma once

#include <mujoco/mujoco.h>

#include <cstdint>
#include <span>
#include <vector>

#include "robocell/render/camera_model.h"
#include "robocell/render/soft_assets.h"
#include "robocell/render/soft_frame.h"
#include "robocell/render/soft_shadows.h"
#include "robocell/render/soft_threads.h"

namespace robocell::internal {

class SoftScene {
 public:
  void SetModel(const mjModel* model, const Visibility& visibility);
  // Takes textures and materials of the same model again.
  void TakeTextures(const mjModel* model) { assets_.TakeChanges(model); }

  struct Effects {
    bool sky = true;
    bool shadows = false, reflections = false;
    int shadow_size = 1024;
  };
  // `bodies`: those of the list's segmentation ids.
  void Update(const mjModel* model, const mjvScene& list, std::span<const int32_t> bodies,
              const CameraModel& camera, const Effects& effects);
  // Call it before colours are computed.
  void DrawShadows(SoftThreads* threads);
  // Adds the elements of the list from `first` on, in colour only.
  void AddMarkers(const mjModel* model, const mjvScene& list, int first);

  const SoftView& view() const { return view_; }
  // Returns the picture of the present instances; valid until the next call.
  SoftPicture Picture() const;
  // Draws the reflection in the scene's one mirror into `reflection`. Returns false if there is
  // none in view.
  bool DrawReflection(SoftThreads* threads, SoftReflection* reflection);
  std::span<const SoftInstance> instances() const { return now_.instances; }
  std::span<const SoftLight> lights() const { return now_.lights; }
  // Returns true if the mesh has another shape in each picture, as those of skins and flexes.
  bool Bends(const SoftMesh* mesh) const {
    return !own_.empty() && mesh >= own_.data() && mesh < own_.data() + own_.size();
  }
  const SoftSky& sky() const { return sky_; }
  bool has_mirror() const { return mirror_.in_view; }
  // Returns indices of instances: opaque ones, and groups of transparent ones, the nearest first. A
  // group is one element of the list.
  std::span<const int> opaque() const { return now_.opaque; }
  struct Layer {
    int first = 0, end = 0;  // instances
    float alpha = 1;
    float distance = 0;
  };
  std::span<const Layer> layers() const { return now_.layers; }

 private:
  void SetCamera(const CameraModel& camera);
  void SetLights(const mjvScene& list);
  // Puts what the lights do to its material into the last instance.
  void AddGains();
  void SetSky(const mjModel* model, const mjvScene& list, const CameraModel& camera);
  void AddElement(const mjModel* model, const mjvScene& list, const mjvGeom& geom, int body);
  void AddShapes(const mjvGeom& geom, const SoftMaterial& material, bool behind);
  void AddMesh(const SoftMesh* mesh, const Eigen::Affine3d& in_world, const SoftMaterial& material,
               SoftSide side = SoftSide::kFront);
  void AddSkin(const mjModel* model, const mjvScene& list, const mjvGeom& geom,
               const SoftMaterial& material);
  void AddFlex(const mjvScene& list, const mjvGeom& geom, const SoftMaterial& material);
  SoftMaterial MaterialOf(const mjvGeom& geom, bool behind) const;
  SoftMesh* NextOwnMesh();

  // The elements drawn in one picture.
  struct Elements {
    std::vector<SoftInstance> instances;
    std::vector<int32_t> instance_of_run;
    std::vector<int> opaque;
    std::vector<Layer> layers;
    std::vector<SoftLight> lights;
    std::vector<SoftGain> gains;  // gains of each instance, light after light

    void Clear();
  };
  // A flat face that reflects: a plane, or the upper face of a box.
  struct Mirror {
    int geom = -1;  // index in the list
    Eigen::Vector3d point = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::UnitZ();  // world
    float reflectance = 0;
    uint32_t first_id = 0;
    bool in_view = false;
  };
  void FindMirror(const mjvScene& list);
  void AddMirrored(const mjModel* model, const mjvScene& list);
  SoftPicture PictureOf(const Elements& elements) const;

  SoftAssets assets_;
  SoftView view_;
  Eigen::Affine3d to_camera_;
  Eigen::Vector3d eye_;
  Elements now_;       // those in construction, else those of the camera
  Elements mirrored_;  // those of the mirror
  Mirror mirror_;
  bool mirroring_ = false;
  float ambient_ = 0;
  SoftSky sky_;
  SoftShadows shadows_;
  bool with_shadows_ = false;
  bool casts_ = false, bends_ = false;  // flags of the element being added
  int body_ = -1;                       // body of the element being added
  // Meshes that change with the state: of skins and flexes.
  std::vector<SoftMesh> own_;
  size_t own_used_ = 0;
  SoftMeshBuilder builder_;
};

}  // namespace robocell::internal
