#include "robocell/mujoco/clip_planes.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"

namespace robocell::internal {
namespace {

void RequireOrder(double near_m, double far_m) {
  if (!(near_m > 0 && near_m < far_m)) {
    throw ArgumentError(fmt::format(
        "clip planes: 0 < near < far is needed, got near {:g} m, far {:g} m", near_m, far_m));
  }
}

void Set(mjVisual& visual, double extent, double near_m, double far_m) {
  visual.map.znear = static_cast<float>(near_m / extent);
  visual.map.zfar = static_cast<float>(far_m / extent);
}

}  // namespace

ClipPlanes GetClipPlanes(const mjModel* model) {
  return {model->vis.map.znear * model->stat.extent, model->vis.map.zfar * model->stat.extent};
}

void SetClipPlanes(mjModel* model, double near_m, double far_m) {
  RequireOrder(near_m, far_m);
  Set(model->vis, model->stat.extent, near_m, far_m);
}

void SetClipPlanes(mjSpec* spec, double extent_m, double near_m, double far_m) {
  RequireOrder(near_m, far_m);
  if (!(extent_m > 0))
    throw ArgumentError(fmt::format("clip planes: extent must be > 0, got {:g} m", extent_m));
  spec->stat.extent = extent_m;
  Set(spec->visual, extent_m, near_m, far_m);
}

}  // namespace robocell::internal
