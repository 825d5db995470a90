#include "robocell/render/camera_model.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <Eigen/Geometry>

#include "robocell/base/error.h"
#include "robocell/mujoco/clip_planes.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/step.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

constexpr char kScene[] = R"(<mujoco>
  <statistic extent="2"/>
  <visual><map znear="0.005" zfar="25"/></visual>
  <worldbody>
    <camera name="down" pos="0.1 0.2 3" fovy="60"/>
    <camera name="flat" pos="0 0 3" projection="orthographic" fovy="2"/>
    <camera name="lens" pos="0.3 -2 1" xyaxes="1 0 0 0 .3 1" resolution="640 480" sensorsize="0.0064 0.0048"
            focalpixel="500 520" principalpixel="40 20"/>
    <body name="arm" pos="1 0 1"><joint axis="0 0 1"/><geom size=".1"/>
      <camera name="wrist" pos=".1 0 .05" euler="30 20 10" fovy="75"/></body>
  </worldbody></mujoco>)";

class Cameras : public testing::Test {
 protected:
  Cameras() : model_(Compile(ParseXmlString(kScene).get())), data_(MakeData(model_.get())) {
    data_->qpos[0] = 0.7;
    Forward(model_.get(), data_.get());
  }
  CameraModel Camera(const char* name, int width = 640, int height = 480) {
    return ComputeCamera(model_.get(), data_.get(), NamedCamera(model_.get(), name, ""), width,
                         height);
  }
  ModelPtr model_;
  DataPtr data_;
};

TEST_F(Cameras, ThePrincipalPointOfASymmetricCameraIsTheMiddleOfThePixelCentres) {
  const CameraModel camera = Camera("down", 641, 480);
  EXPECT_EQ(camera.cx, 320);
  EXPECT_EQ(camera.cy, 239.5);
  EXPECT_DOUBLE_EQ(camera.fy, 240 / std::tan(M_PI / 6));
  EXPECT_EQ(camera.fx, camera.fy);
  Eigen::Matrix3d k;
  k << camera.fx, 0, 320, 0, camera.fy, 239.5, 0, 0, 1;
  EXPECT_EQ(camera.intrinsics(), k);
}

TEST_F(Cameras, ALensHasItsFocalLengthsAndAnOppositePrincipalPoint) {
  const CameraModel camera = Camera("lens");
  EXPECT_NEAR(camera.fx, 500, 1e-3);
  EXPECT_NEAR(camera.fy, 520, 1e-3);
  EXPECT_NEAR(camera.cx, 319.5 - 40, 1e-4);
  EXPECT_NEAR(camera.cy, 239.5 - 20, 1e-4);
}

TEST_F(Cameras, ProjectsPointsToTheirPixels) {
  const CameraModel camera = Camera("down");  // looks straight down, image up is +y
  EXPECT_TRUE(camera.Project({0.1, 0.2, 0}).isApprox(Eigen::Vector2d(319.5, 239.5)));
  EXPECT_GT(camera.Project({0.5, 0.2, 0}).x(), 319.5);  // +x is right
  EXPECT_LT(camera.Project({0.1, 0.6, 0}).y(), 239.5);  // +y is up, v is down
  EXPECT_DOUBLE_EQ(camera.Depth({0.5, 0.7, 1}), 2);
  EXPECT_TRUE(camera.Project({0.1, 0.2, 4}).hasNaN());  // behind
}

TEST_F(Cameras, ExtrinsicsAndIntrinsicsProjectLikeOpenCv) {
  for (const char* name : {"down", "wrist", "lens"}) {
    const CameraModel camera = Camera(name);
    const Eigen::Vector3d point = camera.Unproject({100, 300}, 1.7);
    const Eigen::Vector3d in_camera = (camera.extrinsics() * point.homogeneous()).head<3>();
    EXPECT_NEAR(in_camera.z(), 1.7, 1e-12);
    const Eigen::Vector2d uv = (camera.intrinsics() * in_camera).hnormalized();
    EXPECT_TRUE(uv.isApprox(Eigen::Vector2d(100, 300), 1e-9)) << name;
    EXPECT_TRUE(camera.Project(point).isApprox(uv, 1e-9)) << name;
    const Eigen::Matrix3d rotation = camera.extrinsics().topLeftCorner(3, 3);
    EXPECT_NEAR(rotation.determinant(), 1, 1e-12);
  }
}

TEST_F(Cameras, AnOrthographicCameraKeepsSizesAtAnyDepth) {
  const CameraModel camera = Camera("flat");
  EXPECT_TRUE(camera.orthographic);
  EXPECT_DOUBLE_EQ(camera.Project({0.5, 0, 0}).x(), 319.5 + 120);
  EXPECT_DOUBLE_EQ(camera.Project({0.5, 0, 2}).x(), 319.5 + 120);
  EXPECT_TRUE(camera.Unproject({439.5, 239.5}, 3).isApprox(Eigen::Vector3d(0.5, 0, 0)));
}

// The oracle is the engine's own frustum.
TEST_F(Cameras, TheFrustumMatchesTheEngineForEveryCamera) {
  mjvScene scene;
  mjv_defaultScene(&scene);
  mjv_makeScene(model_.get(), &scene, 100);
  for (const char* name : {"down", "wrist", "lens", "flat"}) {
    mjvCamera fixed;
    mjv_defaultCamera(&fixed);
    fixed.type = mjCAMERA_FIXED;
    fixed.fixedcamid = mj_name2id(model_.get(), mjOBJ_CAMERA, name);
    mjvOption option;
    mjv_defaultOption(&option);
    mjv_updateScene(model_.get(), data_.get(), &option, nullptr, &fixed, mjCAT_ALL, &scene);
    const mjvGLCamera gl = mjv_averageCamera(scene.camera, scene.camera + 1);
    const CameraModel camera = Camera(name);
    const double scale = camera.orthographic ? 1 : camera.near_m;
    EXPECT_EQ(camera.near_m, gl.frustum_near) << name;
    EXPECT_EQ(camera.far_m, gl.frustum_far) << name;
    EXPECT_EQ(camera.orthographic, gl.orthographic != 0) << name;
    EXPECT_NEAR((camera.cy + 0.5) / camera.fy * scale, gl.frustum_top, 1e-6 * scale) << name;
    EXPECT_NEAR(-(camera.height - 0.5 - camera.cy) / camera.fy * scale, gl.frustum_bottom,
                1e-6 * scale)
        << name;
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(camera.camera_in_world.translation()[i], gl.pos[i], 1e-6) << name;
      EXPECT_NEAR(-camera.camera_in_world.rotation()(i, 2), gl.forward[i], 1e-6) << name;
      EXPECT_NEAR(camera.camera_in_world.rotation()(i, 1), gl.up[i], 1e-6) << name;
    }
  }
  mjv_freeScene(&scene);
}

TEST_F(Cameras, AnOrbitMatchesTheViewersFreeCamera) {
  mjvCamera viewer;
  mjv_defaultCamera(&viewer);
  const OrbitCamera orbit{
      .lookat = {0.2, -0.3, 0.4}, .distance = 1.5, .azimuth = 130, .elevation = -25};
  for (int i = 0; i < 3; ++i) viewer.lookat[i] = orbit.lookat[i];
  viewer.distance = orbit.distance;
  viewer.azimuth = orbit.azimuth;
  viewer.elevation = orbit.elevation;
  mjtNum position[3], forward[3], up[3], right[3];
  mjv_cameraFrame(position, forward, up, right, data_.get(), &viewer);
  const Pose pose = orbit.camera_in_world();
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(pose.translation()[i], position[i], 1e-12);
    EXPECT_NEAR(pose.rotation()(i, 0), right[i], 1e-12);
    EXPECT_NEAR(pose.rotation()(i, 1), up[i], 1e-12);
    EXPECT_NEAR(pose.rotation()(i, 2), -forward[i], 1e-12);
  }
}

TEST_F(Cameras, ATrackingCameraMatchesTheViewer) {
  mjvCamera viewer;
  mjv_defaultCamera(&viewer);
  viewer.type = mjCAMERA_TRACKING;
  mjvOption option;
  mjv_defaultOption(&option);
  mjvScene scene;
  mjv_defaultScene(&scene);
  mjv_makeScene(model_.get(), &scene, 100);
  for (int body = 1; body < model_->nbody; ++body) {
    const TrackingCamera tracking{.body = body, .distance = 0.9, .azimuth = 30, .elevation = -20};
    viewer.trackbodyid = body;
    viewer.distance = tracking.distance;
    viewer.azimuth = tracking.azimuth;
    viewer.elevation = tracking.elevation;
    mjv_updateScene(model_.get(), data_.get(), &option, nullptr, &viewer, mjCAT_ALL, &scene);
    const CameraModel camera = ComputeCamera(model_.get(), data_.get(), tracking, 640, 480);
    const mjvGLCamera& left = scene.camera[0];
    const mjvGLCamera& right = scene.camera[1];  // the eyes stand beside the camera
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(camera.camera_in_world.translation()[i], 0.5 * (left.pos[i] + right.pos[i]),
                  1e-6);
      EXPECT_NEAR(camera.camera_in_world.rotation()(i, 2), -left.forward[i], 1e-6);
      EXPECT_NEAR(camera.camera_in_world.rotation()(i, 1), left.up[i], 1e-6);
    }
  }
  mjv_freeScene(&scene);
  ExpectThrow<ArgumentError>(
      [&] { ComputeCamera(model_.get(), data_.get(), TrackingCamera{99}, 10, 10); },
      "a camera that tracks body id 99: the model has ");
}

TEST_F(Cameras, ContainsRespectsImageEdgesAndClipPlanes) {
  const CameraModel camera = Camera("down");
  EXPECT_TRUE(camera.Contains(camera.Unproject({-0.49, 479.49}, 2)));
  EXPECT_FALSE(camera.Contains(camera.Unproject({-0.51, 100}, 2)));
  EXPECT_FALSE(camera.Contains(camera.Unproject({100, 479.51}, 2)));
  EXPECT_FALSE(camera.Contains(camera.Unproject({100, 100}, 0.009)));
  EXPECT_FALSE(camera.Contains(camera.Unproject({100, 100}, 51)));
}

TEST_F(Cameras, LookAtCentresTheTargetUpright) {
  const Eigen::Vector3d eye(1, 2, 3), target(-0.5, 0.1, 0.2);
  const Pose pose = LookAt(eye, target);
  const CameraModel camera =
      ComputeCamera(model_.get(), data_.get(), FreeCamera{pose, 50}, 640, 480);
  EXPECT_TRUE(camera.Project(target).isApprox(Eigen::Vector2d(319.5, 239.5)));
  EXPECT_LT(camera.Project(target + Eigen::Vector3d(0, 0, 0.1)).y(), 239);
  EXPECT_NEAR(camera.Project(target + Eigen::Vector3d(0, 0, 0.1)).x(), 319.5, 1e-9);
  const Pose down = LookAt({0, 0, 1}, {0, 0, 0});  // along `up`
  EXPECT_NEAR((down.rotation().col(2) - Eigen::Vector3d::UnitZ()).norm(), 0, 1e-12);
  ExpectThrow<ArgumentError>([&] { LookAt(eye, eye); },
                             "cannot look at the point that it stands on");
}

TEST_F(Cameras, RejectsInvalidNamesIdsAndSizes) {
  ExpectThrow<NotFoundError>(
      [&] { NamedCamera(model_.get(), "wirst", "scene 'pick'"); },
      "scene 'pick': no camera 'wirst'. Its cameras: down, flat, lens, wrist. "
      "Did you mean 'wrist'?");
  ExpectThrow<ArgumentError>(
      [&] { ComputeCamera(model_.get(), data_.get(), ModelCamera{9}, 10, 10); },
      "camera id 9: the model has 4 cameras");
  ExpectThrow<ArgumentError>(
      [&] { ComputeCamera(model_.get(), data_.get(), OrbitCamera{}, 0, 10); },
      "an image of 0 x 10 pixels");
}

TEST_F(Cameras, RejectInvalidNumbers) {
  const double nan = std::nan(""), infinity = HUGE_VAL;
  const auto draw = [&](const CameraView& view) {
    ComputeCamera(model_.get(), data_.get(), view, 64, 48);
  };
  for (const double fovy : {nan, infinity, -5.0, 0.0, 180.0, 1e30}) {
    const std::string message =
        fmt::format("a camera's fovy is {}; it must be above 0 and below 180 degrees", fovy);
    ExpectThrow<ArgumentError>([&] { draw(FreeCamera{.fovy = fovy}); }, message);
    ExpectThrow<ArgumentError>([&] { draw(OrbitCamera{.fovy = fovy}); }, message);
    ExpectThrow<ArgumentError>([&] { draw(TrackingCamera{.fovy = fovy}); }, message);
    model_->cam_fovy[0] = static_cast<float>(fovy);  // by hand, after the engine has checked it
    ExpectThrow<ArgumentError>([&] { draw(ModelCamera{0}); }, "a camera's fovy is ");
  }
  EXPECT_NO_THROW(draw(FreeCamera{.fovy = 179.9}));
  EXPECT_NO_THROW(draw(OrbitCamera{.distance = 0}));
  ExpectThrow<ArgumentError>([&] { draw(OrbitCamera{.distance = -1}); },
                             "a camera's distance is -1; it must be at least 0 metres");
  ExpectThrow<ArgumentError>([&] { draw(TrackingCamera{.distance = nan}); },
                             "a camera's distance is nan; it must be finite");
  ExpectThrow<ArgumentError>([&] { draw(OrbitCamera{.azimuth = infinity}); },
                             "a camera's azimuth is inf; it must be finite");
  ExpectThrow<ArgumentError>([&] { draw(OrbitCamera{.elevation = nan}); }, "elevation is nan");
  ExpectThrow<ArgumentError>([&] { draw(OrbitCamera{.lookat = {0, nan, 0}}); }, "lookat is nan");
  model_->cam_fovy[1] = 0;
  ExpectThrow<ArgumentError>([&] { draw(ModelCamera{1}); },
                             "an orthographic camera's fovy is 0; it must be a finite number of "
                             "metres above 0");
}

TEST_F(Cameras, ClipPlanesAreReadAndSetInMetres) {
  EXPECT_NEAR(internal::GetClipPlanes(model_.get()).near_m, 0.01, 1e-9);
  EXPECT_NEAR(internal::GetClipPlanes(model_.get()).far_m, 50, 1e-5);
  internal::SetClipPlanes(model_.get(), 0.02, 12);
  EXPECT_NEAR(Camera("down").near_m, 0.02, 1e-8);
  EXPECT_NEAR(Camera("down").far_m, 12, 1e-6);
  SpecPtr spec = ParseXmlString(kScene);
  internal::SetClipPlanes(spec.get(), 4, 0.03, 30);
  ModelPtr model = Compile(spec.get());
  EXPECT_EQ(model->stat.extent, 4);
  EXPECT_NEAR(internal::GetClipPlanes(model.get()).far_m, 30, 1e-5);
  ExpectThrow<ArgumentError>([&] { internal::SetClipPlanes(model.get(), 1, 0.5); },
                             "near 1 m, far 0.5 m");
}

}  // namespace
}  // namespace robocell
