// Tests elements that a model's file names but lacks, keyframes of another model, files of another
// kind.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/arm_with_hand.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

using ModelFile = ArmWithHand;

TEST_F(ModelFile, AnActuatorOfAMissingJoint) {
  Model({.servo = "kne"});
  ExpectThrow<SpecError>([&] { Build(); },
                         "arm.yaml:2:8: robot 'arm': " + model_ +
                             ":12: the target of actuator 's2': no joint 'kne'. Its joints: hip, "
                             "knee, l, r. Did you mean 'knee'?");
}

TEST_F(ModelFile, AKeyframeOfAnotherModel) {
  Model({.rest = "<keyframe><key name=\"home\" qpos=\"0 0.5 0 0 1\"/></keyframe>"});
  EXPECT_THROW(Compile(ParseXmlFile(model_).get()), SpecError);
  ExpectThrow<SpecError>([&] { Build(); },
                         model_ +
                             ": the keyframe 'home' has 5 numbers in qpos, and the model's "
                             "joints need 4, in this order: hip, knee, l, r");
}

// The oracle is the engine, which completes the keyframe, here of a model that another one is
// attached to.
TEST_F(ModelFile, AKeyframeWithoutToolJoints) {
  AtomicWrite(folder_.path() / "tool.xml",
              "<mujoco model=\"tool\"><worldbody><body name=\"t\"><joint name=\"spin\"/>"
              "<geom size=\"0.02\" mass=\"0.1\"/></body></worldbody></mujoco>");
  Model({.rest =
             "<asset><model name=\"tool\" file=\"tool.xml\"/></asset><worldbody><body name=\"c\">"
             "<attach model=\"tool\" body=\"t\" prefix=\"t_\"/></body></worldbody>"
             "<keyframe><key name=\"home\" qpos=\"0.1 0.5\"/></keyframe>"});
  const ModelPtr alone = Compile(ParseXmlFile(model_).get());
  ASSERT_EQ(alone->nq, 5);
  const Scene scene = Build("root_body: base\n");
  EXPECT_THAT(scene.compiled()->warnings(),
              Contains(model_ + ": robot 'arm': the keyframe 'home' has 2 numbers in qpos, and the "
                                "model's joints need 5, in this order: hip, knee, l, r, t_spin. "
                                "Without a number, and at their reference: l, r, t_spin"));
  const mjModel* model = scene.model();
  const int home = scene.compiled()->home_key();
  for (const std::string joint : {"hip", "knee", "l", "r"}) {
    const int own = FindId(alone.get(), mjOBJ_JOINT, joint);
    const int there = FindId(model, mjOBJ_JOINT, "a/" + joint);
    EXPECT_EQ(model->key_qpos[home * model->nq + model->jnt_qposadr[there]],
              alone->key_qpos[alone->jnt_qposadr[own]])
        << joint;
  }
}

TEST_F(ModelFile, AKeyframeWithTooFewControls) {
  Model({.rest = "<keyframe><key name=\"home\" qpos=\"0 0.5 0 0\" ctrl=\"0\"/></keyframe>"});
  EXPECT_THAT(Build().compiled()->warnings(),
              ElementsAre(model_ + ": robot 'arm': the keyframe 'home' has 1 number in ctrl for 3 "
                                   "actuators. Without a number, and at the control that holds "
                                   "home: actuator 's2', actuator 'grip'"));
}

TEST_F(ModelFile, KeyframesWithOtherNamesAreListed) {
  Model({.rest = "<keyframe><key name=\"ready\" qpos=\"0.1 0.5 0 0\"/><key qpos=\"0 0 0 0\"/>"
                 "</keyframe>"});
  EXPECT_THAT(Build().compiled()->notes(),
              ElementsAre("robot 'arm': " + model_ +
                          " has no keyframe 'home', only 'ready', the 2. (unnamed): the robot "
                          "starts with all joints at their reference. To start at a keyframe, "
                          "write its numbers as `home`: 'ready' has hip 0.1, knee 0.5, l 0, "
                          "r 0"));
  EXPECT_THAT(Build("home: {arm: [0.1, 0.5]}\n").compiled()->notes(), IsEmpty());
}

TEST_F(ModelFile, AHomeInDegreesOutsideTheLimits) {
  Model(
      {.angle = "degree", .rest = "<keyframe><key name=\"home\" qpos=\"1.5 0 0 0\"/></keyframe>"});
  ExpectThrow<SpecError>([&] { Build(); },
                         "1.5 is outside the limits -0.0349066 to 0.0349066 of joint 'hip'. Were "
                         "radians read as degrees? The model's -2 to 2 are degrees unless it says "
                         "<compiler angle=\"radian\"/>");
}

// A model that is made for viewing alone brings a floor. In its world the floor is left out; in a
// body it would come along.
TEST_F(ModelFile, AFloorInTheModel) {
  const std::string plane = "geom name=\"ground\" type=\"plane\" size=\"0 0 1\"/>";
  Model({.first = "<worldbody><" + plane + "</worldbody>"});
  const Scene outside = Build();
  EXPECT_THAT(outside.compiled()->warnings(), IsEmpty());
  EXPECT_THAT(outside.compiled()->notes(), ElementsAre(HasSubstr("left out: geom")));
  EXPECT_LT(FindId(outside.model(), mjOBJ_GEOM, "a/ground"), 0);

  SceneSpec spec = EmptyScene();
  spec.robots.push_back(
      {.path = folder_.Write("inside", "<worldbody><body name=\"base\"><" + plane +
                                           "<body><joint/><geom size=\"0.1\"/></body></body>"
                                           "</worldbody>")});
  EXPECT_THAT(
      Scene::Build(spec).compiled()->warnings(),
      Contains("robot 'robot': geom 'ground' of body 'base' is a plane without end: a second "
               "floor that goes where the body goes. If it is only there to look at the "
               "robot alone: edits: [{delete: {geom: ground}}]"));
}

TEST_F(ModelFile, AUrdfCanBeAPassiveTool) {
  AtomicWrite(
      folder_.path() / "pen.urdf",
      "<robot name=\"pen\"><link name=\"pen\"><inertial><mass value=\"0.1\"/><inertia "
      "ixx=\"1e-4\" iyy=\"1e-4\" izz=\"1e-4\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>"
      "<collision><geometry><sphere radius=\"0.02\"/></geometry></collision></link></robot>");
  Model();
  const Scene scene =
      Build("attachments: [{mjcf_path: pen.urdf, attach_to: {site: tip}, prefix: pen_}]\n");
  EXPECT_GE(FindId(scene.model(), mjOBJ_BODY, "a/pen_pen"), 0);
}

// The engine takes them, and the state diverges.
TEST(ModelFileOfAScene, NegativeDampingArmatureAndFrictionAreNamed) {
  const TempDir folder;
  const std::string file = folder / "cell.xml";
  const auto problem = [&](const std::string& joint, const std::string& more = "") {
    AtomicWrite(file,
                "<mujoco><default><default class='bad'><joint damping='-3'/></default>"
                "</default><worldbody><body name='b'><joint name='j' " +
                    joint + "/><geom size='.1'/></body></worldbody>" + more + "</mujoco>");
    EXPECT_NO_THROW(Compile(ParseXmlFile(file).get())) << "the engine's own check would do";
    SceneSpec spec{.name = "s", .base = file, .timestep = 0.002, .add_floor = false};
    try {
      CompileScene(spec);
    } catch (const SpecError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(problem("damping='1' armature='0' frictionloss='0.1'"), "");
  EXPECT_EQ(problem("damping='-1'"),
            "scene 's': the damping of joint 'j' is -1, and a negative one adds energy; correct "
            "its model, or give another value in `edits`");
  EXPECT_THAT(problem("armature='-0.5'"), HasSubstr("the armature of joint 'j' is -0.5"));
  EXPECT_THAT(problem("frictionloss='-2'"), HasSubstr("the frictionloss of joint 'j' is -2"));
  EXPECT_THAT(problem("class='bad'"), HasSubstr("the damping of joint 'j' is -3"));
  EXPECT_THAT(problem("",
                      "<tendon><fixed name='t' damping='-4'><joint joint='j' coef='1'/>"
                      "</fixed></tendon>"),
              HasSubstr("the damping of tendon 't' is -4"));
}

}  // namespace
}  // namespace robocell::internal
