#include "robocell/datagen/check_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/menagerie.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

RunConfig Demo() {
  RunConfig run = RunConfig::Load(std::string(ROBOCELL_SOURCE_DIR) + "/examples/demo.yaml");
  run.locations = {};
  return run;
}

TEST(CheckRun, TheExamplesPass) {
  EXPECT_NO_THROW(CheckRun(Demo()));
  REQUIRE_MENAGERIE("ufactory_xarm7");
  EXPECT_NO_THROW(
      CheckRun(RunConfig::Load(std::string(ROBOCELL_SOURCE_DIR) + "/examples/xarm7_pick.yaml")));
}

TEST(CheckRun, StreamsThatCannotBeRecordedAreToldAllAtOnce) {
  RunConfig run = Demo();
  run.cameras.streams[0].segmentation = true;
  run.cameras.streams[1].rate = 5;
  const std::string text =
      ExpectThrow<SpecError>([&] { CheckRun(run); }, "segmentation cannot be recorded yet");
  EXPECT_THAT(text, HasSubstr("cameras.streams[0].segmentation"));
  EXPECT_THAT(text, HasSubstr("cameras.streams[1].rate"));
}

TEST(CheckRun, AnUnknownKindIsToldWithTheNearest) {
  RunConfig run = Demo();
  run.task.objects.names = {"box", "mgu"};
  const std::string text =
      ExpectThrow<SpecError>([&] { CheckRun(run); }, "task.objects[1]: task: no kind 'mgu'");
  EXPECT_THAT(text, HasSubstr("Did you mean 'mug'?"));
}

TEST(CheckRun, AnUnknownCameraIsToldWithNamesAsTheyAreWritten) {
  RunConfig run = Demo();
  run.cameras.streams[0].camera = "wirst_camera";
  const std::string text =
      ExpectThrow<SpecError>([&] { CheckRun(run); }, "cameras.streams[0].camera: ");
  EXPECT_THAT(text, HasSubstr("no camera 'wirst_camera'"));
  EXPECT_THAT(text, HasSubstr("Did you mean 'wrist_camera'?"));
  EXPECT_THAT(text, Not(HasSubstr("robot_0/")));
}

TEST(CheckRun, WhatWorksAndMayNotBeMeantIsReturned) {
  RunConfig run = Demo();
  EXPECT_THAT(CheckRun(run), IsEmpty());
  TempDir folder;
  AtomicWrite(folder / "table.xml",
              "<mujoco><option cone='elliptic'/><worldbody><body><geom type='box' size='.4 .4 .01' "
              "pos='0 0 -.01'/><site name='table_top'/></body></worldbody></mujoco>");
  run.scenes.files = {(folder / "table.xml").string()};
  run.scenes.source = SceneSourceKind::kFiles;
  run.cameras.resolution = {4, 4};
  run.options.cone = FrictionCone::kPyramidal;  // the table and the robot want another one
  EXPECT_THAT(CheckRun(run),
              ElementsAre(HasSubstr("base: asks for cone elliptic, the scene uses pyramidal"),
                          HasSubstr("robot 'rc7': asks for cone elliptic"),
                          HasSubstr("cameras.streams[0]: images of 'wrist' have 4 x 4 pixels"),
                          HasSubstr("cameras.streams[1]: images of 'exo'")));
}

TEST(CheckRun, TheFilesLinesAreNamed) {
  TempDir folder;
  AtomicWrite(folder / "run.yaml",
              "run: lines\n"
              "robot: " ROBOCELL_SOURCE_DIR
              "/models/robots/rc7/rc7.yaml\n"
              "output: out\n"
              "task:\n"
              "  objects: [box]\n"
              "cameras:\n"
              "  streams:\n"
              "    - {name: a, camera: wrist_camera}\n"
              "    - {name: b, camera: nowhere}\n");
  const std::string file = (folder / "run.yaml").string();
  ExpectThrow<SpecError>([&] { CheckRun(RunConfig::Load(file)); },
                         file + ":9:25: cameras.streams[1].camera: ");
  RunConfig wrong = RunConfig::Load(file);
  wrong.task.objects.names = {"bix"};
  ExpectThrow<SpecError>([&] { CheckRun(wrong); }, file + ":5:");
}

TEST(CheckRun, ARobotThatDoesNotCompileIsTold) {
  RunConfig run = Demo();
  run.robot.config.model = "rc8.xml";
  ExpectThrow<SpecError>([&] { CheckRun(run); }, "rc8.xml");
}

TEST(CheckRun, ASceneWithoutATableIsTold) {
  RunConfig run = Demo();
  TempDir folder;
  AtomicWrite(folder / "bare.xml", "<mujoco><worldbody><site name='floor'/></worldbody></mujoco>");
  run.scenes.files = {(folder / "bare.xml").string()};
  run.scenes.source = SceneSourceKind::kFiles;
  ExpectThrow<SpecError>([&] { CheckRun(run); }, "where should objects stand");
}

TEST(CheckRun, EverySceneNeedsATable) {
  RunConfig run = Demo();
  TempDir folder;
  const std::string site = "<site name='table_top'/>", begin = "<mujoco><worldbody><body>",
                    end = "</body></worldbody></mujoco>";
  AtomicWrite(folder / "good.xml",
              begin + "<geom type='box' size='.4 .4 .01' pos='0 0 -.01'/>" + site + end);
  AtomicWrite(folder / "beside.xml",
              begin + "<geom type='box' size='.4 .4 .01' pos='1 0 -.01'/>" + site + end);
  AtomicWrite(folder / "bare.xml", begin + "<geom type='sphere' size='.4'/>" + site + end);
  for (const char* name : {"good.xml", "beside.xml", "bare.xml"})
    run.scenes.files.push_back((folder / name).string());
  run.scenes.source = SceneSourceKind::kFiles;
  ExpectThrow<SpecError>([&] { CheckRun(run); }, "so that it is beside the box");
  ExpectThrow<SpecError>([&] { CheckRun(run); }, "bare.xml': site 'table_top' needs a box geom");
}

TEST(CheckRun, StreamsThatNoFileCanHoldAreToldWithoutAModel) {
  RunConfig run = Demo();
  run.cameras.streams[0].name = "left/wrist";
  run.cameras.streams[1].width = 20000;
  const std::string text = ExpectThrow<SpecError>([&] { CheckRunFields(run); },
                                                  "cameras.streams[0].name: stream name "
                                                  "'left/wrist' contains '/'");
  EXPECT_THAT(text, HasSubstr("cameras.streams[1]: camera 'exo': size 20000x240 px is not between "
                              "2x2 and 16384x16384"));
  run = Demo();
  run.cameras.resolution = {3, 0};  // told once
  EXPECT_THAT(ExpectThrow<SpecError>([&] { CheckRunFields(run); }, "must be greater than 0"),
              Not(HasSubstr("16384")));
}

TEST(CheckRun, ADistanceThatTheGripperDoesNotHaveIsRefused) {
  RunConfig run = Demo();
  run.robot.config.move_groups.find("gripper")->distance->open = 0.9;
  ExpectThrow<SpecError>([&] { CheckRun(run, {.scripted_expert = false}); },
                         "robot.move_groups.gripper.distance: the fingers are 0.002 m apart when "
                         "closed and 0.090 m when open, not 0.002 and 0.900");
}

TEST(CheckRun, DistancesOutOfReachAreToldWithTheReach) {
  RunConfig run = Demo();
  run.task.base_distance = {0.3, 60};
  const std::string text =
      ExpectThrow<SpecError>([&] { CheckRun(run); }, "task.base_distance: [0.3, 60] m goes beyond");
  EXPECT_THAT(text, HasSubstr("of which 95 % is used"));
  EXPECT_NO_THROW(CheckRun(run, {.scripted_expert = false, .on_this_machine = false}))
      << "a sampler of the user's own may mean something else by it";
  run = Demo();
  run.task.base_height_offset = -25;
  ExpectThrow<SpecError>([&] { CheckRun(run); }, "task.base_height_offset: -25 m puts the base");
}

TEST(CheckRun, ALiftThatNoArmHasIsRefused) {
  RunConfig run = Demo();
  run.task.lift_height = 10;
  const std::string text = ExpectThrow<SpecError>(
      [&] { CheckRun(run); }, "task.lift_height: 10 m is more than the arm can lift: it reaches ");
  EXPECT_THAT(text,
              HasSubstr(" m above the object, and lifts 0.05 m more than is asked for; give"));
  run.task.lift_height = 0.1;
  EXPECT_THAT(CheckRun(run), IsEmpty());
}

TEST(CheckRun, AnArmThatDoesNotFollowIsTold) {
  RunConfig run = Demo();
  run.robot.config.force_limit = 0.01;
  const std::vector<std::string> warnings = CheckRun(run);
  ASSERT_FALSE(warnings.empty());
  EXPECT_THAT(warnings[0], HasSubstr("pushes with all it may, 0.01 N m"));
  EXPECT_THAT(warnings[0], HasSubstr("Raise `force_limit` (0.01 is set)"));
  EXPECT_THAT(CheckRun(run, {.scripted_expert = false}), IsEmpty());
}

// As `check` does, on a floor: in free fall no servo is too weak.
TEST(CheckRun, AnArmOnAFreeBaseIsTriedUnderGravity) {
  RunConfig run = Demo();
  run.robot.config.base.kind = BaseKind::kFree;
  run.robot.config.gravcomp = false;
  EXPECT_THAT(CheckRun(run), Not(Contains(HasSubstr("touch at home"))));
  run.robot.config.force_limit = 3;
  EXPECT_THAT(CheckRun(run), Contains(AllOf(HasSubstr("pushes with all it may, 3 N m"),
                                            HasSubstr("gravity asks for"))));
}

TEST(CheckRun, AKindThatTheGripperCannotHoldIsTold) {
  RunConfig run = Demo();
  run.robot.config.move_groups.find("gripper")->ctrl = GripperCtrl{.open = 10, .closed = 0};
  run.robot.config.move_groups.find("gripper")->distance.reset();
  run.task.objects.names = {"mug"};
  EXPECT_THAT(CheckRun(run),
              Contains(AllOf(HasSubstr("task.objects: gripper 'gripper' cannot hold 'mug' (it is "),
                             HasSubstr(" m high, and the gripper holds from "),
                             HasSubstr("Leave the kind out of task.objects"))));
}

TEST(CheckRun, WhyAGripperThatIsWideEnoughCannotHoldAKindIsTold) {
  RunConfig run = Demo();
  run.task.objects.names = {"box"};
  // A spike between the fingers, long past the pads.
  run.robot.config.edits.push_back(
      {.geom = ElementRef{.name = "hand_palm"}, .size = Vec3{0.005, 0.005, 0.2}});
  EXPECT_THAT(CheckRun(run),
              Contains(AllOf(HasSubstr("cannot hold 'box' (it is "),
                             HasSubstr(", but on the way to that width its fingertips reach "),
                             HasSubstr(" m below the middle of the pads, so that they touch what "
                                       "it stands on before the pads have 0.012 m of it)"))));
}

TEST(CheckRun, AGripperThatCannotBeMeasuredIsToldOnce) {
  RunConfig run = Demo();
  MoveGroupConfig& gripper = *run.robot.config.move_groups.find("gripper");
  gripper.distance.reset();
  Edit narrow;
  narrow.actuator = ElementRef{.name = "gripper"};
  narrow.ctrlrange = Vec2{99.999, 100};
  run.robot.config.edits.push_back(narrow);
  for (const bool said : {true, false}) {
    gripper.ctrl = GripperCtrl{.open = 100, .closed = 99.999};
    if (!said) gripper.ctrl.reset();
    const std::string text =
        ExpectThrow<SpecError>([&] { CheckRun(run); }, "the finger distance stays at 0.0900 m");
    EXPECT_EQ(text.find("finger distance stays"), text.rfind("finger distance stays")) << text;
  }
}

TEST(CheckRun, ARunWithStreamsNeedsAnEncoder) {
  const RunConfig run = Demo();
  setenv("ROBOCELL_FFMPEG", "/no/such/ffmpeg", 1);
  ExpectThrow<IoError>([&] { CheckRun(run); },
                       "run 'demo' records 2 camera streams, on this machine that fails: "
                       "ROBOCELL_FFMPEG is '/no/such/ffmpeg'");
  EXPECT_NO_THROW(CheckRun(run, {.on_this_machine = false}));
  RunConfig blind = Demo();
  blind.cameras.streams = {};
  EXPECT_NO_THROW(CheckRun(blind));
  unsetenv("ROBOCELL_FFMPEG");
}

TEST(CheckRun, WhatTheScriptedExpertNeedsIsAskedOfItsRunsOnly) {
  RunConfig run = Demo();
  run.robot.config.base.kind = BaseKind::kFixed;
  ExpectThrow<SpecError>([&] { CheckRun(run); }, "a fixed base cannot be moved");
  EXPECT_NO_THROW(CheckRun(run, {.scripted_expert = false}));
}

}  // namespace
}  // namespace robocell
