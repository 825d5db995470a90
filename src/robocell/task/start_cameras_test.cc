#include "robocell/task/start_cameras.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/task/start_sampler.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;

RunConfig RunWith(const std::string& name, const StartCamera& camera) {
  RunConfig run = ExampleRun("demo.yaml");
  run.start.visible_from = {};
  run.start.cameras[name] = camera;
  return run;
}

// A mug before the robot of the demo, and the cameras of a run in this scene.
struct CameraCell {
  RunConfig run;
  Scene scene;
  Robot robot;
  StartCameras cameras;
};

CameraCell CellWith(const std::string& name, const StartCamera& camera) {
  const RunConfig run = RunWith(name, camera);
  const PickScene probe = MakePickScene(ObjectOnTheTable("mug"));
  StartCameras cameras(run, probe.scene, probe.robot, std::make_shared<BodyImages>());
  SceneSpec spec = probe.scene.spec();
  cameras.AddTo(spec);
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return {run, scene, Robot::Of(scene, run.robot.config.name), std::move(cameras)};
}

std::string RefusalOf(CameraCell& cell, int seed = 0) {
  const auto refusal = cell.cameras.Place(cell.scene, cell.robot, {}, Rng::Stream(seed, "cameras"));
  return refusal ? refusal->detail : "";
}

TEST(StartCameras, ACopyIsTheCameraOfTheRobot) {
  CameraCell cell = CellWith("copy", {.camera = "wrist_camera"});
  EXPECT_EQ(RefusalOf(cell), "");
  cell.scene.SyncPoses();
  EXPECT_TRUE(cell.scene.camera_pose("copy").is_close(
      cell.scene.camera_pose("robot_0/wrist_camera"), 1e-9, 1e-9));
  const mjModel* m = cell.scene.model();
  EXPECT_DOUBLE_EQ(m->cam_fovy[FindId(m, mjOBJ_CAMERA, "copy")],
                   m->cam_fovy[FindId(m, mjOBJ_CAMERA, "robot_0/wrist_camera")]);
}

TEST(StartCameras, NoiseStaysWithinItsRangesAndSpansThem) {
  const StartCamera noisy{
      .camera = "exo_camera", .pos_noise = {0.02, 0.01, 0}, .rotation_noise = 3, .fovy_noise = 4};
  CameraCell cell = CellWith("exo", noisy);
  const mjModel* m = cell.scene.model();
  const double fovy = m->cam_fovy[FindId(m, mjOBJ_CAMERA, "robot_0/exo_camera")];
  Eigen::Vector3d most = Eigen::Vector3d::Zero();
  double turn = 0, lens = 0;
  for (int seed = 0; seed < 200; ++seed) {
    ASSERT_EQ(RefusalOf(cell, seed), "");
    cell.scene.SyncPoses();
    const Pose offset =
        cell.scene.camera_pose("robot_0/exo_camera").inverse() * cell.scene.camera_pose("exo");
    most = most.cwiseMax(offset.translation().cwiseAbs());
    turn = std::max(turn, offset.angle() * 180 / M_PI);
    lens = std::max(lens, std::abs(m->cam_fovy[FindId(m, mjOBJ_CAMERA, "exo")] - fovy));
  }
  EXPECT_LE(most.x(), 0.02 + 1e-9);
  EXPECT_GT(most.x(), 0.8 * 0.02);
  EXPECT_LE(most.y(), 0.01 + 1e-9);
  EXPECT_GT(most.y(), 0.8 * 0.01);
  EXPECT_NEAR(most.z(), 0, 1e-9);
  EXPECT_LE(turn, 3 + 1e-6);
  EXPECT_GT(turn, 0.8 * 3);
  EXPECT_LE(lens, 4);
  EXPECT_GT(lens, 0.8 * 4);
}

TEST(StartCameras, OneOnABodyMovesWithItAndLooksAtItsPoint) {
  CameraCell cell = CellWith(
      "hand",
      {.mount = "base_link", .pos = Vec3{0.1, 0.2, 0.5}, .look_at = Vec3{0.5, 0, 0.1}, .fovy = 70});
  ASSERT_EQ(RefusalOf(cell), "");
  for (const double y : {0.0, 0.3}) {
    cell.robot.base().SetPose(Pose::FromRpy({-0.4, y, 0.2}, {0, 0, y}));
    cell.scene.Forward();
    const Pose base = cell.scene.body_pose("robot_0/base_link");
    const Pose camera = base.inverse() * cell.scene.camera_pose("hand");
    EXPECT_TRUE(camera.translation().isApprox(Eigen::Vector3d(0.1, 0.2, 0.5), 1e-9));
    const Eigen::Vector3d ahead = -camera.rotation().col(2);
    EXPECT_TRUE(ahead.isApprox(Eigen::Vector3d(0.4, -0.2, -0.4).normalized(), 1e-9));
  }
}

TEST(StartCameras, OneAroundAnObjectSeesWhatItHasToSee) {
  const StartCamera around{.around = {"target"},
                           .distance = {0.5, 0.9},
                           .height = {0.2, 0.6},
                           .azimuth = {-90, 90},
                           .look_at_noise = 0.03,
                           .sees = {{"target", {.pixels = 40, .share = 0.5}}}};
  CameraCell cell = CellWith("side", around);
  BodyImages images;
  const std::vector<bool> mug = BodiesOf(cell.scene, "target", "test");
  const Eigen::Vector3d base = cell.robot.base_in_world().translation();
  double near = 1e9, far = 0, low = 1e9, high = 0;
  for (int seed = 0; seed < 25; ++seed) {
    if (!RefusalOf(cell, seed).empty()) continue;
    cell.scene.SyncPoses();
    const ObjectView seen =
        ViewOfObject(cell.scene, mug, NamedCamera(cell.scene.model(), "side", "test"),
                     cell.run.cameras.resolution[0], cell.run.cameras.resolution[1], 0, images);
    EXPECT_GE(seen.pixels, 40);
    EXPECT_GE(seen.share, 0.5);
    const std::optional<WorldBox> box = BoxOf(cell.scene, mug);
    ASSERT_TRUE(box);
    const Eigen::Vector3d middle = 0.5 * (box->low + box->high);
    const Eigen::Vector3d away = cell.scene.camera_pose("side").translation() - middle;
    EXPECT_GE(away.head<2>().dot((middle - base).head<2>()), -1e-9) << "behind the robot";
    near = std::min(near, away.head<2>().norm());
    far = std::max(far, away.head<2>().norm());
    low = std::min(low, away.z());
    high = std::max(high, away.z());
  }
  EXPECT_GE(near, 0.5 - 1e-9);
  EXPECT_LE(far, 0.9 + 1e-9);
  EXPECT_GT(far - near, 0.8 * 0.4);
  EXPECT_GE(low, 0.2 - 1e-9);
  EXPECT_LE(high, 0.6 + 1e-9);
  EXPECT_GT(high - low, 0.8 * 0.4);
}

TEST(StartCameras, RefusalsSayWhatIsNotSeen) {
  const auto refusal = [](const CameraSight& sight, const std::string& name = "target") {
    // It looks at the mug from behind the hand that is put in front of it below.
    CameraCell cell = CellWith("front", {.pos = Vec3{1.2, 0, 0.5},
                                         .look_at = Vec3{0, 0, 0.5},
                                         .fovy = 40,
                                         .sees = {{name, sight}}});
    return RefusalOf(cell);
  };
  EXPECT_EQ(refusal({.pixels = 1}), "");
  EXPECT_THAT(refusal({.pixels = 1000000}), HasSubstr("camera 'front' sees"));
  EXPECT_THAT(refusal({.pixels = 1000000}), HasSubstr("of 'target', and needs 1000000"));
  EXPECT_EQ(refusal({.pixels = 1}, "robot"), "");
  EXPECT_EQ(refusal({.not_hidden_by = {"gripper"}}), "");
}

TEST(StartCameras, SeesWhatIsInFront) {
  // From behind the robot, its body hides the mug.
  const auto refusal = [](const NameList& names) {
    CameraCell cell =
        CellWith("back", {.pos = Vec3{-1.2, 0, 0.45},
                          .look_at = Vec3{0, 0, 0.48},
                          .fovy = 40,
                          .sees = {{"target", {.pixels = 0, .not_hidden_by = names}}}});
    return RefusalOf(cell);
  };
  EXPECT_THAT(refusal({"robot"}), HasSubstr("camera 'back' sees 'robot' in front of 'target'"));
  EXPECT_EQ(refusal({}), "");
}

TEST(StartCameras, RejectsUnknownNames) {
  ExpectThrow<NotFoundError>([] { CellWith("wirst", {.camera = "wrist_camra"}); },
                             "camera 'wirst': no camera 'wrist_camra'");
  ExpectThrow<NotFoundError>([] { CellWith("a", {.mount = "bas_link", .pos = Vec3{}}); },
                             "camera 'a', mount: no body or site 'bas_link'");
  CameraCell cell = CellWith("a", {.around = {"targt"}});
  ExpectThrow<NotFoundError>([&] { cell.cameras.RequireNames(cell.scene, cell.robot, {}); },
                             "camera 'a', around: no object, robot or body 'targt'");
}

TEST(StartCameras, NamesAreTheRobotsBeforeTheScenes) {
  const RunConfig run = RunWith("hand", {.mount = "base_link", .pos = Vec3{0, 0, 0.5}});
  SceneSpec spec = MakePickScene(ObjectOnTheTable("mug")).scene.spec();
  SceneObject like_it = BoxObject("base_link", {0.3, 0.3, 0.6});
  spec.objects.push_back(like_it);
  const Scene probe = Scene::Build(spec);
  const Robot robot = Robot::Of(probe, run.robot.config.name);
  const StartCameras cameras(run, probe, robot, std::make_shared<BodyImages>());
  cameras.AddTo(spec);
  EXPECT_TRUE(spec.cameras.back().attach_to == Body("robot_0/base_link"));
}

TEST(StartCameras, ARobotWithoutGeomsIsNotSeen) {
  ModelFolder folder;
  const std::string model =
      folder.Write("bare",
                   "<worldbody><body name='base'><inertial mass='1' pos='0 0 0' "
                   "diaginertia='1 1 1'/><body name='link'><inertial mass='1' pos='0 0 0' "
                   "diaginertia='1 1 1'/><joint name='turn' range='-90 90'/></body></body>"
                   "</worldbody><actuator><position joint='turn'/></actuator>");
  SceneSpec spec = EmptyScene();
  RobotConfig bare{.name = "bare", .model = model};
  spec.robots.push_back({.name = "bare", .config = bare});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  const Robot robot = Robot::Of(scene, "bare");
  ExpectThrow<NotFoundError>([&] { BodiesNamed(scene, robot, "robot", "camera 'a', sees"); },
                             "camera 'a', sees: robot 'bare' has no geoms that a camera could see");
}

TEST(StartCameras, StartsOfARunHaveThemInTheirSpecs) {
  RunConfig run =
      RunWith("side", {.around = {"target", "gripper"}, .sees = {{"target", {.pixels = 20}}}});
  run.start.cameras["wrist"] = {.camera = "wrist_camera", .rotation_noise = 2};
  StartSampler sampler(run);
  std::optional<EpisodeStart> start;
  for (int attempt = 0; attempt < 20 && !start; ++attempt) {
    Rng rng = Rng::Stream(5, attempt);
    start = sampler.Sample({.attempt = attempt}, rng).start;
  }
  ASSERT_TRUE(start);
  Scene again = Scene::Build(start->scene.spec());
  again.Reset();
  again.SetState(start->scene.state());
  again.Forward();
  for (const char* name : {"side", "wrist"}) {
    EXPECT_TRUE(again.camera_pose(name).is_close(start->scene.camera_pose(name), 1e-9, 1e-9))
        << name;
  }
  // The same request and stream give the same cameras.
  StartSampler other(run);
  std::optional<EpisodeStart> same;
  for (int attempt = 0; attempt < 20 && !same; ++attempt) {
    Rng rng = Rng::Stream(5, attempt);
    same = other.Sample({.attempt = attempt}, rng).start;
  }
  ASSERT_TRUE(same);
  EXPECT_TRUE(same->scene.camera_pose("side") == start->scene.camera_pose("side"));
}

TEST(StartCameras, AStartThatNoCameraSeesIsRefusedUnderItsStage) {
  RunConfig run = RunWith(
      "blind",
      {.pos = Vec3{3, 0, 3}, .look_at = Vec3{6, 0, 3}, .sees = {{"target", {.pixels = 1}}}});
  StartSampler sampler(run);
  Rng rng = Rng::Stream(5);
  const SampleResult result = sampler.Sample({}, rng);
  ASSERT_FALSE(result.start);
  EXPECT_EQ(result.refusal.counted_as(), "cameras: camera constraint");
}

}  // namespace
}  // namespace robocell::internal
