// Tests poses: attach targets, the rig, bases, authored root poses.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <numbers>
#include <optional>
#include <tuple>
#include <Eigen/Geometry>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/scene/placement.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/pedestal.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/random_values.h"

namespace robocell::internal {
namespace {

constexpr double kExact = 1e-9;  // rounding of MJCF text and of the engine's normalisation

template <class Spec>
void PutAt(Spec& spec, const Pose& pose) {
  spec.pos = ToVec3(pose.translation());
  spec.quat = pose.quaternion();
}

std::string PoseText(const Pose& pose) {
  const auto& t = pose.translation();
  const Quaternion q = pose.quaternion_wxyz();
  return fmt::format(R"(pos="{:.17g} {:.17g} {:.17g}" quat="{:.17g} {:.17g} {:.17g} {:.17g}")",
                     t.x(), t.y(), t.z(), q[0], q[1], q[2], q[3]);
}

#define EXPECT_SAME_POSE(actual, expected)                                                 \
  EXPECT_TRUE((actual).is_close((expected), kExact, kExact)) << (actual) << "\nexpected\n" \
                                                             << (expected)

// A shelf at `shelf` with a site and a frame on it, and an arm whose root has a pose of its own.
struct RandomRig {
  explicit RandomRig(uint64_t seed) : rng(Rng::Stream(seed, "rig")) {
    spec = EmptyScene();
    spec.root_frame_to_world = RandomPose(rng);
    spec.shared_base_frame_to_root_frame = RandomPose(rng);
    shelf = RandomPose(rng), site = RandomPose(rng), outer = RandomPose(rng),
    inner = RandomPose(rng), authored = RandomPose(rng);
    SceneObject object{
        .name = "shelf",
        .mjcf_path = folder.Write(
            "shelf", fmt::format(
                         R"(<worldbody><body name="board"><geom size="0.1"/><site name="spot" {}/>
           <frame name="outer" {}><frame name="inner" {}/></frame></body></worldbody>)",
                         PoseText(site), PoseText(outer), PoseText(inner)))};
    PutAt(object, shelf);
    spec.objects.push_back(object);
    arm = folder.Write("arm", fmt::format(R"(<worldbody><frame {}><body name="base" {}>
        <geom size="0.1"/><site name="flange" {}/></body></frame></worldbody>)",
                                          PoseText(inner), PoseText(authored), PoseText(site)));
  }

  Pose Parent(const AttachTarget& target) const {
    switch (target.kind) {
      case AttachKind::kWorld:
        return Pose();
      case AttachKind::kRoot:
        return spec.root_frame_to_world;
      case AttachKind::kSharedBase:
        return spec.root_frame_to_world * spec.shared_base_frame_to_root_frame;
      case AttachKind::kBody:
        return shelf;
      case AttachKind::kSite:
        return shelf * site;
      default:
        return shelf * outer * inner;
    }
  }

  Rng rng;
  ModelFolder folder;
  SceneSpec spec;
  std::string arm;
  Pose shelf, site, outer, inner, authored;
};

const std::vector<AttachTarget> kTargets = {
    World(), Root(), SharedBase(), Body("shelf_board"), Site("shelf_spot"), Frame("shelf_inner")};

TEST(Placement, RobotPosesAreParentTimesPoseTimesAuthoredPose) {
  for (uint64_t seed = 0; seed < 60; ++seed) {
    RandomRig rig(seed);
    const AttachTarget target = kTargets[seed % kTargets.size()];
    const bool reset = rig.rng.UniformInt(2) == 0, pedestal = rig.rng.UniformInt(2) == 0;
    const auto kind = static_cast<BaseKind>(rig.rng.UniformInt(4));
    const Pose pose = RandomPose(rig.rng);
    RobotSpec robot{.path = rig.arm,
                    .prefix = "r_",
                    .base = BaseConfig{.kind = kind},
                    .reset_root_pose = reset,
                    .attach_to = target};
    if (pedestal) robot.base->size = Vec3{0.2, 0.2, 0.3};
    PutAt(robot, pose);
    rig.spec.robots.push_back(robot);
    const Scene scene = Scene::Build(rig.spec);
    const Pose bottom = rig.Parent(target) * pose;
    const Pose top = bottom * Pose(Eigen::Vector3d(0, 0, pedestal ? 0.3 : 0));
    const Pose root = reset ? top : top * rig.inner * rig.authored;
    SCOPED_TRACE(
        fmt::format("seed {}: {} base on {}", seed, ToString(kind), ToString(target.kind)));
    EXPECT_SAME_POSE(scene.body_pose("r_base"), root);
    EXPECT_SAME_POSE(scene.site_pose("r_flange"), root * rig.site);
    const RobotRecord& record = scene.compiled()->robot("r");
    EXPECT_EQ(record.pedestal_height, pedestal ? 0.3 : 0);
    EXPECT_EQ(record.mocap_body,
              kind == BaseKind::kMocap ? std::optional<std::string>("r_mocap_base") : std::nullopt);
    if (kind == BaseKind::kMocap) {
      EXPECT_SAME_POSE(scene.body_pose("r_mocap_base"), bottom);
    }
  }
}

TEST(Placement, ARobotOffItsOriginIsCentredOnItsPedestal) {
  ModelFolder folder;
  RobotSpec robot = AsideOnAPedestal(folder, 0);
  const Pose turned = Pose::FromRpy({0, 0, 0}, {0, 0, std::numbers::pi / 2});
  const Pose middle(Eigen::Vector3d(0, 0, 0.3)), aside(Eigen::Vector3d(-.469, -.019, 0.3));
  for (const auto& [of_robot, of_config, expected] :
       {std::tuple<std::optional<bool>, std::optional<bool>, Pose>{{}, {}, middle * turned},
        {{}, false, aside * turned},
        {{}, true, middle},
        {true, false, middle},
        {false, true, aside * turned}}) {
    robot.reset_root_pose = of_robot;
    robot.config->reset_root_pose = of_config;
    EXPECT_SAME_POSE(Scene::Build(WithRobot(robot)).body_pose("r_base"), expected);
  }
  robot.reset_root_pose = robot.config->reset_root_pose = std::nullopt;
  robot.base->size.reset();
  EXPECT_SAME_POSE(Scene::Build(WithRobot(robot)).body_pose("r_base"),
                   Pose(Eigen::Vector3d(-.469, -.019, 0)) * turned)
      << "without a pedestal it is where its file has it";
}

TEST(Placement, ObjectAndCameraPosesAreParentTimesPose) {
  for (uint64_t seed = 0; seed < 24; ++seed) {
    RandomRig rig(seed);
    const AttachTarget target = kTargets[seed % kTargets.size()];
    const bool free = target.kind == AttachKind::kWorld || target.kind == AttachKind::kRoot ||
                      target.kind == AttachKind::kSharedBase;
    const Pose pose = RandomPose(rig.rng), eye = RandomPose(rig.rng);
    SceneObject cube = BoxObject("cube", {});
    cube.attach_to = target;
    if (!free) cube.fixed = true;
    PutAt(cube, pose);
    rig.spec.objects.push_back(cube);
    CameraSpec camera{.name = "eye", .pos = Vec3{}, .fovy = 50, .attach_to = target};
    camera.pos = ToVec3(eye.translation());
    camera.quat = eye.quaternion();
    rig.spec.cameras.push_back(camera);
    const Scene scene = Scene::Build(rig.spec);
    SCOPED_TRACE(ToString(target.kind));
    EXPECT_SAME_POSE(scene.body_pose("cube"), rig.Parent(target) * pose);
    EXPECT_SAME_POSE(scene.camera_pose("eye"), rig.Parent(target) * eye);
    EXPECT_EQ(scene.compiled()->object("cube").free_joint.has_value(), free);
  }
}

TEST(Placement, TargetsCanBeRobotsBasesAndAttachmentSites) {
  RandomRig rig(7);
  RobotConfig config{.name = "arm", .model = rig.arm, .attachment_site = "flange"};
  rig.spec.robots.push_back({.name = "left", .config = config, .prefix = "l_", .pos = {1, 2, 3}});
  SceneObject badge = BoxObject("badge", {0.1, 0, 0}), tool = BoxObject("tool", {0, 0.1, 0});
  badge.fixed = tool.fixed = true;
  badge.attach_to = RobotBase("left");
  tool.attach_to = Attachment("left");
  rig.spec.objects.push_back(badge);
  rig.spec.objects.push_back(tool);
  const Scene scene = Scene::Build(rig.spec);
  EXPECT_SAME_POSE(scene.body_pose("badge"),
                   scene.body_pose("l_base") * Pose(Eigen::Vector3d(0.1, 0, 0)));
  EXPECT_SAME_POSE(scene.body_pose("tool"),
                   scene.site_pose("l_flange") * Pose(Eigen::Vector3d(0, 0.1, 0)));
}

TEST(Placement, ToolPosesUseDegreesAboutFixedAxes) {
  RandomRig rig(11);
  const std::string arm =
      rig.folder.Write("hand", fmt::format(R"(<worldbody><body name="hand"><geom size="0.1"/>
        <frame name="mount" {}/></body></worldbody>)",
                                           PoseText(rig.outer)));
  const std::string tool = rig.folder.Write(
      "probe",
      fmt::format(R"(<worldbody><body name="probe" {}><geom size="0.1"/></body></worldbody>)",
                  PoseText(rig.authored)));
  rig.spec.robots.push_back({.path = arm,
                             .prefix = "r_",
                             .attachments = {{.mjcf_path = tool,
                                              .attach_to = Frame("mount"),
                                              .prefix = "t_",
                                              .pos = Vec3{0.1, 0.2, 0.3},
                                              .euler = {20, -35, 50}}}});
  const Scene scene = Scene::Build(rig.spec);
  const auto turn = [](double degrees, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis);
  };
  const Eigen::Matrix3d turned =
      (turn(50, Eigen::Vector3d::UnitZ()) * turn(-35, Eigen::Vector3d::UnitY()) *
       turn(20, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  const Eigen::Matrix3d actual = (rig.outer.inverse() * scene.body_pose("r_hand").inverse() *
                                  scene.body_pose("r_t_probe") * rig.authored.inverse())
                                     .rotation();
  EXPECT_LT((actual - turned).norm(), 1e-9) << "about x, then y, then z of the frame";
  EXPECT_SAME_POSE(
      scene.body_pose("r_t_probe"),
      scene.body_pose("r_hand") * rig.outer *
          Pose::FromRpy({0.1, 0.2, 0.3}, Eigen::Vector3d(20, -35, 50) * std::numbers::pi / 180) *
          rig.authored);
}

// A spec may be changed in place; the next scene made of it has the change.
TEST(Placement, EditsInPlaceMoveTheTool) {
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.path = folder.Write("arm", kTwoJointArm),
                         .attachments = {{.mjcf_path = folder.Write("gripper", kTwoFingerGripper),
                                          .attach_to = Site("flange"),
                                          .prefix = "g_"}}});
  const Scene before = Scene::Build(spec);
  AttachmentSpec& gripper = spec.robots[0].attachments[0];
  gripper.pos[2] = 0.005;
  gripper.euler[2] = 15;
  const Scene after = Scene::Build(spec);
  EXPECT_SAME_POSE(after.site_pose("flange"), before.site_pose("flange"));
  EXPECT_SAME_POSE(before.site_pose("g_pinch").inverse() * after.site_pose("g_pinch"),
                   Pose::FromRpy({0, 0, 0.005}, {0, 0, 15 * std::numbers::pi / 180}));
}

TEST(Placement, TheRigMatchesTheSpec) {
  RandomRig rig(3);
  const Scene scene = Scene::Build(rig.spec);
  EXPECT_SAME_POSE(scene.root_frame_to_world(), rig.spec.root_frame_to_world);
  EXPECT_SAME_POSE(scene.shared_base_frame_to_world(),
                   rig.spec.root_frame_to_world * rig.spec.shared_base_frame_to_root_frame);
  EXPECT_SAME_POSE(SharedBaseFrameToWorld(rig.spec), scene.shared_base_frame_to_world());
}

TEST(Placement, RespectsTheEulerSequenceOfAModel) {
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  const std::string arm = folder.Write("arm", R"(<compiler angle="degree" eulerseq="zyx"/>
      <worldbody><body name="base" euler="90 0 90"><geom size="0.1"/></body></worldbody>)");
  spec.robots.push_back({.path = arm});
  const Scene scene = Scene::Build(spec);
  const ModelPtr alone(mj_loadXML(arm.c_str(), nullptr, nullptr, 0));
  EXPECT_SAME_POSE(scene.body_pose("base"),
                   Pose::FromWxyz(alone->body_pos + 3, alone->body_quat + 4));
}

TEST(Placement, RejectsAMocapBaseOnAMovingParent) {
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.path = folder.Write("arm", kTwoJointArm), .prefix = "a_"});
  spec.robots.push_back({.path = folder.Write("arm", kTwoJointArm),
                         .prefix = "b_",
                         .base = BaseConfig{.kind = BaseKind::kMocap},
                         .attach_to = Body("a_fore")});
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "scene 'test' / robot 'b': a mocap base hangs on the world, but is "
                         "attached to body 'a_fore', which can move");
}

TEST(Placement, AMocapBaseMovesItsRobot) {
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  spec.robots.push_back(
      {.path = folder.Write("arm", kTwoJointArm),
       .base = BaseConfig{.kind = BaseKind::kMocap, .size = Vec3{0.2, 0.2, 0.5}}});
  Scene scene = Scene::Build(spec);
  scene.SetBodyPose("mocap_base", Pose::FromRpy({1, 2, 0}, {0, 0, 1}));
  EXPECT_SAME_POSE(scene.body_pose("base"),
                   Pose::FromRpy({1, 2, 0}, {0, 0, 1}) * Pose(Eigen::Vector3d(0, 0, 0.8)));
}

TEST(Placement, APedestalDoesNotCollideWithStaticGeoms) {  // the engine's rule: base placement must
                                                           // check statics itself
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  SceneObject block = BoxObject("block", {0, 0, 0.25});
  block.fixed = true;
  spec.objects.push_back(block);
  spec.robots.push_back(
      {.path = folder.Write("arm", kTwoJointArm),
       .base = BaseConfig{.kind = BaseKind::kMocap, .size = Vec3{0.2, 0.2, 0.5}}});
  const Scene scene = Scene::Build(spec);
  EXPECT_THAT(scene.contacts(), ::testing::IsEmpty());
  const mjModel* m = scene.model();
  const int pedestal = mj_name2id(m, mjOBJ_GEOM, "pedestal"),
            geom = mj_name2id(m, mjOBJ_GEOM, "block_geom");
  EXPECT_LT(mj_geomDistance(m, scene.data(), pedestal, geom, 1, nullptr), 0);
}

TEST(Placement, APlanarBaseSlidesAndTurns) {
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.path = folder.Write("arm", kTwoJointArm),
                         .prefix = "p_",
                         .base = BaseConfig{.kind = BaseKind::kPlanar},
                         .reset_root_pose = true});
  Scene scene = Scene::Build(spec);
  const mjModel* m = scene.model();
  const double q[] = {0.5, -0.25, 0.75};
  int i = 0;
  for (const char* joint : {"p_base_x", "p_base_y", "p_base_yaw"}) {
    scene.data()->qpos[m->jnt_qposadr[mj_name2id(m, mjOBJ_JOINT, joint)]] = q[i++];
  }
  scene.Forward();
  EXPECT_SAME_POSE(scene.body_pose("p_base"), Pose::FromRpy({0.5, -0.25, 0}, {0, 0, 0.75}));
}

TEST(Placement, AFreeJointOfTheModelItselfMakesTheBaseFree) {
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  const std::string walker = folder.Write(
      "walker",
      R"(<worldbody><body name="torso" pos="0 0 1"><freejoint name="root"/><geom size="0.1"/></body></worldbody>)");
  spec.robots.push_back({.path = walker, .pos = {1, 0, 0}});
  const Scene scene = Scene::Build(spec);
  EXPECT_EQ(scene.compiled()->robot("robot").base.kind, BaseKind::kFree);
  EXPECT_SAME_POSE(scene.body_pose("torso"), Pose(Eigen::Vector3d(1, 0, 1)));
  spec.robots[0].base = BaseConfig{.kind = BaseKind::kMocap};
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "root 'torso' has a free joint of its own, so its base cannot be mocap");
}

}  // namespace
}  // namespace robocell::internal
