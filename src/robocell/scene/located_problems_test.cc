// Problems found while a scene is built name the place in the file that the part came from.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class Located : public ::testing::Test {
 protected:
  Located() { folder.Write("arm", kTwoJointArm); }

  // The file of a robot with the two-joint arm; `fields` begin in line 3.
  std::string RobotFile(const std::string& fields) {
    return File("arm.yaml", "name: arm\nmodel: arm.xml\n" + fields);
  }
  std::string File(const std::string& name, const std::string& text) {
    const std::string file = (folder.path() / name).string();
    AtomicWrite(file, text);
    return file;
  }
  static Scene BuildRobot(const std::string& file) {
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.name = "left", .config = RobotConfig::Load(file)});
    return Scene::Build(spec);
  }

  ModelFolder folder;
};

TEST_F(Located, AJointThatDoesNotExist) {
  const std::string file = RobotFile(
      "move_groups:\n"
      "  arm:\n"
      "    joints: [shoulder, elbw]\n");
  ExpectThrow<SpecError>([&] { BuildRobot(file); },
                         file + ":5:24: robot 'left': no joint 'elbw'. Its joints: ");
}

TEST_F(Located, AnActuatorThatTwoGroupsName) {
  const std::string file = RobotFile(
      "move_groups:\n"
      "  arm: {kind: arm, joints: [shoulder, elbow], actuators: [servo1, servo2]}\n"
      "  tip: {joints: [elbow], actuators: [servo2]}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(file); },
                         file +
                             ":5:38: move_groups.tip.actuators[0]: actuator 'servo2' is commanded "
                             "by move_groups.arm and move_groups.tip; leave it out of one");
}

TEST_F(Located, AnActuatorThatOneGroupNamesAndAnArmFinds) {
  const std::string file = RobotFile(
      "move_groups:\n"
      "  tip: {actuators: [servo2]}\n"
      "  arm: {kind: arm, joints: [shoulder, elbow]}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(file); },
                         file +
                             ":4:21: robot 'left': move_groups.tip.actuators[0]: actuator 'servo2' "
                             "is commanded by move_groups.tip and move_groups.arm (it drives its "
                             "joints); leave it out of one");
}

TEST_F(Located, AJointThatTwoDrivenArmsList) {
  const std::string file = RobotFile(
      "move_groups:\n"
      "  one: {kind: arm, joints: [shoulder, elbow]}\n"
      "  two: {kind: arm, joints: [shoulder]}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(file); },
                         file +
                             ":5:29: robot 'left': move_groups.two.joints[0]: joint 'shoulder' is "
                             "listed by move_groups.one and move_groups.two, which both have "
                             "actuators; leave it out of one");
}

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

// The file of a robot does not say where it stands.
TEST_F(Located, WhereARobotStandsIsNotInItsFile) {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.name = "left", .config = RobotConfig::Load(RobotFile("home: {}\n"))});
  spec.robots[0].attach_to = {AttachKind::kSite, "table_top"};
  ExpectThrow<NotFoundError>(
      [&] { Scene::Build(spec); },
      "scene 'test' / robot 'left': attach_to: the scene: no site 'table_top'");
}

TEST_F(Located, ACameraThatIsThereTwice) {
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

TEST_F(Located, ALeafOnAFinger) {
  folder.Write("gripper", kTwoFingerGripper);
  const std::string file = RobotFile(
      "attachments: [{mjcf_path: gripper.xml, attach_to: {site: flange}}]\n"
      "move_groups:\n"
      "  arm: {kind: arm, joints: [shoulder, elbow], leaf: {body: left}}\n"
      "  gripper: {kind: gripper, joints: [left_slide, right_slide], actuators: grip}\n");
  ExpectThrow<SpecError>(
      [&] { BuildRobot(file); },
      file +
          ":5:53: robot 'left': move_groups.arm.leaf: body 'left' hangs on 'left_slide' too, a "
          "joint of group 'gripper', and the arm lists shoulder, elbow; name as `leaf` what the "
          "last joint, 'elbow', carries, for example {site: pinch}. Sites there: flange, pinch. "
          "Bodies there: fore, palm");
}

TEST_F(Located, JointsThatAreNotThoseToTheLeaf) {
  const std::string swapped = RobotFile(
      "move_groups:\n"
      "  arm: {kind: arm, joints: [elbow, shoulder], leaf: {site: flange}}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(swapped); },
                         swapped +
                             ":4:28: robot 'left': move_groups.arm.joints: lists elbow, "
                             "shoulder, but the joints from 'base' to the arm's leaf are "
                             "shoulder, elbow; list those, in this order");
  const std::string still = RobotFile(
      "move_groups:\n"
      "  arm: {kind: arm, joints: [shoulder, elbow], leaf: {body: base}}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(still); },
                         still +
                             ":4:53: robot 'left': move_groups.arm.leaf: there is no joint "
                             "between 'base' and the arm's leaf, so nothing moves; name as "
                             "`leaf` what the last joint, 'elbow', carries, for example {site: "
                             "flange}. Sites there: flange. Bodies there: fore");
  const std::string one_missing = RobotFile("move_groups: {arm: {kind: arm, joints: [elbow]}}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(one_missing); },
                         one_missing +
                             ":3:40: robot 'left': move_groups.arm.joints: lists elbow, "
                             "but the joints from 'base' to the arm's leaf are shoulder, "
                             "elbow; list those, in this order, or name its `leaf`. Or, where "
                             "'shoulder' has a group of its own (a waist that two arms hang on, a "
                             "lift): `root_body: upper` at the top level of the robot file; the "
                             "arms begin behind it");
  BuildRobot(
      RobotFile("root_body: upper\n"
                "move_groups: {arm: {kind: arm, joints: [elbow]}}\n"));
}

TEST_F(Located, AJointOfTheRootItself) {
  const std::string model = folder.Write(
      "cart", R"(<worldbody><body name="sled"><joint name="rail" type="slide"/><geom size=".1"/>
      <body name="link"><joint name="j2"/><geom size=".1"/></body></body></worldbody>)");
  const std::string file = (folder.path() / "cart.yaml").string();
  std::ofstream(file) << "name: left\nmodel: cart.xml\n"
                      << "move_groups: {arm: {kind: arm, joints: [rail, j2]}}\n";
  ExpectThrow<SpecError>(
      [&] { BuildRobot(file); },
      file +
          ":3:40: robot 'left': move_groups.arm.joints: 'rail' moves the root body 'sled' itself, "
          "and an arm begins behind the root. Put a body without joints around 'sled' in the "
          "model, or give 'rail' a group of its own: {kind: generic, joints: [rail], actuators: "
          "[NAME]}");
}

TEST_F(Located, OneFingerTwice) {
  folder.Write("gripper", kTwoFingerGripper);
  const std::string file = RobotFile(
      "attachments: [{mjcf_path: gripper.xml, prefix: g_, attach_to: {site: flange}}]\n"
      "move_groups:\n"
      "  hand: {kind: gripper, actuators: [g_grip], fingers: [{body: g_left}, {body: g_left}]}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(file); },
                         "move_groups.hand.fingers: both fingers are body 'g_left'; name one "
                         "body of each finger");
}

TEST_F(Located, AnActuatorThatMovesTheWholeHand) {
  folder.Write("gripper", kTwoFingerGripper);
  const std::string fields =
      "attachments: [{mjcf_path: gripper.xml, prefix: g_, attach_to: {site: flange}}]\n"
      "move_groups:\n"
      "  carrier: {joints: [shoulder, elbow]}\n"
      "  gripper: {kind: gripper, joints: [g_left_slide, g_right_slide], actuators: [";
  BuildRobot(RobotFile(fields + "g_grip]}\n"));
  const std::string wrong = RobotFile(fields + "servo2]}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(wrong); },
                         wrong +
                             ":6:79: robot 'left': move_groups.gripper.actuators[0]: 'servo2' "
                             "moves the whole hand, not a finger. The actuators that move its "
                             "fingers: g_grip");
}

TEST_F(Located, ABodyWithoutMass) {
  folder.Write("light", R"(<worldbody><body name="base"><geom size="0.1"/>
      <body name="finger"><joint/><geom size="0.1" mass="0"/></body></body></worldbody>)");
  const std::string file = File("light.yaml", "name: arm\nmodel: light.xml\n");
  const std::string message = ExpectThrow<SpecError>(
      [&] { BuildRobot(file); },
      file + ":2:8: robot 'left': " + (folder.path() / "light.xml").string() +
          ":2: body 'finger': mass and inertia of moving bodies must be larger than mjMINVAL. A "
          "body "
          "that moves needs a mass: ");
  EXPECT_THAT(message, HasSubstr("edits: [{geom: {body: finger, index: 0}, mass: 0.05}]"));
  folder.Write("same", R"(<worldbody><body name="base"><geom size="0.1"/>
      <body name="thumb"><joint name="thumb"/><geom size="0.1" mass="0"/></body></body></worldbody>)");
  ExpectThrow<SpecError>([&] { BuildRobot(File("same.yaml", "name: arm\nmodel: same.xml\n")); },
                         ":2: element 'thumb': mass and inertia of moving bodies");
  BuildRobot(File("heavy.yaml",
                  "name: arm\nmodel: light.xml\n"
                  "edits: [{geom: {body: finger, index: 0}, mass: 0.05}]\n"));
}

TEST_F(Located, WhatTheEngineDislikesHasTheModelsLine) {
  folder.Write("flat", R"(<worldbody><body name="base">
      <geom type="sphere" size="-1"/></body></worldbody>)");
  const std::string file = File("flat.yaml", "name: arm\nmodel: flat.xml\n");
  ExpectThrow<SpecError>([&] { BuildRobot(file); },
                         file + ":2:8: robot 'left': " + (folder.path() / "flat.xml").string() +
                             ":2: size 0 must be positive in geom");
  folder.Write("tool", R"(<worldbody><body name="t"><geom name="ball" type="sphere" size="-1"/>
      </body></worldbody>)");
  const std::string with_tool =
      RobotFile("attachments: [{mjcf_path: tool.xml, prefix: t_, attach_to: {site: flange}}]\n");
  ExpectThrow<SpecError>([&] { BuildRobot(with_tool); },
                         with_tool +
                             ":2:8: robot 'left': " + (folder.path() / "tool.xml").string() +
                             ":1: geom 't_ball': size 0 must be positive in geom");
}

// The same words as of a robot or an object.
TEST_F(Located, WhatTheEngineDislikesInTheBaseOfAScene) {
  const auto message = [&](const std::string& model) {
    SceneSpec spec = EmptyScene();
    spec.base = folder.Write("room", model);
    spec.objects.push_back(BoxObject("cube", {0.5, 0, 0.1}));
    return ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                                  "scene 'test' / base: " + *spec.base + ":");
  };
  EXPECT_THAT(message("<worldbody><body name=\"table\">\n<geom size=\".1\"/>\n"
                      "<geom type=\"mesh\" mesh=\"top\"/></body></worldbody>"),
              HasSubstr(":3: geom 1 (unnamed, of body 'table'): no mesh 'top', and the model has "
                        "none: put <mesh name=\"top\" .../> into its <asset>"));
  EXPECT_THAT(message("<worldbody><body>\n<geom type=\"sphere\" size=\"-1\"/></body></worldbody>"),
              HasSubstr(":2: size 0 must be positive in geom"));
  EXPECT_THAT(message("<worldbody><body name=\"leaf\"><joint/></body></worldbody>"),
              HasSubstr(":1: body 'leaf': mass and inertia of moving bodies must be larger than"));
}

TEST_F(Located, ANameThatTheBaseHasAlready) {
  SceneSpec spec = EmptyScene();
  spec.base = folder.Write("room", R"(<worldbody><body name="cube"/></worldbody>)");
  spec.objects.push_back(BoxObject("cube", {0.5, 0, 0.1}));
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "scene 'test' / object 'cube': body 'cube' is in base already, and the "
                         "object would bring another one; give the object another name");
}

TEST_F(Located, AnAssetThatTheModelLacks) {
  const auto message = [&](const std::string& model) {
    const std::string path = folder.Write("lacking", model);
    const std::string file = File("lacking.yaml", "name: arm\nmodel: lacking.xml\n");
    const std::string text = ExpectThrow<SpecError>([&] { BuildRobot(file); },
                                                    file + ":2:8: robot 'left': " + path + ":");
    return text.substr(text.find(path) + path.size() + 1);
  };
  std::ofstream(folder.path() / "link0.obj")
      << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  EXPECT_EQ(message("<asset><mesh file=\"link0.obj\"/><mesh name=\"cover\" file=\"link0.obj\"/>"
                    "</asset><worldbody><body name=\"base\">\n<geom size=\".1\"/>\n"
                    "<geom type=\"mesh\" mesh=\"lnk0\"/></body></worldbody>"),
            "3: geom 1 (unnamed, of body 'base'): no mesh 'lnk0'. Known meshes: link0, cover. Did "
            "you mean 'link0'?");
  EXPECT_EQ(message("<worldbody><body name=\"base\"><geom name=\"skin\" size=\".1\"\n"
                    "material=\"red\"/></body></worldbody>"),
            "1: geom 'skin': no material 'red', and the model has none: put <material "
            "name=\"red\" .../> into its <asset>");
  EXPECT_EQ(message("<asset><texture name=\"wood\" type=\"2d\" builtin=\"flat\" width=\"8\" "
                    "height=\"8\"/>\n<material name=\"m\" texture=\"wod\"/></asset>"
                    "<worldbody><body name=\"base\"><geom size=\".1\" material=\"m\"/></body>"
                    "</worldbody>"),
            "2: material 'm': no texture 'wod'. Known textures: wood. Did you mean 'wood'?");
  EXPECT_THAT(message("<worldbody><body name=\"base\"><geom size=\".1\"/>"
                      "<site name=\"s\" material=\"red\"/></body></worldbody>"),
              HasSubstr("site 's': no material 'red'"));
  EXPECT_THAT(message("<worldbody><body name=\"base\"><geom type=\"hfield\" hfield=\"hill\"/>"
                      "</body></worldbody>"),
              HasSubstr("geom 0 (unnamed, of body 'base'): no hfield 'hill', and the model"));
}

TEST_F(Located, AnAssetThatATwinOfTheRobotOrItsToolLacks) {
  const std::string tool = folder.Write(
      "tool", R"(<worldbody><body name="t"><geom type="mesh" mesh="foo"/></body></worldbody>)");
  const std::string with_tool =
      RobotFile("attachments: [{mjcf_path: tool.xml, prefix: t_, attach_to: {site: flange}}]\n");
  ExpectThrow<SpecError>([&] { BuildRobot(with_tool); }, tool + ":1: ");
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(BoxObject("box", {1, 1, 1}));
  spec.robots.push_back(
      {.name = "left", .config = RobotConfig::Load(RobotFile("")), .prefix = "l_"});
  spec.objects.push_back({.name = "thing", .mjcf_path = tool});
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "object 'thing': " + tool +
                             ":1: geom 0 (unnamed, of body 't'): no mesh "
                             "'foo', and the model has none");
}

TEST_F(Located, AFingerThatNothingMoves) {
  std::string gripper = kTwoFingerGripper;
  const std::string tie = R"(<joint joint1="left_slide" joint2="right_slide"/>)";
  const std::string tendon = R"(<joint joint="right_slide" coef="0.5"/>)";
  gripper.erase(gripper.find(tie), tie.size());
  const auto warnings = [&](const std::string& model, const std::string& fingers) {
    folder.Write("gripper", model);
    const Scene scene = BuildRobot(
        RobotFile("attachments: [{mjcf_path: gripper.xml, prefix: g_, attach_to: {site: flange}}]\n"
                  "move_groups:\n"
                  "  gripper: {kind: gripper, joints: [g_left_slide, g_right_slide], actuators: "
                  "g_grip" +
                  fingers + "}\n"));
    return scene.compiled()->warnings();
  };
  EXPECT_THAT(warnings(gripper, ""), ::testing::IsEmpty()) << "the tendon moves both";
  gripper.erase(gripper.find(tendon), tendon.size());
  const std::string why =
      ": nothing moves the finger 'g_right': no actuator acts on its joint 'g_right_slide' and no "
      "equality ties it to the other finger. In the model, couple it (<equality><joint "
      "joint1=\"g_right_slide\" joint2=\"g_left_slide\"/></equality>) or give it an actuator";
  EXPECT_THAT(warnings(gripper, ""),
              ::testing::ElementsAre("robot 'left': move_groups.gripper.joints" + why));
  EXPECT_THAT(warnings(gripper, ", fingers: [g_left_pad, g_right_pad]"),
              ::testing::ElementsAre("robot 'left': move_groups.gripper.fingers" + why));
  std::string tied = gripper;
  tied.insert(tied.find("</equality>"), tie);
  EXPECT_THAT(warnings(tied, ""), ::testing::IsEmpty());
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

TEST_F(Located, ABallInTheArmIsNotOfferedForItsList) {
  folder.Write("ball", R"(<worldbody><body name="base"><geom size="0.1"/>
      <body name="upper"><joint name="hip" axis="0 1 0"/><geom size="0.1"/>
      <body name="fore"><joint name="elbow" type="ball"/><geom size="0.1"/><site name="tip"/>
      </body></body></body></worldbody>)");
  const std::string file =
      File("ball.yaml",
           "name: arm\nmodel: ball.xml\n"
           "move_groups: {arm: {kind: arm, joints: [hip], leaf: {site: tip}}}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(file); },
                         file +
                             ":3:53: robot 'left': move_groups.arm.leaf: 'elbow' between "
                             "'base' and the arm's leaf is no hinge and no slide, and an arm "
                             "has only those: name a `leaf` before it, or put hinges in its "
                             "place in the model");
}

TEST_F(Located, AMissingMeshIsToldWithTheModelThatWantsIt) {
  AtomicWrite(folder.path() / "link1.stl", "");
  const std::string model = folder.Write("meshes", R"(<asset>
  <mesh name="link" file="lnik1.stl"/>
  <mesh name="hand" file="visual/hand.stl"/></asset>
  <worldbody><body name="b"><geom type="mesh" mesh="link"/></body></worldbody>)");
  const std::string file = File("meshes.yaml", "name: arm\nmodel: meshes.xml\n");
  const std::string in = folder.path().string();
  ExpectThrow<NotFoundError>(
      [&] { BuildRobot(file); },
      file + ":2:8: robot 'left': " + model +
          " refers to the file 'lnik1.stl' (mesh 'link', line " + "2), but there is no " + in +
          "/lnik1.stl. Did you mean 'link1.stl'? Also missing: " +
          "visual/hand.stl. Get the model with all its files, or correct `file`, `meshdir` or " +
          "`texturedir` in it");
}

TEST_F(Located, AMissingMeshWithNothingLikeItEndsInOneFullStop) {
  folder.Write("meshes", R"(<asset><mesh file="q.stl"/></asset>
  <worldbody><body name="b"><geom type="mesh" mesh="q"/></body></worldbody>)");
  const std::string in = folder.path().string();
  ExpectThrow<NotFoundError>(
      [&] { BuildRobot(File("meshes.yaml", "name: arm\nmodel: meshes.xml\n")); },
      "(mesh 'q', line 1), but there is no " + in + "/q.stl. Get the model with all its files");
}

TEST_F(Located, AMissingMeshOfAnObjectAndOfABase) {
  const std::string model = folder.Write("cup", R"(<compiler meshdir="meshes"/>
  <asset><mesh name="cup" file="cup.obj"/></asset>
  <worldbody><body name="b"><geom type="mesh" mesh="cup"/></body></worldbody>)");
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "red", .mjcf_path = model});
  ExpectThrow<NotFoundError>([&] { Scene::Build(spec); },
                             "scene 'test' / object 'red': " + model +
                                 " refers to the file 'cup.obj' (mesh 'cup', line 2), but there is "
                                 "no folder " +
                                 folder.path().string() + "/meshes. Get the model");
  const SceneSpec based{.name = "test", .base = model};
  ExpectThrow<NotFoundError>([&] { Scene::Build(based); }, "scene 'test' / base: " + model);
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

TEST_F(Located, LightsThatStayBehindAreANoteAndNothingElseIs) {
  folder.Write("lit", R"(<worldbody><light name="lamp"/><geom name="plate" size="0.1"/>
      <body name="b"><geom size="0.1"/></body></worldbody>)");
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "x", .mjcf_path = (folder.path() / "lit.xml").string()});
  const Scene scene = Scene::Build(spec);
  ASSERT_EQ(scene.compiled()->notes().size(), 1u);
  EXPECT_THAT(scene.compiled()->notes()[0],
              AllOf(StartsWith("object 'x': only body 'b' of "),
                    HasSubstr("left out of its world: light 'lamp'; the scene has its own")));
  ASSERT_EQ(scene.compiled()->warnings().size(), 1u);
  EXPECT_THAT(scene.compiled()->warnings()[0],
              AllOf(HasSubstr("geom 'plate'"), Not(HasSubstr("lamp"))));
}

}  // namespace
}  // namespace robocell
