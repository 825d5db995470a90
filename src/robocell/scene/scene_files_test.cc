// Tests that saved scenes load in stock MuJoCo and are the same models.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/mujoco/compile.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/model_compare.h"
#include "robocell/scene/testing/robots.h"
#include "robocell/scene/testing/saved.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

SceneSpec Kitchen() {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back(
      {.config = RobotConfig::Load(assets::BuiltinRobotFile("rc7")), .prefix = "left_"});
  spec.objects.push_back(BoxObject("cube", {0.4, 0, 0.02}));
  spec.objects.push_back(
      {.name = "mug", .mjcf_path = "mug", .pos = Vec3{0.4, 0.3, 0.06}, .fixed = false});
  return spec;
}

TEST(SavedScene, LoadsFromXmlToSixDigits) {
  const TempDir folder;
  EXPECT_EQ(DifferencesAfterXml(Scene::Build(Kitchen()), folder / "scene.xml"), "");
}

TEST(SavedScene, LoadsFromBinaryBitwise) {
  const TempDir folder;
  const Scene scene = Scene::Build(Kitchen());
  scene.SaveBinary((folder / "scene.mjb").string());
  const ModelPtr loaded = LoadBinary(folder / "scene.mjb");
  EXPECT_EQ(ModelDifferences(scene.model(), loaded.get(), 0), "");
}

TEST(SavedScene, KeepsAssetsOfSeveralFoldersAndAnEmptyPrefix) {
  REQUIRE_MENAGERIE("ufactory_xarm7", "kinova_gen3", "robotiq_2f85");
  SceneSpec spec = EmptyScene();
  spec.robots = {Gen3With2F85(), XArm7With2F85("x_")};
  spec.robots[1].pos = {0, 1, 0};
  const TempDir folder;
  EXPECT_EQ(DifferencesAfterXml(Scene::Build(spec), folder / "scene.xml"), "");
}

TEST(SavedScene, IsIndependentOfLaterCompilations) {
  const TempDir folder;
  const Scene scene = Scene::Build(Kitchen());
  SceneSpec other_spec = EmptyScene();
  other_spec.objects.push_back(BoxObject("other", {0, 0, 1}));
  const Scene other = Scene::Build(other_spec);
  EXPECT_EQ(DifferencesAfterXml(scene, folder / "scene.xml"), "");
  const ModelPtr in_between = LoadBinary([&] {
    other.SaveBinary((folder / "other.mjb").string());
    return folder / "other.mjb";
  }());
  scene.SaveBinary((folder / "scene.mjb").string());
  EXPECT_EQ(ModelDifferences(scene.model(), LoadBinary(folder / "scene.mjb").get(), 0), "");
  EXPECT_EQ(ModelDifferences(other.model(), in_between.get(), 0), "");
}

// A model whose default classes have common names.
std::string ModelWithClasses(const std::string& name, double size, int group) {
  return fmt::format(R"(
    <mujoco model="{0}">
      <default>
        <geom friction="0.{2}"/>
        <default class="visual"><geom group="{2}" contype="0" conaffinity="0"/>
          <default class="shiny"><geom rgba="0 0 0.{2} 1"/></default></default>
      </default>
      <worldbody><body name="{0}" childclass="visual"><joint name="{0}_joint" axis="0 0 1"/>
        <frame childclass="shiny"><geom size="{1}"/></frame><geom size="{1}" pos="0 0 1"/>
        <site name="{0}_site" pos="0 0 0.1"/></body></worldbody>
    </mujoco>)",
                     name, size, group);
}

TEST(SavedScene, DistinguishesDefaultClassesWithEqualNames) {
  const TempDir folder;
  const auto write = [&](const std::string& name, double size, int group) {
    std::ofstream(folder / (name + ".xml")) << ModelWithClasses(name, size, group);
    return (folder / (name + ".xml")).string();
  };
  SceneSpec spec = EmptyScene();
  spec.base = write("lab", 0.3, 1);
  spec.robots.push_back(
      {.path = write("arm", 0.2, 2),
       .attachments = {{.mjcf_path = write("hand", 0.1, 3), .attach_to = Site("arm_site")}}});
  spec.objects.push_back({.name = "toy", .mjcf_path = write("thing", 0.05, 4)});
  const Scene scene = Scene::Build(spec);
  EXPECT_EQ(DifferencesAfterXml(scene, folder / "scene.xml"), "");
  EXPECT_THAT(scene.compiled()->warnings(), ::testing::IsEmpty());
}

// The smallest PNG file: one grey pixel.
constexpr unsigned char kPng[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48,
    0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x00, 0x00, 0x00,
    0x00, 0x3a, 0x7e, 0x9b, 0x55, 0x00, 0x00, 0x00, 0x0a, 0x49, 0x44, 0x41, 0x54, 0x78,
    0x9c, 0x63, 0x68, 0x00, 0x00, 0x00, 0x82, 0x00, 0x81, 0x77, 0xcd, 0x72, 0xb6, 0x00,
    0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

TEST(SavedScene, RefersToMeshesAndTexturesByAbsolutePaths) {
  const TempDir folder;
  namespace fs = std::filesystem;
  for (const char* name : {"model/shapes", "model/pictures", "out"})
    fs::create_directories(folder / name);
  std::ofstream(folder / "model/shapes/tetra.obj")
      << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  std::ofstream(folder / "model/pictures/grey.png", std::ios::binary)
      .write(reinterpret_cast<const char*>(kPng), sizeof kPng);
  std::ofstream(folder / "model/toy.xml")
      << R"(<mujoco><compiler meshdir="shapes" texturedir="pictures" strippath="true"/>
      <asset><mesh name="tetra" file="elsewhere/tetra.obj"/><texture name="grey" type="2d" file="grey.png"/><material name="m" texture="grey"/></asset>
      <worldbody><body name="toy"><geom type="mesh" mesh="tetra" material="m"/></body></worldbody></mujoco>)";
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "toy", .mjcf_path = (folder / "model/toy.xml").string()});
  const Scene scene = Scene::Build(spec);
  EXPECT_EQ(DifferencesAfterXml(scene, folder / "out/scene.xml"), "");
  EXPECT_THAT(scene.ToXml(), ::testing::HasSubstr(
                                 "file=\"" + (folder / "model/pictures/grey.png").string() + "\""));
}

TEST(SavedScene, HasLaterEditsOfTheModel) {
  const Scene built = Scene::Build(Kitchen());
  Scene scene = built;
  const int cube = mj_name2id(scene.model(), mjOBJ_GEOM, "cube_geom");
  scene.mutable_model()->geom_friction[3 * cube] = 0.123;
  scene.mutable_model()->opt.gravity[2] = -1.625;
  const TempDir folder;
  EXPECT_EQ(DifferencesAfterXml(scene, folder / "scene.xml"), "");
  EXPECT_THAT(scene.ToXml(), ::testing::HasSubstr("0.123"));
  EXPECT_THAT(scene.ToXml(), ::testing::HasSubstr("-1.625"));
}

TEST(SavedScene, HasTheHomeKeyWithItsNumbers) {
  const bool found =
      Scene::Build(Kitchen()).ToXml().find(
          R"(0 -0.15 0 1.9 0 1.39159 0 0.044 0.044" ctrl="0 -0.15 0 1.9 0 1.39159 0 100 0 0 0 0 0 0 0")") !=
      std::string::npos;
  EXPECT_TRUE(found);
}

TEST(SavedScene, NamesAFileThatCannotBeWritten) {
  const Scene scene = Scene::Build(Kitchen());
  ExpectThrow<IoError>([&] { scene.SaveXml("/nowhere/scene.xml"); },
                       "scene 'test': cannot write '/nowhere/scene.xml'");
  ExpectThrow<IoError>([&] { scene.SaveBinary("/nowhere/scene.mjb"); }, "/nowhere/scene.mjb");
}

}  // namespace
}  // namespace robocell
