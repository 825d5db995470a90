#include "robocell/render/mjv_scene.h"

#include <algorithm>
#include <cstring>

#include "robocell/mujoco/guard.h"

namespace robocell::internal {
namespace {

void Copy(const Eigen::Vector3d& from, float to[3]) {
  for (int i = 0; i < 3; ++i) to[i] = static_cast<float>(from[i]);
}

mjvGLCamera ToGl(const CameraModel& camera) {
  mjvGLCamera out = {};
  const Eigen::Matrix3d axes = camera.camera_in_world.rotation();
  Copy(camera.camera_in_world.translation(), out.pos);
  Copy(-axes.col(2), out.forward);
  Copy(axes.col(1), out.up);
  // Edges of the image: half a pixel beyond the centres of the outermost pixels.
  const double scale = camera.orthographic ? 1 : camera.near_m;
  const double left = -(camera.cx + 0.5) / camera.fx,
               right = (camera.width - 0.5 - camera.cx) / camera.fx;
  const double top = (camera.cy + 0.5) / camera.fy,
               bottom = -(camera.height - 0.5 - camera.cy) / camera.fy;
  out.frustum_center = static_cast<float>(0.5 * (left + right) * scale);
  out.frustum_width =
      static_cast<float>(0.5 * (right - left) * scale);  // the engine takes it as half the width
  out.frustum_top = static_cast<float>(top * scale);
  out.frustum_bottom = static_cast<float>(bottom * scale);
  out.frustum_near = static_cast<float>(camera.near_m);
  out.frustum_far = static_cast<float>(camera.far_m);
  out.orthographic = camera.orthographic;
  return out;
}

int GeomCapacity(const mjModel* m) {
  const mjtSize shown = m->ngeom + m->nsite + m->nskin + m->nflex + m->nwrap;
  return static_cast<int>(std::max<mjtSize>(1000, 2 * shown + 500));
}

int GeomType(Marker::Shape shape) {
  switch (shape) {
    case Marker::kSphere:
      return mjGEOM_SPHERE;
    case Marker::kBox:
      return mjGEOM_BOX;
    case Marker::kCylinder:
      return mjGEOM_CYLINDER;
    case Marker::kArrow:
      return mjGEOM_ARROW;
    case Marker::kText:
      return mjGEOM_LABEL;
  }
  return mjGEOM_NONE;
}

// The engine's conventions: a round shape repeats its radius, and an arrow is drawn half as long as
// its third size.
void EngineSize(const Marker& marker, mjtNum size[3]) {
  const auto& s = marker.size;
  const bool box = marker.shape == Marker::kBox, sphere = marker.shape == Marker::kSphere;
  const bool arrow = marker.shape == Marker::kArrow;
  size[0] = s[0];
  size[1] = box ? s[1] : s[0];
  size[2] = box ? s[2] : sphere ? s[0] : arrow ? 2 * s[1] : s[1];
}

}  // namespace

MjvScene::MjvScene(const mjModel* model, int more) {
  mjv_defaultScene(&scene_);
  const int capacity = GeomCapacity(model) + more;
  Guarded("preparing to render", [&] { mjv_makeScene(model, &scene_, capacity); });
}

void MjvScene::SetCamera(const CameraModel& camera) {
  scene_.camera[0] = scene_.camera[1] = ToGl(camera);
}

void MjvScene::Add(const Marker& marker) {
  if (scene_.ngeom >= scene_.maxgeom) return;
  mjvGeom* geom = scene_.geoms + scene_.ngeom++;
  mjtNum size[3], position[3], rotation[9];
  EngineSize(marker, size);
  const Eigen::Matrix3d axes = marker.pose.rotation();
  for (int i = 0; i < 3; ++i) position[i] = marker.pose.translation()[i];
  for (int i = 0; i < 9; ++i) rotation[i] = axes(i / 3, i % 3);
  mjv_initGeom(geom, GeomType(marker.shape), size, position, rotation, marker.rgba.data());
  geom->castshadow = 0;
  std::memcpy(geom->label, marker.text.data(), marker.text.size());
}

void MjvScene::LetPlanesCastNoShadow() {
  for (int i = 0; i < scene_.ngeom; ++i) {
    if (scene_.geoms[i].type == mjGEOM_PLANE) scene_.geoms[i].castshadow = 0;
  }
}

}  // namespace robocell::internal
