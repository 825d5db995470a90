// Describes the pose and projection of a camera: intrinsics, extrinsics and projection, computed
// from the simulation's model and state. It has no images; the renderer draws with exactly these
// values.
//
// Pixels: the centre of the upper left pixel is (0, 0), u goes right and v down, so that
// image[v][u] is pixel (u, v) and the principal point of a symmetric camera is ((W-1)/2, (H-1)/2).
// Axes: poses are in MuJoCo's camera axes (x right, y up, looking along -z) like all placement in
// robocell; only `extrinsics()` and what it projects use OpenCV's (x right, y down, looking along
// +z).
//
//   const CameraView view = NamedCamera(model, "wrist", "robot 'left'");
//   const CameraModel camera = ComputeCamera(model, data, view, 640, 480);
//   const Eigen::Vector2d uv = camera.Project(cube_in_world);
//   const Eigen::Matrix3d k = camera.intrinsics();                 // of perspective cameras
//   const Eigen::Matrix4d world_to_camera = camera.extrinsics();
//
// `data` must be up to date with its qpos (mj_kinematics, mj_comPos and mj_camlight, or
// mj_forward): after mj_step the engine's poses are still those of the previous state.
// Renderer::Render ensures that itself and returns the camera of its drawing.
//
// No allocation, any thread. A lens is the engine's ideal one: no distortion.
#pragma once

#include <string_view>
#include <variant>
#include <Eigen/Core>

#include "robocell/math/pose.h"
#include "robocell/mujoco/forward.h"

namespace robocell {

// A camera of the model, by id. Ids change when the model is compiled again.
struct ModelCamera {
  int id = 0;
};

// A camera anywhere: pose in the world in MuJoCo's camera axes, vertical field of view in degrees.
struct FreeCamera {
  Pose camera_in_world;
  double fovy = 45;
};

// A camera that looks at a point, like MuJoCo's interactive viewer. Degrees and metres. Azimuth 90
// looks along +y, negative elevation looks down.
struct OrbitCamera {
  Eigen::Vector3d lookat = Eigen::Vector3d::Zero();
  double distance = 2;
  double azimuth = 90;
  double elevation = -45;
  double fovy = 45;

  Pose camera_in_world() const;
};

// An orbit around a moving body: around the centre of mass of the body (by id) and its subtree,
// like the tracking of the interactive viewer. Degrees and metres as above.
struct TrackingCamera {
  int body = 0;
  double distance = 2;
  double azimuth = 90;
  double elevation = -45;
  double fovy = 45;
};

using CameraView = std::variant<ModelCamera, FreeCamera, OrbitCamera, TrackingCamera>;

// Returns the first view of MuJoCo's viewer: the whole model.
OrbitCamera InitialView(const mjModel* model);

// Throws ArgumentError, with the value, for a view that cannot be drawn: numbers that are not
// finite, a distance below 0, or a field of view that is not above 0 and below 180 degrees.
void RequireView(const CameraView& view);

// Throws NotFoundError that lists the model's cameras.
CameraView NamedCamera(const mjModel* model, std::string_view name, std::string_view place);

struct CameraModel {
  int width = 0, height = 0;     // pixels
  Pose camera_in_world;          // MuJoCo's camera axes
  double fx = 0, fy = 0;         // pixels; with an orthographic camera pixels per metre
  double cx = 0, cy = 0;         // principal point, pixels
  double near_m = 0, far_m = 0;  // clip planes: nearer and farther geometry is not drawn
  bool orthographic = false;

  // Returns [fx 0 cx; 0 fy cy; 0 0 1].
  Eigen::Matrix3d intrinsics() const;
  // Returns world -> camera in OpenCV's axes; p_camera = extrinsics * (p_world, 1).
  Eigen::Matrix4d extrinsics() const;

  // Returns the pixel of a point in the world; also of points outside of the image. NaN for points
  // not in front of the camera.
  Eigen::Vector2d Project(const Eigen::Vector3d& point_in_world) const;
  // Returns the distance to the camera's plane, metres: the value in a depth image.
  double Depth(const Eigen::Vector3d& point_in_world) const;
  // Returns the point in the world that is seen in a pixel at a depth.
  Eigen::Vector3d Unproject(const Eigen::Vector2d& pixel, double depth) const;
  // Returns true if the point is inside the image, between the clip planes.
  bool Contains(const Eigen::Vector3d& point_in_world) const;
};

// Throws ArgumentError for a camera or body id that does not exist, an image without pixels, and
// the views that RequireView rejects.
CameraModel ComputeCamera(const mjModel* model, const mjData* data, const CameraView& view,
                          int width, int height);

// Returns the pose of a camera at `eye` that looks at `target` with `up` upwards in the image;
// MuJoCo's camera axes. Throws ArgumentError if eye and target coincide. When it looks straight
// along `up`, the world's y axis replaces `up`.
Pose LookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
            const Eigen::Vector3d& up = Eigen::Vector3d::UnitZ());

}  // namespace robocell
