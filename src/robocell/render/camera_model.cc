#include "robocell/render/camera_model.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <Eigen/Geometry>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"

namespace robocell {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

void SetCentre(CameraModel& camera) {
  camera.cx = 0.5 * (camera.width - 1);
  camera.cy = 0.5 * (camera.height - 1);
}

void RequireFiniteNumber(const char* what, double value) {
  if (std::isfinite(value)) return;
  throw ArgumentError(fmt::format("a camera's {} is {}; it must be finite", what, value));
}

void RequireFovy(double fovy) {
  if (fovy > 0 && fovy < 180) return;
  throw ArgumentError(
      fmt::format("a camera's fovy is {}; it must be above 0 and below 180 degrees", fovy));
}

void RequireOrbit(double distance, double azimuth, double elevation, double fovy) {
  RequireFiniteNumber("distance", distance);
  if (distance < 0)
    throw ArgumentError(
        fmt::format("a camera's distance is {}; it must be at least 0 metres", distance));
  RequireFiniteNumber("azimuth", azimuth);
  RequireFiniteNumber("elevation", elevation);
  RequireFovy(fovy);
}

// Pixels are square; the vertical extent is `fovy`: degrees, or metres for an orthographic camera.
void SetFieldOfView(CameraModel& camera, double fovy) {
  if (!camera.orthographic) {
    RequireFovy(fovy);
  } else if (!(fovy > 0 && std::isfinite(fovy))) {
    throw ArgumentError(fmt::format(
        "an orthographic camera's fovy is {}; it must be a finite number of metres above 0", fovy));
  }
  camera.fy = camera.orthographic ? camera.height / fovy
                                  : 0.5 * camera.height / std::tan(0.5 * fovy * kDegree);
  camera.fx = camera.fy;
  SetCentre(camera);
}

// A camera with a sensor has its focal lengths and principal point as lengths on the sensor. The
// engine moves the image against the principal point in both axes.
void SetSensor(CameraModel& camera, const float* size, const float* intrinsic) {
  camera.fx = intrinsic[0] / size[0] * camera.width;
  camera.fy = intrinsic[1] / size[1] * camera.height;
  SetCentre(camera);
  camera.cx -= intrinsic[2] / size[0] * camera.width;
  camera.cy -= intrinsic[3] / size[1] * camera.height;
}

void SetModelCamera(CameraModel& camera, const mjModel* model, const mjData* data, int id) {
  if (id < 0 || id >= model->ncam) {
    throw ArgumentError(
        fmt::format("camera id {}: the model has {}", id, Counted(model->ncam, "camera")));
  }
  camera.camera_in_world =
      Pose::FromTranslationAndMatrix(data->cam_xpos + 3 * id, data->cam_xmat + 9 * id);
  camera.orthographic = model->cam_projection[id] == mjPROJ_ORTHOGRAPHIC;
  if (model->cam_sensorsize[2 * id + 1] > 0) {
    SetSensor(camera, model->cam_sensorsize + 2 * id, model->cam_intrinsic + 4 * id);
  } else {
    SetFieldOfView(camera, model->cam_fovy[id]);
  }
}

OrbitCamera Around(const mjModel* model, const mjData* data, const TrackingCamera& tracking) {
  if (tracking.body < 0 || tracking.body >= model->nbody) {
    throw ArgumentError(fmt::format("a camera that tracks body id {}: the model has {} bodies",
                                    tracking.body, static_cast<int>(model->nbody)));
  }
  return {.lookat = Eigen::Vector3d(data->subtree_com + 3 * tracking.body),
          .distance = tracking.distance,
          .azimuth = tracking.azimuth,
          .elevation = tracking.elevation,
          .fovy = tracking.fovy};
}

// Returns camera axes from the directions of right and up.
Pose FromAxes(const Eigen::Vector3d& position, const Eigen::Vector3d& right,
              const Eigen::Vector3d& up) {
  Eigen::Matrix3d rotation;
  rotation << right, up, right.cross(up);
  return Pose(position, rotation);
}

}  // namespace

Pose OrbitCamera::camera_in_world() const {
  const double ca = std::cos(azimuth * kDegree), sa = std::sin(azimuth * kDegree);
  const double ce = std::cos(elevation * kDegree), se = std::sin(elevation * kDegree);
  const Eigen::Vector3d forward(ce * ca, ce * sa, se), up(-se * ca, -se * sa, ce);
  return FromAxes(lookat - distance * forward, forward.cross(up), up);
}

void RequireView(const CameraView& view) {
  if (const auto* free = std::get_if<FreeCamera>(&view)) {
    RequireFovy(free->fovy);
  } else if (const auto* orbit = std::get_if<OrbitCamera>(&view)) {
    for (const double value : orbit->lookat) RequireFiniteNumber("lookat", value);
    RequireOrbit(orbit->distance, orbit->azimuth, orbit->elevation, orbit->fovy);
  } else if (const auto* tracking = std::get_if<TrackingCamera>(&view)) {
    RequireOrbit(tracking->distance, tracking->azimuth, tracking->elevation, tracking->fovy);
  }
}

CameraView NamedCamera(const mjModel* model, std::string_view name, std::string_view place) {
  return ModelCamera{RequireId(model, mjOBJ_CAMERA, name, place)};
}

OrbitCamera InitialView(const mjModel* model) {
  mjvCamera camera;
  mjv_defaultFreeCamera(model, &camera);
  return {.lookat = Eigen::Vector3d(camera.lookat[0], camera.lookat[1], camera.lookat[2]),
          .distance = camera.distance,
          .azimuth = camera.azimuth,
          .elevation = camera.elevation,
          .fovy = model->vis.global.fovy};
}

Eigen::Matrix3d CameraModel::intrinsics() const {
  Eigen::Matrix3d k;
  k << fx, 0, cx, 0, fy, cy, 0, 0, 1;
  return k;
}

Eigen::Matrix4d CameraModel::extrinsics() const {
  Eigen::Matrix4d out = camera_in_world.inverse().matrix();
  out.row(1) *= -1;  // y down
  out.row(2) *= -1;  // looking along +z
  return out;
}

double CameraModel::Depth(const Eigen::Vector3d& point) const {
  return -(camera_in_world.inverse() * point).z();
}

Eigen::Vector2d CameraModel::Project(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d p = camera_in_world.inverse() * point;
  const double depth = -p.z();
  if (!(depth > 0)) return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  const double scale = orthographic ? 1 : depth;
  return {cx + fx * p.x() / scale, cy - fy * p.y() / scale};
}

Eigen::Vector3d CameraModel::Unproject(const Eigen::Vector2d& pixel, double depth) const {
  const double scale = orthographic ? 1 : depth;
  return camera_in_world *
         Eigen::Vector3d((pixel.x() - cx) / fx * scale, -(pixel.y() - cy) / fy * scale, -depth);
}

bool CameraModel::Contains(const Eigen::Vector3d& point) const {
  const double depth = Depth(point);
  if (depth < near_m || depth > far_m) return false;
  const Eigen::Vector2d uv = Project(point);
  return uv.x() >= -0.5 && uv.x() < width - 0.5 && uv.y() >= -0.5 && uv.y() < height - 0.5;
}

CameraModel ComputeCamera(const mjModel* model, const mjData* data, const CameraView& view,
                          int width, int height) {
  if (width < 1 || height < 1)
    throw ArgumentError(
        fmt::format("an image of {} x {} pixels; each side must be at least 1", width, height));
  RequireView(view);
  CameraModel camera;
  camera.width = width;
  camera.height = height;
  // Uses the renderer's single precision, so that depth is converted with the values of the
  // drawing.
  camera.near_m = static_cast<float>(model->vis.map.znear * model->stat.extent);
  camera.far_m = static_cast<float>(model->vis.map.zfar * model->stat.extent);
  if (const auto* fixed = std::get_if<ModelCamera>(&view)) {
    SetModelCamera(camera, model, data, fixed->id);
  } else if (const auto* free = std::get_if<FreeCamera>(&view)) {
    camera.camera_in_world = free->camera_in_world;
    SetFieldOfView(camera, free->fovy);
  } else {
    const auto* tracking = std::get_if<TrackingCamera>(&view);
    const OrbitCamera orbit =
        tracking ? Around(model, data, *tracking) : std::get<OrbitCamera>(view);
    camera.camera_in_world = orbit.camera_in_world();
    SetFieldOfView(camera, orbit.fovy);
  }
  return camera;
}

Pose LookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up) {
  const Eigen::Vector3d forward = target - eye;
  if (forward.norm() < 1e-12)
    throw ArgumentError("a camera cannot look at the point that it stands on");
  Eigen::Vector3d right = forward.normalized().cross(up.normalized());
  if (right.norm() < 1e-9) right = forward.cross(Eigen::Vector3d::UnitY());
  if (right.norm() < 1e-9) right = forward.cross(Eigen::Vector3d::UnitX());
  right.normalize();
  return FromAxes(eye, right, right.cross(forward).normalized());
}

}  // namespace robocell
