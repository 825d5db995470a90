#include "robocell/rollout/state_drawer.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <utility>

#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/model_watch.h"

namespace robocell::internal {

StateDrawer::StateDrawer(const Scene& scene, CellImages& images)
    : scene_(scene), assets_(scene.compiled()), snapshots_(scene.model()), images_(images) {}

StateDrawer::~StateDrawer() {
  if (model_) ModelEnds(model_.get());
}

DrawnState StateDrawer::Take() {
  if (images_.drawn().empty()) return {};
  const mjModel* model = scene_.model();
  const mjData* data = scene_.data();
  return {.time = data->time,
          .qpos = {data->qpos, data->qpos + model->nq},
          .mocap_pos = {data->mocap_pos, data->mocap_pos + 3 * model->nmocap},
          .mocap_quat = {data->mocap_quat, data->mocap_quat + 4 * model->nmocap},
          .model = snapshots_.Take()};
}

void StateDrawer::Draw(const DrawnState& state) {
  if (!model_) model_ = std::make_unique<mjModel>();
  if (std::exchange(shown_, state.model) != state.model) {
    *model_ = state.model->model();
    model_->opt.enableflags &= ~mjENBL_SLEEP;  // bodies that sleep would keep older poses
  }
  if (!data_) data_ = MakeData(model_.get());
  data_->time = state.time;
  std::ranges::copy(state.qpos, data_->qpos);
  std::ranges::copy(state.mocap_pos, data_->mocap_pos);
  std::ranges::copy(state.mocap_quat, data_->mocap_quat);
  has_poses_ = false;
  images_.Draw(model_.get(), data_.get());
}

double StateDrawer::DrawnPosition(int address) const { return data_->qpos[address]; }

Pose StateDrawer::DrawnPose(int body) {
  if (!std::exchange(has_poses_, true)) {
    Guarded("computing the poses of a row", data_.get(),
            [&] { mj_kinematics(model_.get(), data_.get()); });
  }
  return Pose::FromWxyz(data_->xpos + 3 * body, data_->xquat + 4 * body);
}

}  // namespace robocell::internal
