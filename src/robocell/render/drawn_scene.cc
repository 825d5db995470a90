#include "robocell/render/drawn_scene.h"

#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/mujoco/guard.h"

namespace robocell::internal {
namespace {

mjvOption ToOption(const Visibility& visibility) {
  mjvOption option;
  mjv_defaultOption(&option);
  for (int i = 0; i < mjNGROUP; ++i) option.geomgroup[i] = visibility.geom_groups[i];
  if (!visibility.sites) std::fill_n(option.sitegroup, mjNGROUP, mjtByte{0});
  if (!ShowsAnything(visibility)) {
    std::fill_n(option.skingroup, mjNGROUP, mjtByte{0});
    std::fill_n(option.flexgroup, mjNGROUP, mjtByte{0});
  }
  option.flags[mjVIS_RANGEFINDER] = 0;  // drawn rays do not count
  return option;
}

// Returns the body that a drawn element belongs to, -1 for none.
int BodyOf(const mjModel* model, const mjvGeom& geom) {
  if (geom.objtype == mjOBJ_GEOM) return model->geom_bodyid[geom.objid];
  if (geom.objtype == mjOBJ_SITE) return model->site_bodyid[geom.objid];
  return -1;
}

}  // namespace

bool ShowsAnything(const Visibility& visibility) {
  const auto& groups = visibility.geom_groups;
  return visibility.sites || visibility.skybox ||
         std::find(groups.begin(), groups.end(), true) != groups.end();
}

DrawnScene::DrawnScene(const Options& options)
    : options_(options), visible_(ToOption(options.visibility)) {}

void DrawnScene::Clear() { model_ = nullptr; }

void DrawnScene::SetModel(const mjModel* model) {
  model_ = nullptr;
  scratch_ = MakeData(model);
  scene_ = std::make_unique<MjvScene>(model);
  cull_ = ViewCull(model);
  feet_ = PedestalFeet(model);
  watch_ = ModelWatch(model);
  textures_ = watch_.textures();
  signature_ = model->signature;
  body_of_id_.reserve(static_cast<size_t>(scene_->get()->maxgeom));
  model_ = model;
}

CameraModel DrawnScene::Update(const mjData* data, const RenderRequest& request) {
  RequireFits(data);
  mjModel view = *model_;  // shallow; the engine does not update bodies that sleep, which in the
                           // scratch data are stale
  view.opt.enableflags &= ~mjENBL_SLEEP;
  UpdatePoses(view, data);
  CameraModel camera =
      ComputeCamera(model_, scratch_.get(), request.camera, request.width, request.height);
  UpdateList(view, camera);
  return camera;
}

void DrawnScene::Add(std::span<const Marker> markers) {
  for (const Marker& marker : markers) scene_->Add(marker);
}

// Reads nothing of the model before it is certain that the model was not freed.
void DrawnScene::RequireFits(const mjData* data) const {
  if (!model_) throw ArgumentError("renderer: no model; call SetModel before Render");
  if (watch_.gone()) {
    throw ArgumentError(
        "renderer: the model that it was given was freed; call SetModel after a scene was built "
        "again, or draw with a SceneRenderer");
  }
  if (data->signature != signature_) {
    throw ArgumentError(
        "renderer: the data belong to another model; call SetModel after a scene was built again");
  }
}

void DrawnScene::UpdatePoses(const mjModel& view, const mjData* data) {
  mju_copy(scratch_->qpos, data->qpos, static_cast<int>(model_->nq));
  mju_copy(scratch_->mocap_pos, data->mocap_pos, static_cast<int>(3 * model_->nmocap));
  mju_copy(scratch_->mocap_quat, data->mocap_quat, static_cast<int>(4 * model_->nmocap));
  scratch_->time = data->time;
  Guarded("computing poses for an image", scratch_.get(),
          [&] { mj_fwdKinematics(&view, scratch_.get()); });
}

void DrawnScene::UpdateList(const mjModel& view, const CameraModel& camera) {
  mjvScene* scene = scene_->get();
  scene_->SetCamera(camera);
  mjvCamera user;
  mjv_defaultCamera(&user);
  user.type = mjCAMERA_USER;  // keeps the camera set above
  Guarded("preparing an image", scratch_.get(), [&] {
    mjv_updateScene(&view, scratch_.get(), &visible_, nullptr, &user, mjCAT_STATIC | mjCAT_DYNAMIC,
                    scene);
  });
  scene_->LetPlanesCastNoShadow();
  Guarded("preparing an image", scratch_.get(),
          [&] { feet_.ReachDown(&view, scratch_.get(), visible_, scene); });
  ids_ = scene->ngeom;
  if (!options_.keep_unseen) cull_.DropUnseen(camera, scene);
}

std::span<const int32_t> DrawnScene::BodyOfId() {
  body_of_id_.assign(static_cast<size_t>(ids_), -1);
  const mjvScene* scene = scene_->get();
  for (int i = 0; i < scene->ngeom; ++i) {
    const mjvGeom& geom = scene->geoms[i];
    if (geom.segid >= 0 && geom.segid < ids_) body_of_id_[geom.segid] = BodyOf(model_, geom);
  }
  return body_of_id_;
}

}  // namespace robocell::internal
