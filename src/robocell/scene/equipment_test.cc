// Tests that the built-in equipment works: it stands, opens, holds poured objects, and has the
// stated mass.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <map>

#include "robocell/assets/resolve.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell {
namespace {

struct Expected {
  double origin_height;  // above its support, metres
  double mass;           // kg
};

const std::map<std::string, Expected> kEquipment = {
    {"button_panel", {0, 1.39}},      {"cabinet", {0, 21.2}},
    {"cupboard", {0, 3.017}},         {"d405", {0, 0.06}},
    {"drawer_unit", {0, 5.15}},       {"faucet", {0, 1.52}},
    {"fr3_duo_mount", {0, 35}},       {"ft_sensor", {0, 0.25}},
    {"green_cube", {0.02, 0.05}},     {"laptop", {0, 1.8}},
    {"lid_box", {0, 1.35}},           {"microwave", {0, 10.67}},
    {"open_bottle", {0.075, 0.115}},  {"parallel_hand", {0, 0.72}},
    {"plug", {0.065, 0.08}},          {"receiver", {0.04, 0.18}},
    {"robotiq_d405_mount", {0, 0.1}}, {"round_hole", {0.021, 2.5}},
    {"socket", {0.021, 2.5}},         {"square_hole", {0.021, 2.5}},
    {"table", {0.7, 28.74}},          {"tray", {0.009, 0.3}}};
// Marks that touch nothing and stay where they are put.
constexpr const char* kMarks[] = {"region", "studio", "wiping_area"};

Scene BuildCabinet() {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "c", .mjcf_path = "cabinet", .fixed = true});
  return Scene::Build(spec);
}

double Joint(const Scene& scene, const std::string& name) {
  const int joint = RequireId(scene.model(), mjOBJ_JOINT, name, "test");
  return scene.data()->qpos[scene.model()->jnt_qposadr[joint]];
}

double Speed(const Scene& scene, const std::string& name) {
  const int joint = RequireId(scene.model(), mjOBJ_JOINT, name, "test");
  return scene.data()->qvel[scene.model()->jnt_dofadr[joint]];
}

TEST(Equipment, RestsOnAFloorWithItsSpecifiedMass) {
  std::vector<std::string> names;
  for (const auto& [name, expected] : kEquipment) names.push_back(name);
  std::vector<std::string> with_mass = assets::BuiltinEquipment();
  for (const char* mark : kMarks) EXPECT_EQ(std::erase(with_mass, mark), 1u);
  EXPECT_EQ(names, with_mass);
  for (const auto& [name, expected] : kEquipment) {
    SceneSpec spec = EmptyScene();
    const Pose start(Eigen::Vector3d(0, 0, expected.origin_height));
    spec.objects.push_back({.name = "o",
                            .mjcf_path = name,
                            .pos = Vec3{0, 0, expected.origin_height},
                            .fixed = false});
    Scene scene = Scene::Build(spec);
    const std::string body = scene.compiled()->object("o").root_body;
    const int id = RequireId(scene.model(), mjOBJ_BODY, body, "test");
    EXPECT_NEAR(scene.model()->body_subtreemass[id], expected.mass, 0.005 * expected.mass) << name;
    const StepResult result = scene.StepN(1000);
    ASSERT_TRUE(result.ok()) << name << ": " << result.message;
    EXPECT_TRUE(scene.body_pose(body).is_close(start, 0.01, 0.002)) << name;
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(scene.data()->qvel[i], 0, 1e-3) << name;
    for (const Contact& contact : scene.contacts("o_" + name))
      EXPECT_NE(contact.body1, contact.body2) << name << " touches itself";
  }
}

TEST(Equipment, ATablesSiteIsTheMiddleOfItsTop) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(
      {.name = "table", .mjcf_path = "table", .pos = Vec3{0.3, 0.1, 0.7}, .fixed = true});
  spec.objects.push_back(BoxObject("cube", {0.35, 0.1, 0.73}));
  Scene scene = Scene::Build(spec);
  EXPECT_TRUE(scene.site_pose(SceneObjectElementName("table", "table_top"))
                  .is_close(Pose(Eigen::Vector3d(0.3, 0.1, 0.7)), 1e-9, 1e-9));
  ASSERT_TRUE(scene.StepN(500).ok());
  EXPECT_NEAR(scene.body_pose("cube").translation().z(), 0.72, 1e-3) << "it lies on the table";
}

TEST(Equipment, ARobotCanBeMountedOnATable) {
  SceneSpec spec = EmptyScene();
  const SceneObject table{
      .name = "table", .mjcf_path = "table", .pos = Vec3{0.3, 0.1, 0.7}, .fixed = true};
  const std::string mount = SceneObjectElementName(table.name, "table_top");
  spec.robots.push_back({.config = RobotConfig::Load(assets::BuiltinRobotFile("rc7")),
                         .base = BaseConfig{},  // without its pedestal
                         .attach_to = Site(mount),
                         .pos = {0, 0.2, 0}});
  spec.objects.push_back(table);
  const Scene scene = Scene::Build(spec);
  EXPECT_TRUE(scene.body_pose("base_link")
                  .is_close(scene.site_pose(mount) * Pose(Eigen::Vector3d(0, 0.2, 0)), 1e-9, 1e-9));
  EXPECT_NEAR(scene.body_pose("base_link").translation().z(), 0.7, 1e-9);
}

TEST(Equipment, ACabinetsDoorAndDrawerOpenWhenPulledAndStayThere) {
  Scene scene = BuildCabinet();
  EXPECT_TRUE(scene.contacts("c_cabinet").empty()) << "closed, nothing rubs";
  ASSERT_TRUE(scene.StepN(500).ok());
  EXPECT_NEAR(Joint(scene, "c_door_hinge"), 0, 1e-6) << "closed, they stay closed";
  EXPECT_NEAR(Joint(scene, "c_drawer_slide"), 0, 1e-6);
  const Pose handle = scene.site_pose("c_door_handle");
  scene.SetBodyWrench("c_door", {3, 0, 0}, {0, 0, 0});
  scene.SetBodyWrench("c_drawer", {4, 0, 0}, {0, 0, 0});
  ASSERT_TRUE(scene.StepN(300).ok());
  scene.SetBodyWrench("c_door", {0, 0, 0}, {0, 0, 0});
  scene.SetBodyWrench("c_drawer", {0, 0, 0}, {0, 0, 0});
  ASSERT_TRUE(scene.StepN(2000).ok());
  EXPECT_GT(Joint(scene, "c_door_hinge"), 0.5);
  EXPECT_LT(Joint(scene, "c_door_hinge"), 1.9) << "short of its stop";
  EXPECT_GT(Joint(scene, "c_drawer_slide"), 0.05);
  EXPECT_LT(Joint(scene, "c_drawer_slide"), 0.27) << "short of its stop";
  EXPECT_GT(scene.site_pose("c_door_handle").translation().x(), handle.translation().x() + 0.1);
  EXPECT_NEAR(Speed(scene, "c_door_hinge"), 0, 1e-3) << "they stay where they were left";
  EXPECT_NEAR(Speed(scene, "c_drawer_slide"), 0, 1e-3);
  EXPECT_TRUE(scene.contacts("c_cabinet").empty()) << "open, nothing rubs";
}

TEST(Equipment, DoorAndDrawerStopAtTheirRange) {
  Scene scene = BuildCabinet();
  scene.SetBodyWrench("c_door", {0, 0, 0}, {0, 0, 4});
  scene.SetBodyWrench("c_drawer", {20, 0, 0}, {0, 0, 0});
  ASSERT_TRUE(scene.StepN(1500).ok());
  EXPECT_NEAR(Joint(scene, "c_door_hinge"), 2, 0.02);
  EXPECT_NEAR(Joint(scene, "c_drawer_slide"), 0.28, 0.005);
}

TEST(Equipment, ADrawerHoldsItsContents) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "c", .mjcf_path = "cabinet", .fixed = true});
  spec.objects.push_back(BoxObject("cube", {0.03, 0, 0.055}));
  Scene scene = Scene::Build(spec);
  scene.SetBodyWrench("c_drawer", {8, 0, 0}, {0, 0, 0});
  ASSERT_TRUE(scene.StepN(1000).ok());
  EXPECT_NEAR(Joint(scene, "c_drawer_slide"), 0.28, 0.005);
  EXPECT_GT(scene.body_pose("cube").translation().x(), 0.2) << "it came out with the drawer";
  EXPECT_GT(scene.body_pose("cube").translation().z(), 0.04) << "it lies in it";
}

// Upside down over the receiver, as at the end of pouring.
TEST(Equipment, ContentsOfTheBottleStayInTheReceiver) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "receiver", .mjcf_path = "receiver", .pos = Vec3{0, 0, 0.04}});
  spec.objects.push_back({.name = "bottle",
                          .mjcf_path = "open_bottle",
                          .pos = Vec3{0, 0, 0.2},
                          .euler = {180, 0, 0},
                          .fixed = true});
  spec.objects.push_back(
      {.name = "upright", .mjcf_path = "open_bottle", .pos = Vec3{0.3, 0, 0.075}, .fixed = true});
  for (const auto& [name, x] : {std::pair{"poured", 0.012}, {"kept", 0.312}}) {
    spec.objects.push_back({.name = name,
                            .shape = Shape::kSphere,
                            .size = Vec3{0.006, 0, 0},
                            .rgba = Vec4{1, 1, 1, 1},
                            .mass = 0.001,
                            .friction = Vec3{0.5, 0.01, 0.001},
                            .condim = Condim::kRolling,
                            .pos = Vec3{x, 0, x < 0.1 ? 0.22 : 0.04}});
  }
  Scene scene = Scene::Build(spec);
  ASSERT_TRUE(scene.StepN(1000).ok());
  const Eigen::Vector3d poured = scene.body_pose("poured").translation();
  const Eigen::Vector3d kept = scene.body_pose("kept").translation();
  EXPECT_LT(poured.head<2>().norm(), 0.06) << poured.transpose();
  EXPECT_NEAR(poured.z(), 0.014, 0.003) << "on the receiver's bottom";
  EXPECT_LT((kept - Eigen::Vector3d(0.3, 0, 0)).head<2>().norm(), 0.03) << kept.transpose();
  EXPECT_NEAR(kept.z(), 0.014, 0.003) << "on the bottle's bottom";
}

}  // namespace
}  // namespace robocell
