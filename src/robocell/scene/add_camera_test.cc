// Tests cameras of scenes and robots, and what makes a scene visible.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Cameras : public ::testing::Test {
 protected:
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  RobotConfig config = ArmConfig(folder.Write("arm", kTwoJointArm));
};

TEST_F(Cameras, LookAtAPointWithZUp) {
  spec.cameras.push_back(
      {.name = "eye", .pos = Vec3{1, 0, 1}, .fovy = 45, .look_at = Vec3{0, 0, 1}});
  const Scene scene = Scene::Build(spec);
  const Eigen::Matrix3d axes = scene.camera_pose("eye").rotation();
  EXPECT_TRUE(axes.col(2).isApprox(Eigen::Vector3d::UnitX(), 1e-9)) << "looks along its -z";
  EXPECT_TRUE(axes.col(1).isApprox(Eigen::Vector3d::UnitZ(), 1e-9));
  EXPECT_EQ(scene.model()->cam_fovy[0], 45);
}

TEST_F(Cameras, WarnAboutAFieldOfViewInRadians) {
  spec.cameras.push_back({.name = "eye", .pos = Vec3{1, 0, 1}, .fovy = 1.05});
  config.cameras.push_back(
      {.name = "wrist", .pos = Vec3{}, .fovy = 1.1, .attach_to = Body("base")});
  spec.robots.push_back({.config = config, .prefix = "r_"});
  const std::vector<std::string> warnings = Scene::Build(spec).compiled()->warnings();
  const char* text =
      "fovy is in degrees, and 1.05 degrees see next to nothing; 1.05 radians are "
      "60.2 degrees";
  EXPECT_THAT(warnings, Contains(AllOf(HasSubstr("camera 'eye'"), HasSubstr(text))));
  EXPECT_THAT(warnings, Contains(HasSubstr("camera 'wrist'")));
  EXPECT_EQ(warnings.size(), 2u);
}

TEST_F(Cameras, OfARobotCarryItsPrefixAndMoveWithIt) {
  config.cameras.push_back(
      {.name = "wrist", .pos = Vec3{0, 0, 0.1}, .fovy = 60, .attach_to = Site("flange")});
  config.cameras.push_back(
      {.name = "mast", .pos = Vec3{0, 0, 1}, .fovy = 60, .attach_to = Body("base")});
  config.cameras.push_back({.name = "elbow", .pos = Vec3{}, .fovy = 60, .attach_to = Body("fore")});
  spec.robots.push_back({.config = config, .prefix = "r_"});
  spec.cameras.push_back({.name = "overview", .pos = Vec3{1.8, -2, 1.4}, .fovy = 45});
  const Scene scene = Scene::Build(spec);
  EXPECT_THAT(scene.camera_names(),
              ::testing::UnorderedElementsAre("r_wrist", "r_mast", "r_elbow", "overview"));
  EXPECT_EQ(scene.model()->cam_fovy[RequireId(scene.model(), mjOBJ_CAMERA, "overview", "")], 45);
  EXPECT_TRUE(scene.camera_pose("r_wrist").is_close(
      scene.site_pose("r_flange") * Pose(Eigen::Vector3d(0, 0, 0.1)), 1e-9, 1e-9));
  EXPECT_TRUE(scene.camera_pose("r_mast").is_close(
      scene.body_pose("r_base") * Pose(Eigen::Vector3d(0, 0, 1)), 1e-9, 1e-9));
  EXPECT_TRUE(scene.camera_pose("r_elbow").is_close(scene.body_pose("r_fore"), 1e-9, 1e-9));
}

TEST_F(Cameras, OfTheSceneCanRideOnARobot) {
  spec.robots.push_back({.config = config, .prefix = "r_"});
  spec.cameras.push_back(
      {.name = "rider", .pos = Vec3{0, 0, 0.1}, .fovy = 60, .attach_to = Site("r_flange")});
  const Scene scene = Scene::Build(spec);
  EXPECT_TRUE(scene.camera_pose("rider").is_close(
      scene.site_pose("r_flange") * Pose(Eigen::Vector3d(0, 0, 0.1)), 1e-9, 1e-9));
}

TEST_F(Cameras, RejectInvalidAttachments) {
  config.cameras.push_back({.name = "eye", .pos = Vec3{}, .fovy = 60});
  spec.robots.push_back({.config = config, .prefix = "r_"});
  ExpectThrow<SpecError>(
      [&] { Scene::Build(spec); },
      "scene 'test' / robot 'r' / camera 'eye': a robot's camera is attached to a body, "
      "site or frame of the robot, not to the world");
  spec.robots[0].config->cameras[0].attach_to = Body("for");
  ExpectThrow<NotFoundError>([&] { Scene::Build(spec); },
                             "scene 'test' / robot 'r' / camera 'eye': attach_to: no body 'for'. "
                             "Known bodies: world, base, upper, fore. Did you mean 'fore'?");
}

TEST_F(Cameras, RejectDuplicateNames) {
  config.cameras.push_back({.name = "eye", .pos = Vec3{}, .fovy = 60, .attach_to = Body("fore")});
  spec.robots.push_back({.config = config, .prefix = ""});
  spec.cameras.push_back({.name = "eye", .pos = Vec3{}, .fovy = 60});
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "scene 'test' / camera 'eye': there is already a camera of this name");
}

// Returns the near end of a camera's depth range, from the model alone.
double Near(const mjModel* m) { return m->vis.map.znear * m->stat.extent; }
double Far(const mjModel* m) { return m->vis.map.zfar * m->stat.extent; }

TEST_F(Cameras, SeeFromOneCentimetreToAHundredMetresInAnyScene) {
  for (const double distance : {0.1, 3.0, 40.0}) {
    spec.objects = {BoxObject("a", {0, 0, 1}), BoxObject("b", {distance, 0, 1})};
    const Scene scene = Scene::Build(spec);
    EXPECT_NEAR(Near(scene.model()), 0.01, 1e-6);
    EXPECT_NEAR(Far(scene.model()), 100, 1e-3);
    char error[500] = "";
    const std::string file = (folder.path() / "saved.xml").string();
    scene.SaveXml(file);
    const ModelPtr saved(mj_loadXML(file.c_str(), nullptr, error, sizeof error));
    ASSERT_TRUE(saved) << error;
    EXPECT_NEAR(Near(saved.get()), 0.01, 1e-6) << "the saved file says the same";
  }
}

TEST_F(Cameras, HaveAFloorAndASkyOnRequest) {
  const Scene full = Scene::Build(spec);
  EXPECT_EQ(full.model()->ngeom, 1);
  EXPECT_EQ(full.model()->nlight, 2);
  EXPECT_EQ(full.model()->ntex, 2);
  spec.add_floor = spec.add_skybox = false;
  const Scene empty = Scene::Build(spec);
  EXPECT_EQ(empty.model()->ngeom + empty.model()->nlight + empty.model()->ntex, 0);
}

TEST_F(Cameras, KeepTheLightsOfTheBase) {
  spec.base = "tabletop";
  const Scene scene = Scene::Build(spec);
  EXPECT_EQ(scene.model()->nlight, 2);
  EXPECT_GE(FindId(scene.model(), mjOBJ_GEOM, "floor"), 0);
  spec.base = folder.Write(
      "lab", R"(<worldbody><geom name="floor" type="plane" size="1 1 1"/></worldbody>)");
  ExpectThrow<SpecError>(
      [&] { Scene::Build(spec); },
      "scene 'test': add_floor: the base has a geom 'floor' already; set add_floor to false");
}

TEST_F(Cameras, IncludeTheirHousing) {
  const std::string housing = folder.Write("housing", R"(<worldbody><body name="shell">
      <geom name="case" size="0.02"/><camera pos="0 0 0.1" fovy="70"/></body></worldbody>)");
  spec.cameras.push_back({.name = "eye", .mjcf_path = housing, .pos = Vec3{1, 0, 0}});
  config.cameras.push_back(
      {.name = "wrist", .mjcf_path = housing, .fovy = 50, .attach_to = Site("flange")});
  spec.robots.push_back({.config = config, .prefix = "r_"});
  const Scene scene = Scene::Build(spec);
  const Pose lens(Eigen::Vector3d(0, 0, 0.1));
  EXPECT_THAT(scene.camera_names(), ::testing::UnorderedElementsAre("eye", "r_wrist"));
  EXPECT_TRUE(scene.camera_pose("eye").is_close(Pose(Eigen::Vector3d(1, 0, 0.1)), 1e-9, 1e-9));
  EXPECT_TRUE(
      scene.camera_pose("r_wrist").is_close(scene.site_pose("r_flange") * lens, 1e-9, 1e-9));
  EXPECT_EQ(scene.model()->cam_fovy[FindId(scene.model(), mjOBJ_CAMERA, "eye")], 70);
  EXPECT_EQ(scene.model()->cam_fovy[FindId(scene.model(), mjOBJ_CAMERA, "r_wrist")], 50);
  EXPECT_GE(FindId(scene.model(), mjOBJ_GEOM, "eye_case"), 0);
  EXPECT_GE(FindId(scene.model(), mjOBJ_GEOM, "r_wrist_case"), 0);
}

TEST_F(Cameras, AHousingHoldsOneCamera) {
  spec.cameras.push_back(
      {.name = "eye", .mjcf_path = folder.Write("two", R"(<worldbody><body name="shell">
      <geom size="0.02"/><camera name="a"/><camera name="b"/></body></worldbody>)")});
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "camera 'eye': a camera's model holds one camera, " +
                             (folder.path() / "two.xml").string() + " holds 2: a, b");
}

}  // namespace
}  // namespace robocell::internal
