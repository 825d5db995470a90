// Leaves elements out of a picture that its camera cannot see: OpenGL would clip them after
// transforming and lighting every corner. A mesh of a real arm has thousands, and the camera at its
// wrist sees few of them.
//
//   const ViewCull cull(model);
//   mjv_updateScene(...);
//   cull.DropUnseen(camera, scene);          // after every update
//
// Only for pictures without shadows and reflections, which show elements outside of the view.
// Sites, skins, planes and height fields stay. No allocation after the constructor, any thread.
#pragma once

#include <mujoco/mujoco.h>

#include <vector>
#include <Eigen/Core>

#include "robocell/render/camera_model.h"

namespace robocell::internal {

class ViewCull {
 public:
  ViewCull() = default;
  // Takes the sizes of the model's meshes; those of other shapes are the drawn sizes.
  explicit ViewCull(const mjModel* model);

  // Removes the geoms that are wholly outside of the image or of the clip planes. The others keep
  // their order and their ids.
  void DropUnseen(const CameraModel& camera, mjvScene* scene) const;

 private:
  // A box in the axes of its geom.
  struct Box {
    Eigen::Vector3d centre, half;
  };

  static Box MeshBox(const mjModel* model, int mesh);
  bool MayBeSeen(const CameraModel& camera, const mjvGeom& geom) const;
  // Returns true if `box` was set: infinite shapes have none.
  bool BoxOf(const mjvGeom& geom, Box& box) const;

  std::vector<Box> meshes_;
};

}  // namespace robocell::internal
