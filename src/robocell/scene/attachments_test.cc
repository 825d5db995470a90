#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/arm_scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Attachments : public ArmScenes {};

TEST_F(Attachments, MountToolsOnToolsWithAllElements) {
  config.attachments.push_back({.mjcf_path = gripper,
                                .attach_to = Site("flange"),
                                .prefix = "g_",
                                .pos = Vec3{0, 0, 0.02},
                                .contact_exclusions = {{"fore", "g_left"}}});
  const std::string probe = folder.Write(
      "probe",
      R"(<worldbody><body name="needle"><geom size="0.005" pos="0 0 0.02"/></body></worldbody>)");
  SceneSpec spec = ArmScene();
  spec.robots[0].attachments.push_back(
      {.mjcf_path = probe, .attach_to = Body("g_palm"), .prefix = "p_", .euler = {0, 90, 0}});
  const Scene scene = Scene::Build(spec);
  const Pose palm = scene.site_pose("l_flange") * Pose(Eigen::Vector3d(0, 0, 0.03));
  EXPECT_TRUE(scene.body_pose("l_g_palm").is_close(palm, 1e-9, 1e-9));
  EXPECT_TRUE(scene.body_pose("l_p_needle")
                  .is_close(palm * Pose::FromRpy({0, 0, 0}, {0, M_PI / 2, 0}), 1e-9, 1e-9));
  const mjModel* m = scene.model();
  EXPECT_EQ(m->nu, 3 + 2) << "and motors of the arm";
  EXPECT_EQ(m->neq, 1);
  EXPECT_EQ(m->ntendon, 1);
  ASSERT_EQ(m->nexclude, 1);
  EXPECT_EQ(m->exclude_signature[0], (RequireId(m, mjOBJ_BODY, "l_fore", "") << 16) +
                                         RequireId(m, mjOBJ_BODY, "l_g_left", ""));
  EXPECT_THAT(scene.compiled()->warnings(), IsEmpty());
}

TEST_F(Attachments, SuggestAPrefixForNameCollisions) {
  const std::string twin = folder.Write(
      "twin", R"(<worldbody><body name="upper"><geom size="0.005"/></body></worldbody>)");
  SceneSpec spec = ArmScene();
  spec.robots[0].attachments.push_back({.mjcf_path = twin, .attach_to = Body("fore")});
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "scene 'test' / robot 'left' / attachment '" + twin +
                             "': body 'upper' would come from " + twin + " and is in " +
                             config.model +
                             " already; set the attachment's `prefix`, which its names begin with "
                             "then");
}

// The engine rejects duplicate meshes and materials when they are attached, joints when it
// compiles.
constexpr const char* kRing = R"(
  <asset><mesh name="ring" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/><material name="red"/></asset>
  <worldbody><body name="{0}base"><geom type="mesh" mesh="ring" material="red"/>
    <body name="{0}tip"><joint name="turn"/><geom name="{0}geom" size="0.1"/></body></body>
    <geom name="floor" size="0.1"/></worldbody>
  <actuator><motor name="{0}push" joint="turn"/></actuator>)";

TEST_F(Attachments, ReportAllNamesSharedWithATool) {
  config = {.name = "arm", .model = folder.Write("ringed", fmt::format(kRing, "a_"))};
  const std::string tool = folder.Write("tool", fmt::format(kRing, "t_"));
  config.attachments.push_back({.mjcf_path = tool, .attach_to = Body("a_tip")});
  ExpectThrow<SpecError>([&] { BuildArm(); },
                         "joint 'turn', mesh 'ring', material 'red' would come from " + tool +
                             " and are in " + config.model + " already; set the attachment's");
  config.attachments[0].prefix = "t_";
  EXPECT_EQ(BuildArm().model()->nmesh, 2);
}

TEST_F(Attachments, RejectAPrefixThatCausesNameCollisions) {
  const std::string tool = folder.Write(
      "tool", R"(<worldbody><body name="per"><geom size="0.005"/></body></worldbody>)");
  config.attachments.push_back({.mjcf_path = tool, .attach_to = Body("fore"), .prefix = "up"});
  ExpectThrow<SpecError>([&] { BuildArm(); },
                         "body 'upper' would come from " + tool + " and is in " + config.model +
                             " already; give the attachment another `prefix` than 'up'");
}

TEST_F(Attachments, MountChainsOfTools) {
  const std::string link = folder.Write("link", R"(
  <worldbody><body name="bar" pos="0.01 0 0" euler="0 20 30">
    <geom type="capsule" fromto="0 0 0 0 0 0.03" size="0.005"/><site name="tip" pos="0 0 0.03"/>
  </body></worldbody>)");
  const Pose authored =
      Pose::FromRpy({0.01, 0, 0}, {0, internal::Radians(20), 0}) *
      Pose::FromRpy({0, 0, 0}, {0, 0, internal::Radians(30)});  // about the turned axes
  SceneSpec spec = ArmScene();
  std::string site = "flange";
  for (int i = 0; i < 5; ++i) {
    const std::string prefix = fmt::format("t{}_", i);
    spec.robots[0].attachments.push_back(
        {.mjcf_path = link, .attach_to = Site(site), .prefix = prefix});
    site = prefix + "tip";
  }
  const Scene scene = Scene::Build(spec);
  Pose expected = scene.site_pose("l_flange");
  for (int i = 0; i < 5; ++i) {
    expected = expected * authored * Pose(Eigen::Vector3d(0, 0, 0.03));
    EXPECT_TRUE(scene.site_pose(fmt::format("l_t{}_tip", i)).is_close(expected, 1e-9, 1e-9)) << i;
  }
}

TEST_F(Attachments, RejectInvalidToolMounts) {
  config.attachments.push_back({.mjcf_path = gripper, .attach_to = Site("flang"), .prefix = "g_"});
  ExpectThrow<NotFoundError>(
      [&] { BuildArm(); },
      "scene 'test' / robot 'left' / attachment 'g_': attach_to: no site 'flang'. "
      "Known sites: flange. Did you mean 'flange'?");
  config.attachments[0].attach_to = Site("flange");
  config.attachments[0].contact_exclusions = {{"fore", "g_leff"}};
  ExpectThrow<NotFoundError>([&] { BuildArm(); },
                             "contact_exclusions: the robot: no body 'g_leff'");
  config.attachments[0].mjcf_path = "griper.xml";
  const std::string message =
      ExpectThrow<NotFoundError>([&] { BuildArm(); },
                                 "scene 'test' / robot 'left' / attachment 'g_': model file "
                                 "'griper.xml' not found. Looked for: ");
  EXPECT_THAT(message, HasSubstr("ROBOCELL_MODEL_PATH"));
  config.attachments[0].prefix = "";
  ExpectThrow<NotFoundError>([&] { BuildArm(); }, "robot 'left' / attachment 'griper.xml': model");
}

}  // namespace
}  // namespace robocell
