// The content of a drawing: a copy of the poses, the engine's list of visible elements, and the
// body of each element. All back ends share it, so that they show the same. Internal to render/.
//
//   DrawnScene drawn({.visibility = options.visibility, .keep_unseen = quality.shadows});
//   drawn.SetModel(model);                                 // again after every compile
//   const CameraModel camera = drawn.Update(data, request);
//   mjvScene* scene = drawn.scene();
//
// Throws ArgumentError for data of another model, for a freed model and before SetModel, and
// EngineError. Threads: one at a time, any. No allocation of ours after SetModel.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "robocell/mujoco/model_watch.h"
#include "robocell/mujoco/owners.h"
#include "robocell/render/camera_model.h"
#include "robocell/render/mjv_scene.h"
#include "robocell/render/pedestal_feet.h"
#include "robocell/render/renderer.h"
#include "robocell/render/view_cull.h"

namespace robocell::internal {

// Returns true if anything can be visible.
bool ShowsAnything(const Visibility& visibility);

class DrawnScene {
 public:
  struct Options {
    Visibility visibility = {};
    bool keep_unseen = false;  // shadows and reflections need elements out of view
  };
  explicit DrawnScene(const Options& options);

  void SetModel(const mjModel* model);
  // Forgets the model and the last drawing.
  void Clear();

  // Updates the list to the state in `data`, seen through the request's camera. It does not include
  // markers.
  CameraModel Update(const mjData* data, const RenderRequest& request);

  const mjModel* model() const { return model_; }
  // Returns true if textures of the model changed since SetModel: what was uploaded is old.
  bool has_old_textures() const { return model_ && watch_.textures() != textures_; }
  // Says that all textures were uploaded again.
  void TookTextures() { textures_ = watch_.textures(); }
  mjvScene* scene() { return scene_->get(); }
  // Adds markers to the list; Update removes them again.
  void Add(std::span<const Marker> markers);
  // Returns the body of each segmentation id of the list, including elements out of view; -1 for
  // elements without a body.
  std::span<const int32_t> BodyOfId();

 private:
  void RequireFits(const mjData* data) const;
  void UpdatePoses(const mjModel& view, const mjData* data);
  void UpdateList(const mjModel& view, const CameraModel& camera);

  Options options_;
  mjvOption visible_;
  const mjModel* model_ = nullptr;
  ModelWatch watch_;        // watch of the caller's model
  uint64_t textures_ = 0;   // ModelWatch::textures at SetModel
  uint64_t signature_ = 0;  // the model's, which its data have too
  DataPtr scratch_;         // poses for drawing
  std::unique_ptr<MjvScene> scene_;
  ViewCull cull_;
  PedestalFeet feet_;
  int ids_ = 0;  // segmentation ids of the present list, also of elements out of view
  std::vector<int32_t> body_of_id_;
};

}  // namespace robocell::internal
