// StateDrawer: draws what a cell showed at an instant, later or on another thread. What a row of an
// episode shows is taken when the row happens, and drawn when somebody has time for it, also after
// the episode has ended: the images are the same.
//
//   StateDrawer drawer(scene, images);
//   const DrawnState state = drawer.Take();   // on the thread that owns the scene
//   drawer.Draw(state);                       // on any, one at a time
//   images.drawn();
#pragma once

#include <memory>
#include <vector>

#include "robocell/features/cell_images.h"
#include "robocell/math/pose.h"
#include "robocell/mujoco/model_snapshot.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

// All that images depend on.
struct DrawnState {
  double time = 0;
  std::vector<double> qpos, mocap_pos, mocap_quat;
  std::shared_ptr<const ModelSnapshot> model = {};
};

class StateDrawer {
 public:
  // `images` are those of the scene, and have to outlive this object.
  StateDrawer(const Scene& scene, CellImages& images);
  ~StateDrawer();
  StateDrawer(const StateDrawer&) = delete;
  StateDrawer& operator=(const StateDrawer&) = delete;

  // Returns the present state of the scene; nothing of it if there are no images.
  DrawnState Take();
  // Draws all images of a state.
  void Draw(const DrawnState& state);
  // Returns a number of qpos in the state that was drawn last.
  double DrawnPosition(int address) const;
  // Returns the pose of a body in the state that was drawn last.
  Pose DrawnPose(int body);

 private:
  Scene scene_;
  std::shared_ptr<const CompiledScene> assets_;  // meshes and textures live as long as snapshots
  ModelSnapshots snapshots_;
  CellImages& images_;
  // The drawn model: it keeps its address and takes the values of each snapshot.
  std::unique_ptr<mjModel> model_;
  std::shared_ptr<const ModelSnapshot> shown_;
  DataPtr data_;
  bool has_poses_ = false;
};

}  // namespace robocell::internal
