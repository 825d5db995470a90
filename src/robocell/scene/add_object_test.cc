// Tests objects of a scene: primitives, models, free and fixed ones.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

Scene BuildWith(const SceneObject& object) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(object);
  return Scene::Build(spec);
}

class Objects : public ::testing::Test {
 protected:
  ModelFolder folder;
  std::string cup = folder.Write(
      "cup",
      R"(<worldbody><body name="cup" pos="0 0 0.1"><geom size="0.05"/><site name="rim"/></body></worldbody>)");
  std::string drawer = folder.Write("drawer", R"(<worldbody><body name="case"><geom size="0.2"/>
      <body name="tray"><joint name="slide" type="slide" axis="1 0 0" range="0 0.3" limited="true"/><geom size="0.1"/></body></body></worldbody>
      <keyframe><key name="home" qpos="0.25"/></keyframe>)");
  std::string ball = folder.Write(
      "ball", R"(<worldbody><body><freejoint/><geom size="0.05"/></body></worldbody>)");
};

TEST_F(Objects, APrimitiveFallsAndRests) {
  SceneObject cube = BoxObject("red_cube", {0.35, 0.1, 0.3});
  cube.condim = Condim::kTorsional;
  Scene scene = BuildWith(cube);
  EXPECT_EQ(scene.model()->geom_condim[RequireId(scene.model(), mjOBJ_GEOM, "red_cube_geom", "")],
            4);
  ASSERT_TRUE(scene.StepN(50).ok());
  EXPECT_LT(scene.body_pose("red_cube").translation().z(), 0.26) << "it falls";
  ASSERT_TRUE(scene.StepN(450).ok());
  EXPECT_TRUE(
      scene.body_pose("red_cube").is_close(Pose(Eigen::Vector3d(0.35, 0.1, 0.02)), 1e-2, 1e-3));
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(scene.data()->qvel[i], 0, 1e-3) << "it rests";
}

TEST_F(Objects, PrimitivesHaveTheirShapeMassAndNames) {
  SceneObject can{.name = "can",
                  .shape = Shape::kCylinder,
                  .size = Vec3{0.03, 0.06, 0},
                  .rgba = Vec4{0.1, 0.2, 0.3, 1},
                  .mass = 0.35,
                  .friction = Vec3{0.7, 0.02, 0.003},
                  .condim = Condim::kRolling,
                  .pos = Vec3{0, 0, 0.06}};
  const Scene scene = BuildWith(can);
  const mjModel* m = scene.model();
  const int body = RequireId(m, mjOBJ_BODY, "can", ""),
            geom = RequireId(m, mjOBJ_GEOM, "can_geom", "");
  EXPECT_EQ(m->jnt_type[RequireId(m, mjOBJ_JOINT, "can_joint", "")], mjJNT_FREE);
  EXPECT_NEAR(m->body_mass[body], 0.35, 1e-12);
  EXPECT_EQ(m->geom_type[geom], mjGEOM_CYLINDER);
  EXPECT_EQ(m->geom_size[3 * geom + 1], 0.06);
  EXPECT_EQ(m->geom_friction[3 * geom + 2], 0.003);
  EXPECT_EQ(m->geom_condim[geom], 6);
  EXPECT_FLOAT_EQ(m->geom_rgba[4 * geom + 2], 0.3f);
}

TEST_F(Objects, ModelsArePrefixedWithTheirName) {
  const Scene scene = BuildWith({.name = "red", .mjcf_path = cup, .pos = Vec3{1, 0, 0}});
  EXPECT_TRUE(scene.site_pose(SceneObjectElementName("red", "rim"))
                  .is_close(Pose(Eigen::Vector3d(1, 0, 0.1)), 1e-9, 1e-9));
  EXPECT_EQ(scene.compiled()->object("red").root_body, "red_cup");
}

TEST_F(Objects, AreFixedOrFreeAsAuthoredOrConfigured) {
  const auto free_joint = [&](const std::string& model, std::optional<bool> fixed) {
    return BuildWith({.name = "x", .mjcf_path = model, .fixed = fixed})
        .compiled()
        ->object("x")
        .free_joint;
  };
  EXPECT_EQ(free_joint(cup, {}), std::nullopt);
  EXPECT_EQ(free_joint(cup, true), std::nullopt);
  EXPECT_EQ(free_joint(cup, false), "x_joint");
  EXPECT_EQ(free_joint(ball, {}), "x_joint");
  EXPECT_EQ(free_joint(ball, true), std::nullopt);
  EXPECT_EQ(free_joint(drawer, {}), std::nullopt);
  EXPECT_EQ(free_joint(drawer, false), "x_joint");
  SceneObject cube = BoxObject("cube", {});
  cube.fixed = true;
  EXPECT_EQ(BuildWith(cube).compiled()->object("cube").free_joint, std::nullopt);
}

TEST_F(Objects, WithARootJointAreNeitherFreeNorFixed) {
  for (const char* type : {"slide", "hinge", "ball"}) {
    const std::string model =
        folder.Write(type, fmt::format(R"(<worldbody><body name="lid"><joint name="turn" type="{}"/>
                             <geom size="0.05"/></body></worldbody>)",
                                       type));
    for (const bool fixed : {true, false}) {
      ExpectThrow<SpecError>([&] { BuildWith({.name = "x", .mjcf_path = model, .fixed = fixed}); },
                             "object 'x': its root body has the joint 'turn', which it moves "
                             "on, so that it can be neither fixed nor free");
    }
    EXPECT_EQ(BuildWith({.name = "x", .mjcf_path = model}).model()->njnt, 1);
    ExpectThrow<SpecError>([&] { BuildWith({.name = "x", .mjcf_path = model, .parked = true}); },
                           "its root body has the joint 'turn'");
  }
  const std::string marker = folder.Write(
      "marker", R"(<worldbody><body name="m" mocap="true"><geom size="0.05"/></body></worldbody>)");
  EXPECT_EQ(BuildWith({.name = "x", .mjcf_path = marker, .fixed = true}).model()->nmocap, 1);
  ExpectThrow<SpecError>([&] { BuildWith({.name = "x", .mjcf_path = marker, .fixed = false}); },
                         "its root is a mocap body, which moves only where it is put");
}

TEST_F(Objects, OfUnnamedPartsCanStillBeFound) {
  Scene scene = BuildWith({.name = "ball", .mjcf_path = ball});
  EXPECT_EQ(scene.compiled()->object("ball").root_body, "ball_body");
  scene.SetBodyPose("ball_body", Pose(Eigen::Vector3d(1, 2, 3)));
  EXPECT_TRUE(scene.body_pose("ball_body").is_close(Pose(Eigen::Vector3d(1, 2, 3)), 1e-12, 1e-12));
}

TEST_F(Objects, StartAtTheirHomeKey) {
  const Scene scene = BuildWith({.name = "d", .mjcf_path = drawer});
  EXPECT_EQ(
      scene.data()
          ->qpos[scene.model()->jnt_qposadr[RequireId(scene.model(), mjOBJ_JOINT, "d_slide", "")]],
      0.25);
}

TEST_F(Objects, FreeOnesAttachOnlyToTheWorld) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "table", .mjcf_path = cup});
  SceneObject cube = BoxObject("cube", {});
  cube.attach_to = Site("table_rim");
  spec.objects.push_back(cube);
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "scene 'test' / object 'cube': can move freely, so it cannot be attached "
                         "to site 'table_rim'; attach it to the world, or set fixed: true");
}

TEST_F(Objects, RejectANameOfARobotElement) {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.name = "arm", .path = folder.Write("arm", kTwoJointArm)});
  spec.objects.push_back(BoxObject("upper", {0.5, 0, 0.02}));
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "object 'upper': body 'upper' is in robot 'arm' already, and the object "
                         "would bring another one; give the object another name");
}

TEST_F(Objects, ReportErrorsOfTheirModels) {
  const std::string two = folder.Write(
      "two",
      R"(<worldbody><body name="a"><geom size="1"/></body><body name="b"><geom size="1"/></body></worldbody>)");
  const std::string none = folder.Write("none", R"(<worldbody><geom size="1"/></worldbody>)");
  SceneSpec spec = EmptyScene();
  spec.objects = {{.name = "p", .mjcf_path = two},
                  {.name = "q", .mjcf_path = none},
                  {.name = "r", .mjcf_path = "mugg"}};
  const std::string message =
      ExpectThrow<SpecError>([&] { Scene::Build(spec); }, "scene 'test' has 3 problems:");
  EXPECT_THAT(message,
              ::testing::HasSubstr("object 'p': " + two +
                                   " has 2 root bodies: a, b; only one can be placed: put them "
                                   "into one body in that file, or make a file of each"));
  EXPECT_THAT(message, ::testing::HasSubstr("object 'q': " + none + " has no body to attach"));
  EXPECT_THAT(message, ::testing::HasSubstr("object 'r': model 'mugg' not found."));
  EXPECT_THAT(message, ::testing::HasSubstr("Did you mean 'mug'?"));
}

TEST_F(Objects, OfASceneFileAreFoundInItsFolder) {
  SceneSpec spec = EmptyScene();
  spec.objects = {{.name = "a", .mjcf_path = "cup.xml"}};
  spec.robots.push_back(
      {.path = "drawer.xml",
       .attachments = {{.mjcf_path = "cup.xml", .attach_to = Body("tray"), .prefix = "t_"}}});
  spec.base = "ball.xml";
  spec.source_dir = folder.path().string();
  EXPECT_EQ(Scene::Build(spec).model()->nbody, 1 + 1 + 1 + 3);
}

TEST_F(Objects, OfEveryBuiltInKindFallAndComeToRest) {
  for (const std::string& name : assets::BuiltinObjects()) {
    Scene scene =
        BuildWith({.name = "o", .mjcf_path = name, .pos = Vec3{0, 0, 0.3}, .fixed = false});
    const StepResult result = scene.StepN(1000);
    ASSERT_TRUE(result.ok()) << name << ": " << result.message;
    EXPECT_LT(scene.body_pose(scene.compiled()->object("o").root_body).translation().z(), 0.2)
        << name;
  }
}

TEST_F(Objects, RejectAMassTooSmallForTheEngine) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(BoxObject("c", {0, 0, 1}));
  spec.objects[0].mass = 1e-20;
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "scene 'test' / object 'c': body 'c': mass and inertia of moving bodies "
                         "must be larger than mjMINVAL; give the object a greater `mass`");
}

}  // namespace
}  // namespace robocell::internal
