// Tests servos whose ctrlrange does not fit their joints.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/arm_with_hand.h"
#include "robocell/testing/menagerie.h"
#include "robocell/testing/source_dir.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using ServoRanges = ArmWithHand;

TEST_F(ServoRanges, AServoWithATinyRangeOrOneThatExcludesHome) {
  EXPECT_THAT(
      Warnings({.hip_ctrl = "-0.035 0.035"}),
      ElementsAre(model_ + ":11: robot 'arm': the servo 's1' sends joint 'hip' from -0.035 to "
                           "0.035 rad (its ctrlrange), but the joint may move from -2 to 2 rad: it "
                           "hardly moves. To use all of it: edits: [{actuator: 's1', ctrlrange: "
                           "[-2, 2]}]"));
  EXPECT_THAT(Warnings({.hip_ctrl = "2.5 3"}),
              ElementsAre(AllOf(HasSubstr("from 2.5 to 3 rad"),
                                HasSubstr("it is driven against its limit, and the way to home, 0, "
                                          "stops there"))));
  EXPECT_THAT(Warnings({.hip_ctrl = "-0.5 0.5"}, "home: {arm: [1, 0]}\n"),
              ElementsAre(HasSubstr("commands beyond stop there, and the way to home, 1, stops")));
}

TEST_F(ServoRanges, NotesAServoWithASmallerRangeThanItsJoint) {
  Model({.hip_ctrl = "-0.5 2", .knee_ctrl = "-2.25 2.25"});
  const Scene scene = Build();
  EXPECT_THAT(scene.compiled()->warnings(), IsEmpty());
  EXPECT_THAT(scene.compiled()->notes(),
              ElementsAre("robot 'arm': servos of 'arm' stop before their joints do (their "
                          "ctrlrange): s1 -0.5 to 2 of -2 to 2, s2 -2.25 to 2.25 of -2.5 to 2.5"));
}

TEST_F(ServoRanges, ControlsInDegrees) {
  EXPECT_THAT(Warnings({.knee_ctrl = "-143 143"}),
              ElementsAre(model_ + ":12: robot 'arm': the servo 's2' takes -143 to 143 rad for "
                                   "joint 'knee' (its ctrlrange), which may move from -2.5 to 2.5 "
                                   "rad. Are these degrees? The engine converts joints' ranges, "
                                   "never ctrlrange: edits: [{actuator: 's2', ctrlrange: [-2.5, "
                                   "2.5]}]"));
  EXPECT_THAT(Warnings({.knee_ctrl = "-7 7"}), IsEmpty());
}

TEST_F(ServoRanges, WarnsAboutAOneSidedForceWithAnEditThatFixesIt) {
  for (const auto& [range, low] : {std::pair{"0 60", "0 to 60"}, {"-60 0", "-60 to 0"}}) {
    const std::string ctrl = std::string("-2.5 2.5\" forcerange=\"") + range;
    EXPECT_THAT(
        Warnings({.knee_ctrl = ctrl}),
        ElementsAre(HasSubstr(std::string("the servo 's2' pushes in one direction only (its "
                                          "forcerange, ") +
                              low +
                              "), so it cannot hold joint 'knee'. For both directions: "
                              "edits: [{actuator: 's2', forcerange: [-60, 60]}]")));
    EXPECT_THAT(Warnings({.knee_ctrl = ctrl}, "edits: [{actuator: 's2', forcerange: [-60, 60]}]\n"),
                IsEmpty());
  }
}

// Returns the largest speed of the knee on its way to a target half a radian ahead.
double SpeedOfKnee(Scene scene) {
  scene.Reset();
  scene.SetActuatorCtrl("a/s2", 0.5);
  const int dof = scene.model()->jnt_dofadr[FindId(scene.model(), mjOBJ_JOINT, "a/knee")];
  double most = 0;
  for (int i = 0; i < 200; ++i) {
    EXPECT_TRUE(scene.Step().ok());
    most = std::max(most, std::abs(scene.data()->qvel[dof]));
  }
  return most;
}

TEST_F(ServoRanges, NotesAServoThatCannotDampWithAnEditThatFixesIt) {
  ModelText model;
  model.knee_ctrl += "\" forcerange=\"-5 5";
  Model(model);
  const Scene swings = Build();
  ASSERT_EQ(swings.compiled()->notes().size(), 1u);
  const std::string& note = swings.compiled()->notes()[0];
  EXPECT_THAT(note,
              AllOf(HasSubstr("robot 'arm': servos of 'arm' cannot damp their joints at their "
                              "force limit with a timestep of 0.002 s (kv dt / inertia, "
                              "stable up to 2): s2 "),
                    HasSubstr("edits: [{joint: 'knee', armature: 0.01}]")));
  EXPECT_GT(SpeedOfKnee(swings), 20);

  const size_t edits = note.find("edits: ");
  const Scene mended = Build(note.substr(edits, note.find(']') + 1 - edits) + "\n");
  EXPECT_THAT(mended.compiled()->notes(), IsEmpty());
  EXPECT_LT(SpeedOfKnee(mended), 6);

  model.knee_ctrl = "-2.5 2.5";  // damped implicitly at any force
  Model(model);
  EXPECT_THAT(Build().compiled()->notes(), IsEmpty());
}

TEST(ServosOfTheMenagerie, OnlyThoseOfTheGen3CannotDampAtTheirForceLimit) {
  const auto notes_about_damping = [](const char* file, bool with_edits) {
    SceneSpec spec = EmptyScene();
    RobotConfig config = RobotConfig::Load(SourceDir() + "/" + file);
    if (!with_edits) config.edits.clear();
    spec.robots.push_back({.name = "robot", .config = config});
    const Scene scene = Scene::Build(spec);
    std::string found;
    for (const std::string& note : scene.compiled()->notes())
      if (note.find("cannot damp") != std::string::npos) found += note;
    return found;
  };
  for (const auto& [file, model] : {std::pair{"xarm7.yaml", "ufactory_xarm7"},
                                    {"panda.yaml", "franka_emika_panda"},
                                    {"fr3_2f85.yaml", "franka_fr3"},
                                    {"gen3_2f85.yaml", "kinova_gen3"}}) {
    REQUIRE_MENAGERIE(model);
    EXPECT_EQ(notes_about_damping((std::string("examples/") + file).c_str(), true), "") << file;
  }
  EXPECT_THAT(notes_about_damping("examples/gen3_2f85.yaml", false),
              AllOf(HasSubstr("joint_7 "), HasSubstr("{joint: 'joint_7', armature: 0.05}")));
}

TEST_F(ServoRanges, OnlyActiveServos) {
  const std::string fine =
      "<actuator><position name=\"s0\" joint=\"hip\" ctrlrange=\"0.1 0.2\"/></actuator>";
  Model({.first = fine});
  EXPECT_THAT(Build("", ", actuators: [s1, s2]").compiled()->warnings(), IsEmpty());
  EXPECT_THAT(Build().compiled()->warnings(), ElementsAre(HasSubstr("the servo 's0' sends")));
  EXPECT_THAT(Warnings({.hip_ctrl = "1 2"}, "control: {arm: joint_torque}\n"), IsEmpty());
}

}  // namespace
}  // namespace robocell
