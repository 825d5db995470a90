// Tests the labels of unnamed elements: their form, and that they change nothing else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/element_lookup.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/model_compare.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// The joint `elbow:joint0`, two servos on it, two unnamed fingers, an unnamed site on the first.
constexpr const char* kUnnamed = R"(
  <compiler angle="radian"/>
  <default><joint axis="0 1 0" range="-2 2"/><geom size="0.02" mass="0.1"/></default>
  <worldbody><body>
    <geom/>
    <body name="turn"><joint name="j1"/><geom/>
      <body name="elbow"><joint/><geom/>
        <body pos="0.1 0 0"><joint type="slide" axis="1 0 0" range="0 0.05"/><geom/><site/></body>
        <frame pos="0.2 0 0"><body><joint type="slide" axis="-1 0 0" range="0 0.05"/><geom/></body></frame>
        <body name="elbow:body3"/><body/>
      </body>
    </body>
  </body></worldbody>
  <tendon><fixed name="both"><joint joint="j1" coef="1"/></fixed></tendon>
  <actuator>
    <motor joint="j1"/><position name="servo1" joint="j1" kp="10"/><motor joint="j1"/>
    <motor tendon="both"/>
  </actuator>
  <keyframe><key name="home" qpos="0.1 0.2 0.01 0.02" ctrl="1 2 3 4"/></keyframe>)";

class LabelUnnamed : public ::testing::Test {
 protected:
  RobotConfig Config(const std::string& fields = "") {
    const std::string file = (folder.path() / "bot.yaml").string();
    AtomicWrite(file, "name: bot\nmodel: bot.xml\n" + fields);
    return RobotConfig::Load(file);
  }
  Scene Build(const std::string& fields = "") {
    SceneSpec spec{.name = "test", .timestep = 0.002, .add_floor = false, .add_skybox = false};
    spec.robots.push_back({.name = "bot",
                           .config = Config(fields),
                           .control_modes = std::vector{CtrlMode::kPosition}});
    return Scene::Build(spec);
  }
  static double Home(const Scene& scene, const char* joint) {
    const mjModel* m = scene.model();
    return scene.data()->qpos[m->jnt_qposadr[RequireId(m, mjOBJ_JOINT, joint, "test")]];
  }

  ModelFolder folder;
  std::string model = folder.Write("bot", kUnnamed);
};

TEST_F(LabelUnnamed, DescribeThePlaceOfTheElement) {
  const Scene scene = Build();
  EXPECT_THAT(scene.body_names(), ElementsAre("world", "root_body", "turn", "elbow", "elbow:body0",
                                              "elbow:body1", "elbow:body3", "elbow:body3_"));
  EXPECT_THAT(scene.joint_names(),
              ElementsAre("j1", "elbow:joint0", "elbow:body0:joint0", "elbow:body1:joint0"));
  EXPECT_THAT(ElementNames(scene.model(), mjOBJ_SITE), ElementsAre("elbow:body0:site0"));
  EXPECT_THAT(ElementNames(scene.model(), mjOBJ_ACTUATOR),
              ElementsAre("j1:actuator0", "servo1", "j1:actuator2", "both:actuator0"));
}

TEST_F(LabelUnnamed, ChangeNothingElse) {
  const Scene scene = Build();
  char error[500] = "";
  mjModel* alone = mj_loadXML(model.c_str(), nullptr, error, sizeof error);
  ASSERT_NE(alone, nullptr) << error;
  EXPECT_EQ(ModelDifferences(alone, scene.model(), 1e-12,
                             {"nnames", "names", "name_", "npaths", "paths", "nkey", "key_", "stat",
                              "nbuffer", "vis", "text", "ntext", "nmap",
                              // as all robots have it (first_joints.cc)
                              "nexclude", "exclude_"}),
            "");
  mj_deleteModel(alone);
}

TEST_F(LabelUnnamed, AreNamesInARobotFile) {
  const Scene scene = Build(
      "root_body: root_body\n"
      "move_groups:\n"
      "  arm: {kind: arm, joints: [j1, elbow:joint0], leaf: {body: elbow}}\n"
      "  tip: {joints: [elbow:body0:joint0], leaf: {site: {body: elbow:body0, index: 0}}}\n"
      "home: {arm: [0.5, 0.6]}\n");
  EXPECT_EQ(Home(scene, "elbow:joint0"), 0.6);
  EXPECT_EQ(Home(scene, "elbow:body1:joint0"), 0.02) << "the keyframe's, for unnamed joints too";
}

TEST_F(LabelUnnamed, YieldToNamesInEditsAndKeepTheKeyframe) {
  const Scene scene = Build(
      "edits:\n"
      "  - {joint: {body: elbow, index: 0}, name: j2}\n"
      "  - {body: {body: elbow, index: 1}, name: right}\n"
      "  - {joint: elbow:body0:joint0, name: left_slide}\n"
      "  - {actuator: {tendon: both}, name: pull}\n"
      "  - {actuator: j1:actuator2, name: push}\n");
  EXPECT_EQ(Home(scene, "j2"), 0.2);
  EXPECT_EQ(Home(scene, "left_slide"), 0.01);
  EXPECT_THAT(ElementNames(scene.model(), mjOBJ_ACTUATOR),
              ElementsAre("j1:actuator0", "servo1", "push", "pull"));
  EXPECT_GE(FindId(scene.model(), mjOBJ_BODY, "right"), 0);
}

TEST_F(LabelUnnamed, SuggestsTheNameGivenByAnEdit) {
  const Scene scene = Build(
      "edits:\n  - {joint: {body: elbow, index: 0}, name: j2}\n"
      "  - {body: {body: elbow, index: 1}, name: left}\n"
      "  - {actuator: {tendon: both}, name: pull}\n");
  const auto& robot = scene.compiled()->robot("bot");
  const auto find = [&](mjtObj kind, const std::string& name) {
    return [&, kind, name] { FindElement(scene.model(), robot, kind, name); };
  };
  ExpectThrow<NotFoundError>(find(mjOBJ_JOINT, "elbow:joint0"),
                             "It is called 'j2' now: edits[0] gives it that name");
  ExpectThrow<NotFoundError>(find(mjOBJ_ACTUATOR, "both:actuator0"),
                             "It is called 'pull' now: edits[2]");
  ExpectThrow<NotFoundError>(
      [&] {
        FindElement(scene.model(), robot, {.name = "elbow:body1"}, {mjOBJ_SITE, mjOBJ_BODY});
      },
      "It is called 'left' now: edits[1]");
}

TEST_F(LabelUnnamed, SuggestsTheEditThatNamesAMissingJoint) {
  ExpectThrow<SpecError>(
      [&] {
        Build(
            "move_groups:\n"
            "  arm: {kind: arm, joints: [j1], actuators: [servo1], leaf: {body: elbow}}\n");
      },
      "bot.yaml:4:28: robot 'bot': move_groups.arm.joints: lists j1, but the joints from "
      "'root_body' to the arm's leaf are j1, elbow:joint0; list those, in this order "
      "('elbow:joint0' has no name in the model; to give it one: edits: [{joint: {body: elbow, "
      "index: 0}, name: NAME}])");
}

TEST_F(LabelUnnamed, DistinguishesActuatorsOfOneJoint) {
  ExpectThrow<NotFoundError>([&] { Build("edits: [{actuator: {joint: j1}, name: x}]\n"); },
                             "bot.yaml:3:9: robot 'bot' / edits[0]: 3 actuators act on joint 'j1'; "
                             "write which: j1:actuator0, servo1, j1:actuator2");
  ExpectThrow<NotFoundError>(
      [&] { Build("edits: [{actuator: {joint: elbow:joint0}, name: x}]\n"); },
      "edits[0]: no actuator acts on joint 'elbow:joint0'. Its actuators: j1:actuator0, servo1");
  ExpectThrow<NotFoundError>([&] { Build("edits: [{actuator: {joint: j2}, name: x}]\n"); },
                             "edits[0]: the model: no joint 'j2'. Its joints: j1, elbow:joint0");
  ExpectThrow<SpecError>(
      [&] { Config("edits: [{actuator: {body: elbow, index: 0}, name: x}]\n"); },
      "(edits[0]).actuator: is given element 0 of body 'elbow'; write the actuator's name, or "
      "{joint: name}, the joint that it acts on (likewise tendon, site, body)");
}

TEST_F(LabelUnnamed, OfToolsAreDistinctFromThoseOfTheRobot) {
  folder.Write("tool", R"(<worldbody><body><geom size="0.01"/><body><joint/><geom size="0.01"/>
      </body></body></worldbody>)");
  const Scene scene = Build("attachments: [{mjcf_path: tool.xml, attach_to: {body: elbow}}]\n");
  EXPECT_GE(FindId(scene.model(), mjOBJ_JOINT, "tool:body0:joint0"), 0);
}

TEST_F(LabelUnnamed, OfABaseScene) {
  const SceneSpec spec{.name = "test", .base = model, .timestep = 0.002};
  const Scene scene = Scene::Build(spec);
  EXPECT_EQ(scene.body_names()[1], "body");
  EXPECT_EQ(Home(scene, "elbow:joint0"), 0.2);
}

TEST_F(LabelUnnamed, ReportsOmittedElementsByNumber) {
  folder.Write("bot", R"(<worldbody><light/><light name="lamp"/><geom size="0.1"/><body name="b">
      <geom size="0.1"/></body></worldbody>)");
  const Scene scene = Build();
  ASSERT_EQ(scene.compiled()->notes().size(), 1u);
  EXPECT_THAT(scene.compiled()->notes()[0],
              HasSubstr("left out: light 0 (unnamed), light 'lamp'; the scene"));
  EXPECT_THAT(scene.compiled()->warnings(), ElementsAre(HasSubstr("left out: geom 0 (unnamed)")));
}

}  // namespace
}  // namespace robocell::internal
