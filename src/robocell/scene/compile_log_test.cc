// Tests that problems found while a scene is compiled name the part's place in its file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/scene/testing/robot_files.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

using Located = RobotFiles;

TEST_F(Located, AllProblemsOfOneFileAreUnderItsName) {
  const std::string file = RobotFile(
      "move_groups:\n"
      "  arm: {joints: [shoulder, elbow], leaf: {site: flang}}\n"
      "home: {arm: [0, 3]}\n");
  const std::string message =
      ExpectThrow<SpecError>([&] { BuildRobot(file); }, file + " has 2 problems:");
  EXPECT_THAT(message,
              AllOf(HasSubstr("\n  " + file + ":4:42: robot 'left': move_groups.arm.leaf: "),
                    HasSubstr("\n  " + file + ":5:13: robot 'left': home.arm: 3 is outside"),
                    Not(HasSubstr("scene"))));
}

TEST_F(Located, Edits) {
  const std::string file = RobotFile(
      "edits:\n"
      "  - {body: base, pos: [0, 0, 0]}\n"
      "  - {site: flang, pos: [0, 0, 0]}\n");
  ExpectThrow<NotFoundError>([&] { BuildRobot(file); },
                             file + ":5:5: robot 'left' / edits[1]: the model: no site 'flang'");
}

TEST_F(Located, AttachmentsAndRootAndCameras) {
  folder.Write("tool", R"(<worldbody><body name="t"><geom size="0.01"/></body></worldbody>)");
  const std::string file = RobotFile(
      "attachments:\n"
      "  - {mjcf_path: tool.xml, prefix: t_, attach_to: {site: flang}}\n"
      "cameras:\n"
      "  - {name: eye, pos: [0, 0, 0], fovy: 45, attach_to: {body: hed}}\n");
  const std::string message =
      ExpectThrow<NotFoundError>([&] { BuildRobot(file); }, file + " has 2 problems:");
  EXPECT_THAT(message, AllOf(HasSubstr(file + ":4:50: robot 'left' / attachment 't_': attach_to: "),
                             HasSubstr(file + ":6:54: robot 'left' / camera 'eye': attach_to: ")));
  const std::string root = RobotFile("root_body: bse\n");
  ExpectThrow<SpecError>([&] { BuildRobot(root); },
                         root + ":3:12: robot 'left': root_body: no body 'bse'");
  const std::string world = RobotFile("root_body: world\n");
  ExpectThrow<SpecError>([&] { BuildRobot(world); },
                         "root_body: no body 'world'. Its bodies: base, upper, fore.");
}

// A robot's file does not contain the robot's pose in the scene.
TEST_F(Located, PlacementOfARobotIsNotInItsFile) {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.name = "left", .config = RobotConfig::Load(RobotFile("home: {}\n"))});
  spec.robots[0].attach_to = {AttachKind::kSite, "table_top"};
  ExpectThrow<NotFoundError>(
      [&] { Scene::Build(spec); },
      "scene 'test' / robot 'left': attach_to: the scene: no site 'table_top'");
}

TEST_F(Located, ADuplicateCamera) {
  const std::string eye = "  - {name: eye, pos: [0, 0, 0], fovy: 45, attach_to: {body: base}}\n";
  const std::string twice = RobotFile("cameras:\n" + eye + eye);
  ExpectThrow<SpecError>(
      [&] { BuildRobot(twice); },
      twice +
          ":5:5: camera 'eye' (cameras[1]): name 'eye' is also that of cameras[0]; each "
          "needs its own");
  const std::string in_model = RobotFile(
      "edits: [{add_camera: eye, body: base, pos: [0, 0, 1]}]\n"
      "cameras:\n" +
      eye);
  ExpectThrow<SpecError>(
      [&] { BuildRobot(in_model); },
      in_model +
          ":5:12: robot 'left' / camera 'eye': there is already a camera of this name; choose "
          "another one. The model's cameras: eye");
}

TEST_F(Located, AModelFileThatDoesNotExistOrIsWrong) {
  const std::string file = File("gone.yaml", "name: arm\nmodel: amr.xml\n");
  ExpectThrow<NotFoundError>([&] { BuildRobot(file); },
                             file + ":2:8: robot 'left': model file 'amr.xml' not found");
  folder.Write("bad", "<worldbody><bdy/></worldbody>");
  const std::string bad = File("bad.yaml", "name: arm\nmodel: bad.xml\n");
  ExpectThrow<SpecError>([&] { BuildRobot(bad); },
                         bad + ":2:8: robot 'left': " + (folder.path() / "bad.xml").string() +
                             ":1: <bdy>: unrecognized element. Did you mean "
                             "'body'?");
}

TEST_F(Located, InASceneFileEachPartAtItsEntry) {
  RobotFile("root_body: base\n");
  const std::string file = File("scene.yaml",
                                "timestep: 0.002\n"
                                "add_floor: true\n"
                                "add_skybox: true\n"
                                "robots:\n"
                                "  - {name: left, config: arm.yaml, attach_to: {site: shelf}}\n"
                                "objects:\n"
                                "  - {name: cup, mjcf_path: cpu.xml}\n"
                                "cameras:\n"
                                "  - name: front\n"
                                "    pos: [1, 0, 1]\n"
                                "    fovy: 45\n"
                                "    attach_to: {body: tabel}\n");
  const std::string missing = ExpectThrow<NotFoundError>(
      [&] { Scene::Build(SceneSpec::Load(file)); }, file + ":7:28: object 'cup': model file");
  std::string text = ReadFile(file);
  text.erase(text.find("objects:"), text.find("cameras:") - text.find("objects:"));
  AtomicWrite(file, text);
  const std::string message = ExpectThrow<NotFoundError>(
      [&] { Scene::Build(SceneSpec::Load(file)); }, file + " has 2 problems:");
  EXPECT_THAT(message, AllOf(HasSubstr(file + ":5:47: robot 'left': attach_to: the scene: no site"),
                             HasSubstr(file + ":10:16: camera 'front': attach_to: the scene")));
}

TEST_F(Located, OnlyOmittedLightsAreANote) {
  folder.Write("lit", R"(<worldbody><light name="lamp"/><geom name="plate" size="0.1"/>
      <body name="b"><geom size="0.1"/></body></worldbody>)");
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "x", .mjcf_path = (folder.path() / "lit.xml").string()});
  const Scene scene = Scene::Build(spec);
  ASSERT_EQ(scene.compiled()->notes().size(), 1u);
  EXPECT_THAT(scene.compiled()->notes()[0],
              AllOf(StartsWith("object 'x': only body 'b' of "),
                    HasSubstr("left out: light 'lamp'; the scene has its own")));
  ASSERT_EQ(scene.compiled()->warnings().size(), 1u);
  EXPECT_THAT(scene.compiled()->warnings()[0],
              AllOf(HasSubstr("geom 'plate'"), Not(HasSubstr("lamp"))));
}

}  // namespace
}  // namespace robocell::internal
