#include "robocell/rollout/check_run.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/menagerie.h"
#include "robocell/testing/source_dir.h"
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
  RunConfig run = RunConfig::Load(SourceDir() + "/examples/demo.yaml");
  run.locations = {};
  return run;
}

TEST(CheckRun, TheExamplesPass) {
  EXPECT_NO_THROW(CheckRun(Demo()));
  REQUIRE_MENAGERIE("ufactory_xarm7");
  EXPECT_NO_THROW(CheckRun(RunConfig::Load(SourceDir() + "/examples/xarm7_pick.yaml")));
}

TEST(CheckRun, StreamsThatCannotBeRecordedAreToldAllAtOnce) {
  RunConfig run = Demo();
  run.cameras.streams[0].rgb = false;
  run.cameras.streams[0].depth = true;
  run.cameras.streams[1].rate = 5;
  const std::string text =
      ExpectThrow<SpecError>([&] { CheckRun(run); }, "a recorded stream needs rgb: true");
  EXPECT_THAT(text, HasSubstr("(cameras.streams[0]).rgb"));
  EXPECT_THAT(text, HasSubstr("(cameras.streams[1]).rate"));
}

TEST(CheckRun, AnUnknownKindIsToldWithTheNearest) {
  RunConfig run = Demo();
  run.task.As<PickTaskConfig>().objects.names = {"box", "mgu"};
  const std::string text =
      ExpectThrow<SpecError>([&] { CheckRun(run); }, "task.objects[1]: task: no kind 'mgu'");
  EXPECT_THAT(text, HasSubstr("Did you mean 'mug'?"));
}

TEST(CheckRun, AnUnknownCameraIsToldWithNamesAsTheyAreWritten) {
  RunConfig run = Demo();
  run.cameras.streams[0].camera = "wirst_camera";
  const std::string text =
      ExpectThrow<SpecError>([&] { CheckRun(run); }, "(cameras.streams[0]).camera: ");
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
  run.scenes = FilesScenes{.files = {(folder / "table.xml").string()}};
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
              "robot: " +
                  SourceDir() +
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
                         file + ":9:25: stream 'b' (cameras.streams[1]).camera: ");
  RunConfig wrong = RunConfig::Load(file);
  wrong.task.As<PickTaskConfig>().objects.names = {"bix"};
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
  run.scenes = FilesScenes{.files = {(folder / "bare.xml").string()}};
  ExpectThrow<SpecError>([&] { CheckRun(run); }, "nowhere to put objects");
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
  FilesScenes scenes;
  for (const char* name : {"good.xml", "beside.xml", "bare.xml"})
    scenes.files.push_back((folder / name).string());
  run.scenes = scenes;
  ExpectThrow<SpecError>([&] { CheckRun(run); }, "so that it is beside the box");
  ExpectThrow<SpecError>([&] { CheckRun(run); }, "bare.xml': site 'table_top' needs a box geom");
}

TEST(CheckRun, ATableThatFallsIsTold) {
  RunConfig run = Demo();
  TempDir folder;
  const auto table = [&](const std::string& name, double height) {
    AtomicWrite(folder / name,
                fmt::format("<mujoco><worldbody><geom type='plane' size='5 5 1'/><body name='desk' "
                            "pos='0 0 {}'><freejoint/><geom type='box' size='.4 .4 .2'/><site "
                            "name='table_top' pos='0 0 .2'/></body></worldbody></mujoco>",
                            height));
    run.scenes = FilesScenes{.files = {(folder / name).string()}};
  };
  table("stands.xml", 0.2);
  EXPECT_NO_THROW(CheckRun(run));
  table("falls.xml", 1);
  const std::string text = ExpectThrow<SpecError>(
      [&] { CheckRun(run); },
      "site 'table_top' does not stay where objects are to be put: its body 'desk' has a joint, "
      "and moves by 0.8");
  EXPECT_THAT(text, HasSubstr("Take the joint out, or have the body stand on something"));
}

TEST(CheckRun, StreamsThatNoFileCanHoldAreToldWithoutAModel) {
  RunConfig run = Demo();
  run.cameras.streams[0].name = "left/wrist";
  run.cameras.streams[1].width = 20000;
  const std::string text = ExpectThrow<SpecError>([&] { CheckRunFields(run); },
                                                  "(cameras.streams[0]).name: stream name "
                                                  "'left/wrist' contains '/'");
  EXPECT_THAT(text,
              HasSubstr("(cameras.streams[1]): camera 'exo': size 20000x240 px is not between "
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
  run.start.base_distance = {0.3, 60};
  const std::string text = ExpectThrow<SpecError>([&] { CheckRun(run); },
                                                  "start.base_distance: [0.3, 60] m goes beyond");
  EXPECT_THAT(text, HasSubstr("of which 95 % is used"));
  EXPECT_NO_THROW(CheckRun(run, {.scripted_expert = false, .on_this_machine = false}))
      << "a sampler of the user's own may mean something else by it";
  // What is told as the most there is, is accepted: it is not rounded up.
  const size_t at = text.find("goes beyond ") + 12;
  (*run.start.base_distance)[1] = std::stod(text.substr(at));
  EXPECT_NO_THROW(CheckRun(run)) << (*run.start.base_distance)[1];
  (*run.start.base_distance)[1] += 0.001;
  ExpectThrow<SpecError>([&] { CheckRun(run); }, "] m goes beyond " + text.substr(at, 5));
  run = Demo();
  run.start.base_height_offset = -25;
  ExpectThrow<SpecError>([&] { CheckRun(run); }, "start.base_height_offset: -25 m puts the base");
}

TEST(CheckRun, ALiftThatNoArmHasIsRefused) {
  RunConfig run = Demo();
  run.task.As<PickTaskConfig>().lift_height = 10;
  const std::string text = ExpectThrow<SpecError>(
      [&] { CheckRun(run); }, "task.lift_height: 10 m is more than the arm can lift: it reaches ");
  EXPECT_THAT(text,
              HasSubstr(" m above the object, and lifts 0.05 m more than is asked for; give"));
  run.task.As<PickTaskConfig>().lift_height = 0.1;
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

TEST(CheckRun, AnArmThatItsWeightPullsDownIsTold) {
  RunConfig run = Demo();
  run.robot.config.gravcomp = false;
  EXPECT_THAT(CheckRun(run), Not(Contains(HasSubstr("touch at home"))));
  run.robot.config.force_limit = 3;
  EXPECT_THAT(CheckRun(run), Contains(AllOf(HasSubstr("pushes with all it may, 3 N m"),
                                            HasSubstr("gravity asks for"))));
}

// A run file beside a robot file: rc7's with other lines.
class CheckRobotFile : public ::testing::Test {
 protected:
  RunConfig WithRobot(const std::string& from, const std::string& to) {
    std::string text = ReadFile(kRc7 + "/rc7.yaml");
    for (const auto& [what, with] :
         {std::pair{from, to}, {std::string("model: rc7.xml"), "model: " + kRc7 + "/rc7.xml"}}) {
      EXPECT_NE(text.find(what), std::string::npos) << what;
      text.replace(text.find(what), what.size(), with);
    }
    AtomicWrite(folder_ / "robot.yaml", text);
    AtomicWrite(folder_ / "run.yaml", "run: r\nrobot: robot.yaml\noutput: out\n");
    return RunConfig::Load((folder_ / "run.yaml").string());
  }
  // Where the text stands in the robot's file: "robot.yaml:7:15".
  std::string PlaceOf(const std::string& text) const {
    const std::string file = ReadFile((folder_ / "robot.yaml").string());
    const size_t at = file.find(text), line = file.rfind('\n', at) + 1;
    return fmt::format("robot.yaml:{}:{}: ", 1 + std::count(file.begin(), file.begin() + at, '\n'),
                       at - line + 1);
  }

  const std::string kRc7 = SourceDir() + "/models/robots/rc7";
  TempDir folder_;
};

TEST_F(CheckRobotFile, BasesThatCannotBePlacedAreToldWithTheirLine) {
  for (const auto& [kind, why] : {std::pair{"fixed", "a fixed base cannot be moved"},
                                  {"planar", "a planar base moves in its plane only"},
                                  {"free", "a free base falls from there"}}) {
    const RunConfig run = WithRobot("kind: mocap", fmt::format("kind: {}", kind));
    const std::string text = ExpectThrow<SpecError>([&] { CheckRun(run); }, why);
    EXPECT_THAT(text, AllOf(HasSubstr(PlaceOf(kind) + "robot.base.kind: pick tasks put the robot"),
                            HasSubstr("give it `base: {kind: mocap}`")));
  }
}

TEST_F(CheckRobotFile, ControllersThatTakeNoJointPositionsAreToldWithThoseThatDo) {
  for (const auto& [control, takes] : {std::pair{"joint_torque", "joint torques"},
                                       {"joint_velocity", "joint velocities"},
                                       {"cartesian_pose", "a pose"},
                                       {"cartesian_impedance", "a pose"}}) {
    const RunConfig run = WithRobot("arm: joint_position", fmt::format("arm: {}", control));
    ExpectThrow<SpecError>(
        [&] { CheckRun(run); },
        fmt::format("{}robot.control.arm: the scripted expert sends the arm joint positions, and "
                    "'{}' takes {}; choose joint_position, relative_joint_position or "
                    "joint_impedance (an expert of your own may use other commands)",
                    PlaceOf(control), control, takes));
    EXPECT_NO_THROW(CheckRun(run, {.scripted_expert = false}));
  }
  for (const char* control : {"relative_joint_position", "joint_impedance"})
    EXPECT_NO_THROW(CheckRun(WithRobot("arm: joint_position", fmt::format("arm: {}", control))));
}

TEST(CheckRun, AKindThatTheGripperCannotHoldIsTold) {
  RunConfig run = Demo();
  run.robot.config.move_groups.find("gripper")->ctrl = GripperCtrl{.open = 10, .closed = 0};
  run.robot.config.move_groups.find("gripper")->distance.reset();
  run.task.As<PickTaskConfig>().objects.names = {"mug"};
  EXPECT_THAT(CheckRun(run),
              Contains(AllOf(HasSubstr("task.objects: gripper 'gripper' cannot hold 'mug' (it is "),
                             HasSubstr(" m high, and the gripper holds "),
                             HasSubstr("Leave the kind out of task.objects"))));
}

TEST(CheckRun, WhyAGripperThatIsWideEnoughCannotHoldAKindIsTold) {
  RunConfig run = Demo();
  run.task.As<PickTaskConfig>().objects.names = {"box"};
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

// A group that nothing drives has no actions, and is no reason to refuse a run.
TEST(CheckRun, AGroupWithoutAControllerIsToldAndRecordedWithoutActions) {
  TempDir folder;
  RunConfig run = Demo();
  std::string model = ReadFile(run.robot.config.source_dir + "/rc7.xml");
  const std::string end = "</actuator>";
  model.insert(model.find(end), "<motor name=\"fan\" joint=\"joint1\" gear=\"0.001\"/>");
  // The keyframe has a number for each actuator.
  const size_t ctrl = model.find(" 100\"", model.find("<keyframe>"));
  model.insert(ctrl + 4, " 0");
  AtomicWrite(folder / "rc7.xml", model);
  run.robot.config.source_dir = folder.path().string();
  run.robot.config.move_groups["fan"] = {.kind = MoveGroupKind::kGeneric, .actuators = {"fan"}};
  EXPECT_THAT(CheckRun(run, {.on_this_machine = false}),
              Contains(AllOf(HasSubstr("group 'fan' has no controller"),
                             HasSubstr("Without one nothing commands it"))));
}

}  // namespace
}  // namespace robocell
