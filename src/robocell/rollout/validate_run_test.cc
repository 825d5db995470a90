#include "robocell/rollout/validate_run.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/rollout/testing/demo.h"
#include "robocell/spec/kind_fields.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/task/task.h"
#include "robocell/task/task_kind.h"
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

TEST(ValidateRun, TheExamplesPass) {
  EXPECT_NO_THROW(ValidateRun(Demo()));
  REQUIRE_MENAGERIE("ufactory_xarm7");
  EXPECT_NO_THROW(ValidateRun(RunConfig::Load(SourceDir() + "/examples/xarm7_pick.yaml")));
}

TEST(ValidateRun, ReportsAllStreamsThatCannotBeRecorded) {
  RunConfig run = Demo();
  run.cameras.streams[0].rgb = false;
  run.cameras.streams[0].depth = true;
  run.cameras.streams[1].rate = 5;
  const std::string text =
      ExpectThrow<SpecError>([&] { ValidateRun(run); }, "a recorded stream needs rgb: true");
  EXPECT_THAT(text, HasSubstr("(cameras.streams[0]).rgb"));
  EXPECT_THAT(text, HasSubstr("(cameras.streams[1]).rate"));
}

TEST(ValidateRun, SuggestsTheNearestKind) {
  RunConfig run = Demo();
  run.task.As<PickTaskConfig>().objects.names = {"box", "mgu"};
  const std::string text =
      ExpectThrow<SpecError>([&] { ValidateRun(run); }, "task.objects[1]: no kind of object 'mgu'");
  EXPECT_THAT(text, HasSubstr("Did you mean 'mug'?"));
}

// Returns the problems of `places` in the demo's run.
std::string PlacesError(const Map<ObjectPlace>& places) {
  RunConfig run = Demo();
  run.start.places = places;
  return ExpectThrow<SpecError>([&] { ValidateRun(run, {.on_this_machine = false}); },
                                "run 'demo'");
}

TEST(ValidateRun, ReportsImpossiblePlacesBeforeTheFirstStart) {
  EXPECT_THAT(PlacesError({{"targt", {.next_to = "mug"}}}),
              AllOf(HasSubstr("start.places.targt: no object 'targt'"),
                    HasSubstr("Did you mean 'target'?")));
  EXPECT_THAT(PlacesError({{"target", {.on_top_of = "tabel"}}}),
              AllOf(HasSubstr("start.places.target: no object or body 'tabel'"),
                    HasSubstr("Did you mean 'table'?")));
  EXPECT_THAT(PlacesError({{"target", {.on_top_of = "target"}}}),
              HasSubstr("start.places.target: it refers to itself"));
  EXPECT_THAT(PlacesError({{"sphere", {.inside = "box"}}}),
              HasSubstr("start.places.sphere: 'box' has no hollow with a level floor"));
  EXPECT_THAT(PlacesError({{"mug", {.next_to = "box"}}, {"box", {.next_to = "mug"}}}),
              HasSubstr("start.places: these run in a circle"));
  RunConfig run = Demo();
  run.start.places = {{"object_1", {.next_to = "target"}}, {"mug", {.on_top_of = "box"}}};
  EXPECT_NO_THROW(ValidateRun(run, {.on_this_machine = false}));
}

TEST(ValidateRun, ReportsTheLineOfErrorsInPlaces) {
  TempDir folder;
  AtomicWrite(folder / "run.yaml", "run: mine\nrobot: " + assets::BuiltinRobotFile("rc7") +
                                       "\ntask: {kind: pick}\nstart:\n  places:\n"
                                       "    target: {next_to: object_11}\noutput: out\n");
  const RunConfig run = RunConfig::Load((folder / "run.yaml").string());
  const std::string text =
      ExpectThrow<SpecError>([&] { ValidateRun(run, {.on_this_machine = false}); },
                             "run.yaml:6:13: start.places.target: no object or body 'object_11'");
  EXPECT_THAT(text, HasSubstr("Did you mean 'object_1'"));
}

TEST(ValidateRun, SuggestsCamerasByTheirNamesInTheFile) {
  RunConfig run = Demo();
  run.cameras.streams[0].camera = "wirst_camera";
  const std::string text =
      ExpectThrow<SpecError>([&] { ValidateRun(run); }, "(cameras.streams[0]).camera: ");
  EXPECT_THAT(text, HasSubstr("no camera 'wirst_camera'"));
  EXPECT_THAT(text, HasSubstr("Did you mean 'wrist_camera'?"));
  EXPECT_THAT(text, Not(HasSubstr("robot_0/")));
}

// Starts name their objects by the part they have in the task, not by their kinds.
TEST(ValidateRun, AStreamFollowsWhatEachStartHas) {
  RunConfig run = Demo();
  run.task.As<PickTaskConfig>().objects.names = {"mug", "box", "cylinder"};
  CameraConfig& stream = run.cameras.streams[0];
  stream.camera.clear();
  const auto following = [&](const std::string& name) {
    stream.follow = name;
    return [&run] { ValidateRun(run); };
  };
  EXPECT_NO_THROW(following("target")());
  EXPECT_NO_THROW(following("table")());
  ExpectThrow<SpecError>(following("object_1"),
                         "(cameras.streams[0]).follow: 'object_1' is not in every start; follow an "
                         "object that is: target");
  ExpectThrow<SpecError>(following("box"), "no object or body 'box'");
  ExpectThrow<SpecError>(following("targte"), "Did you mean 'target'?");
  run.start.visible_from = {stream.name};
  EXPECT_NO_THROW(following("target")());
}

// The model decides on the names of its bodies.
TEST(ValidateRun, AStreamFollowsABodyOfAnObjectOfOneKind) {
  RunConfig run = Demo();
  run.cameras.streams[0].camera.clear();
  run.cameras.streams[0].follow = "target_mug";
  run.task.As<PickTaskConfig>().objects.names = {"mug"};
  EXPECT_NO_THROW(ValidateRun(run));
  run.task.As<PickTaskConfig>().objects.names = {"mug", "bottle"};
  ExpectThrow<SpecError>([&] { ValidateRun(run); }, "follow: ");
}

TEST(ValidateRun, RejectsAGoalAtWhichADrawnObjectCannotRest) {
  RunConfig run = Demo();
  PickAndPlaceTaskConfig task{.goal = Vec3{0.1, 0.2, 0.75}};
  task.objects.names = {"box", "mug"};
  run.task = task;
  const RunDemands here{.on_this_machine = false};
  const std::string text = ExpectThrow<SpecError>(
      [&] { ValidateRun(run, here); },
      "task.goal: box, mug cannot come to rest there ('box': put down there it falls by");
  EXPECT_THAT(text, HasSubstr("fits the height of each kind of `objects`"));
  run.task.As<PickAndPlaceTaskConfig>().goal = Vec3{0.1, 0.2, 0.48};
  EXPECT_NO_THROW(ValidateRun(run, here));
}

// Once, and with what holds for the body of a scene's file.
TEST(ValidateRun, ABodyOfTheScenesFileIsNoObjectOfTheTask) {
  TempDir folder;
  AtomicWrite(folder / "lab.xml", R"(<mujoco><worldbody>
    <body name="bench" pos="0 0 0.2"><geom type="box" size="0.5 0.5 0.2"/></body>
    <body name="cube" pos="0 0 0.42"><freejoint/><geom type="box" size="0.02 0.02 0.02"/></body>
    </worldbody></mujoco>)");
  AtomicWrite(folder / "run.yaml",
              "run: mine\nrobot: " + assets::BuiltinRobotFile("rc7") +
                  "\ntask: {kind: pick, object: cube}\nscenes: {files: [lab.xml]}\noutput: out\n");
  RunConfig run = RunConfig::Load((folder / "run.yaml").string());
  const std::string text =
      ExpectThrow<SpecError>([&] { ValidateRun(run, {.on_this_machine = false}); },
                             "task.object: no object 'cube': scene 0 of source 'files' has no "
                             "objects, which a source puts "
                             "into SceneSpec.objects, and a body of its model file is none");
  EXPECT_EQ(text.find("no object 'cube'"), text.rfind("no object 'cube'")) << text;
  run.task.As<PickTaskConfig>().object.clear();
  EXPECT_NO_THROW(ValidateRun(run, {.on_this_machine = false})) << "as the message says";
}

TEST(ValidateRun, ReportsAnUnknownExpertAtItsField) {
  RunConfig run = Demo();
  run.expert = "pikc";
  ExpectThrow<SpecError>([&] { ValidateRun(run); }, "expert: no expert 'pikc'");
}

TEST(ValidateRun, ReportsTheLinesOfTheFile) {
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
  ExpectThrow<SpecError>([&] { ValidateRun(RunConfig::Load(file)); },
                         file + ":9:25: stream 'b' (cameras.streams[1]).camera: ");
  RunConfig wrong = RunConfig::Load(file);
  wrong.task.As<PickTaskConfig>().objects.names = {"bix"};
  ExpectThrow<SpecError>([&] { ValidateRun(wrong); }, file + ":5:");
}

TEST(ValidateRun, ReportsARobotThatDoesNotCompile) {
  RunConfig run = Demo();
  run.robot.config.model = "rc8.xml";
  ExpectThrow<SpecError>([&] { ValidateRun(run); }, "rc8.xml");
}

TEST(ValidateRun, ReportsASceneWithoutATable) {
  RunConfig run = Demo();
  TempDir folder;
  AtomicWrite(folder / "bare.xml", "<mujoco><worldbody><site name='floor'/></worldbody></mujoco>");
  run.scenes = FilesScenes{.files = {(folder / "bare.xml").string()}};
  ExpectThrow<SpecError>([&] { ValidateRun(run); }, "no support for objects");
}

TEST(ValidateRun, EverySceneNeedsASupport) {
  RunConfig run = Demo();
  TempDir folder;
  const std::string begin = "<mujoco><worldbody><body>", end = "</body></worldbody></mujoco>";
  AtomicWrite(folder / "good.xml",
              begin + "<geom type='box' size='.4 .4 .01' pos='0 0 -.01'/>" + end);
  AtomicWrite(folder / "bare.xml", begin + "<geom type='sphere' size='.4'/>" + end);
  AtomicWrite(folder / "empty.xml", begin + end);
  FilesScenes scenes;
  for (const char* name : {"good.xml", "bare.xml", "empty.xml"})
    scenes.files.push_back((folder / name).string());
  run.scenes = scenes;
  ExpectThrow<SpecError>([&] { ValidateRun(run); }, "bare.xml': no support for objects");
  ExpectThrow<SpecError>([&] { ValidateRun(run); }, "empty.xml': no support for objects");
}

// A site of any name ends no run.
TEST(ValidateRun, NamesOfSitesDoNotMatter) {
  RunConfig run = Demo();
  TempDir folder;
  AtomicWrite(folder / "desk.xml",
              "<mujoco><worldbody><geom type='box' size='.4 .4 .2' pos='0 0 .2'/><body name='lamp' "
              "pos='0 0 2'><freejoint/><geom type='sphere' size='.1'/><site name='table_top'/>"
              "<site name='b_table_top'/></body></worldbody></mujoco>");
  run.scenes = FilesScenes{.files = {(folder / "desk.xml").string()}};
  EXPECT_NO_THROW(ValidateRun(run));
}

TEST(ValidateRun, RejectsInvalidStreamsWithoutAModel) {
  RunConfig run = Demo();
  run.cameras.streams[0].name = "left/wrist";
  run.cameras.streams[1].width = 20000;
  const std::string text = ExpectThrow<SpecError>([&] { ValidateRunFields(run); },
                                                  "(cameras.streams[0]).name: stream name "
                                                  "'left/wrist' contains '/'");
  EXPECT_THAT(text,
              HasSubstr("(cameras.streams[1]): camera 'exo': size 20000x240 px is not between "
                        "2x2 and 16384x16384"));
  run = Demo();
  run.cameras.resolution = {3, 0};  // reported once
  EXPECT_THAT(ExpectThrow<SpecError>([&] { ValidateRunFields(run); }, "must be greater than 0"),
              Not(HasSubstr("16384")));
}

TEST(ValidateRun, RejectsAWrongFingerDistance) {
  RunConfig run = Demo();
  run.robot.config.move_groups.find("gripper")->distance->open = 0.9;
  ExpectThrow<SpecError>([&] { ValidateRun(run, {.scripted_expert = false}); },
                         "robot.move_groups.gripper.distance: the fingers are 0.002 m apart when "
                         "closed and 0.090 m when open, not 0.002 and 0.900");
}

TEST(ValidateRun, ReportsDistancesBeyondTheReach) {
  RunConfig run = Demo();
  run.start.base_distance = {0.3, 60};
  const std::string text = ExpectThrow<SpecError>([&] { ValidateRun(run); },
                                                  "start.base_distance: [0.3, 60] m goes beyond");
  EXPECT_THAT(text, HasSubstr("of which 95 % is used"));
  EXPECT_NO_THROW(ValidateRun(run, {.scripted_expert = false, .on_this_machine = false}))
      << "a sampler of the user's own may mean something else by it";
  // The reported maximum is accepted: it is not rounded up.
  const size_t at = text.find("goes beyond ") + 12;
  (*run.start.base_distance)[1] = std::stod(text.substr(at));
  EXPECT_NO_THROW(ValidateRun(run)) << (*run.start.base_distance)[1];
  (*run.start.base_distance)[1] += 0.001;
  ExpectThrow<SpecError>([&] { ValidateRun(run); }, "] m goes beyond " + text.substr(at, 5));
  run = Demo();
  run.start.base_height_offset = -25;
  ExpectThrow<SpecError>([&] { ValidateRun(run); },
                         "start.base_height_offset: -25 m puts the base");
}

TEST(ValidateRun, RejectsAnImpossibleLift) {
  RunConfig run = Demo();
  run.task.As<PickTaskConfig>().lift_height = 3;
  const std::string text =
      ExpectThrow<SpecError>([&] { ValidateRun(run); },
                             "task.lift_height: 3 m is more than the arm can lift: it reaches ");
  EXPECT_THAT(text, HasSubstr(" m above the object, and lifts 0.05 m more than required; give"));
  run.task.As<PickTaskConfig>().lift_height = 0.1;
  EXPECT_THAT(ValidateRun(run), IsEmpty());
}

// A task of a user's own: a ball, and where the robot stands around it.
struct BallConfig {
  Vec2 distance = {0.3, 0.5};
  bool has_ball = true;
  std::string model = {};  // of the ball; "": a sphere

  static constexpr const char* kKind = "ball_of_validate_test";
  static constexpr const char* kTypeName = "BallConfig";
  template <class V>
  static void Fields(V&& v) {
    v("distance", &BallConfig::distance, "Of the base.");
    v("has_ball", &BallConfig::has_ball, "Whether there is a ball.");
    v("model", &BallConfig::model, "Model of the ball.");
  }
};

class Ball final : public Task {
 public:
  explicit Ball(const BallConfig& fields) : fields_(fields) {}
  void Prepare(SceneSpec& spec, Rng& /*rng*/) override {
    if (!fields_.has_ball) return;
    if (!fields_.model.empty()) {
      spec.objects.push_back({.name = "ball", .mjcf_path = fields_.model});
      return;
    }
    spec.objects.push_back({.name = "ball",
                            .shape = Shape::kSphere,
                            .size = Vec3{0.03, 0, 0},
                            .rgba = Vec4{1, 0, 0, 1},
                            .mass = 0.05,
                            .friction = Vec3{1, 0.02, 0.001}});
  }
  BaseRange base_range() const override { return {.distance = fields_.distance}; }
  TaskVerdict Judge(const Scene& /*scene*/) override { return {}; }
  std::string instruction() const override { return "look at the ball"; }
  std::string PlaceOfHook(const char* method) const override {
    return "mine.cc:7, in " + std::string(method);
  }

 private:
  BallConfig fields_;
};

RunConfig RunOfBall(const BallConfig& fields) {
  static const bool kRegistered = [] {
    RegisterTask<BallConfig>(std::make_shared<TaskKindOf<BallConfig, Ball>>());
    return true;
  }();
  (void)kRegistered;
  RunConfig run = Demo();
  run.task = fields;
  run.start = {};
  run.expert = "pick";
  return run;
}

// Every task that has an object to reach, by the ranges of the run and by its own.
TEST(ValidateRun, ReportsABaseRangeOutOfReachForAnyTask) {
  const RunDemands here{.on_this_machine = false};
  EXPECT_NO_THROW(ValidateRun(RunOfBall({}), here));
  ExpectThrow<SpecError>(
      [&] {
        ValidateRun(RunOfBall({.distance = {2, 3}}), here);
      },
      "task: the distance that base_range() of 'ball_of_validate_test' returns, [2, 3] m goes "
      "beyond ");
  EXPECT_THAT(ExpectThrow<SpecError>(
                  [&] {
                    ValidateRun(RunOfBall({.distance = {2, 3}}), here);
                  },
                  "give [smallest, largest] within that"),
              HasSubstr(" (mine.cc:7, in base_range)"));
  RunConfig run = RunOfBall({.distance = {2, 3}});
  run.start.base_distance = {{4, 5}};
  ExpectThrow<SpecError>([&] { ValidateRun(run, here); },
                         "start.base_distance: [4, 5] m goes beyond ");
  run.start.base_distance = {};
  run.start.base_height_offset = -7;
  ExpectThrow<SpecError>([&] { ValidateRun(run, here); }, "start.base_height_offset: -7 m puts");
  EXPECT_NO_THROW(ValidateRun(RunOfBall({.distance = {2, 3}, .has_ball = false}), here))
      << "there is nothing to reach";
}

// Environments name it alike.
TEST(ValidateRun, AModelThatATaskAddsIsNamedWithItsLine) {
  ExpectThrow<SpecError>(
      [&] { ValidateRun(RunOfBall({.model = "nowhere.xml"}), {.on_this_machine = false}); },
      "mine.cc:7, in prepare: object 'ball': model file 'nowhere.xml' not found");
}

// A run file beside a robot file: that of rc7 with other lines.
class ValidateRobotFile : public ::testing::Test {
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
  // Returns where the text stands in the robot's file: "robot.yaml:7:15".
  std::string PlaceOf(const std::string& text) const {
    const std::string file = ReadFile((folder_ / "robot.yaml").string());
    const size_t at = file.find(text), line = file.rfind('\n', at) + 1;
    return fmt::format("robot.yaml:{}:{}: ", 1 + std::count(file.begin(), file.begin() + at, '\n'),
                       at - line + 1);
  }

  const std::string kRc7 = SourceDir() + "/models/robots/rc7";
  TempDir folder_;
};

TEST_F(ValidateRobotFile, ReportsTheLineOfABaseThatCannotBePlaced) {
  for (const auto& [kind, why] : {std::pair{"fixed", "a fixed base cannot be moved"},
                                  {"planar", "no actuators drive this planar base"},
                                  {"free", "a free base falls from there"}}) {
    const RunConfig run = WithRobot("kind: mocap", fmt::format("kind: {}", kind));
    const std::string text = ExpectThrow<SpecError>([&] { ValidateRun(run); }, why);
    EXPECT_THAT(text,
                AllOf(HasSubstr(PlaceOf(kind) + "robot.base.kind: pick tasks must move the base"),
                      HasSubstr("Set `base: {kind: mocap}`")));
  }
}

TEST_F(ValidateRobotFile, RejectsControllersThatTakeNoJointPositions) {
  for (const auto& [control, takes] : {std::pair{"joint_torque", "joint torques"},
                                       {"joint_velocity", "joint velocities"},
                                       {"cartesian_pose", "a pose"},
                                       {"cartesian_impedance", "a pose"}}) {
    const RunConfig run = WithRobot("arm: joint_position", fmt::format("arm: {}", control));
    ExpectThrow<SpecError>(
        [&] { ValidateRun(run); },
        fmt::format("{}robot.control.arm: the scripted expert sends the arm joint positions, and "
                    "'{}' takes {}; choose joint_position, relative_joint_position or "
                    "joint_impedance (an expert of your own may use other commands)",
                    PlaceOf(control), control, takes));
    EXPECT_NO_THROW(ValidateRun(run, {.scripted_expert = false}));
  }
  for (const char* control : {"relative_joint_position", "joint_impedance"})
    EXPECT_NO_THROW(ValidateRun(WithRobot("arm: joint_position", fmt::format("arm: {}", control))));
}

TEST(ValidateRun, WarnsAboutAKindThatTheGripperCannotHold) {
  RunConfig run = Demo();
  run.robot.config.move_groups.find("gripper")->ctrl = GripperCtrl{.open = 10, .closed = 0};
  run.robot.config.move_groups.find("gripper")->distance.reset();
  run.task.As<PickTaskConfig>().objects.names = {"mug"};
  const std::vector<Finding> warnings = ValidateRun(run);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].subject, "task.objects");
  EXPECT_THAT(Line(warnings[0]),
              AllOf(HasSubstr("task.objects: gripper 'gripper' cannot hold 'mug' (it is "),
                    HasSubstr(" m high, and the gripper holds "),
                    HasSubstr("Leave the kind out of task.objects")));
}

TEST(ValidateRun, ExplainsWhyAWideGripperCannotHoldAKind) {
  RunConfig run = Demo();
  run.task.As<PickTaskConfig>().objects.names = {"box"};
  // A spike between the fingers, long past the pads.
  run.robot.config.edits.push_back(
      {.geom = ElementRef{.name = "hand_palm"}, .size = Vec3{0.005, 0.005, 0.2}});
  const std::vector<Finding> warnings = ValidateRun(run);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0].text,
              AllOf(HasSubstr("cannot hold 'box' (it is "),
                    HasSubstr(", but on the way to that width its fingertips reach "),
                    HasSubstr(" m below the middle of the pads, so that they touch what it stands "
                              "on before the pads have 0.012 m of it)")));
}

TEST(ValidateRun, ReportsAGripperThatCannotBeMeasuredOnce) {
  RunConfig run = Demo();
  MoveGroupConfig& gripper = *run.robot.config.move_groups.find("gripper");
  gripper.distance.reset();
  Edit narrow;
  narrow.actuator = ElementRef{.name = "gripper"};
  narrow.ctrlrange = Vec2{99.999, 100};
  run.robot.config.edits.push_back(narrow);
  for (const bool stated : {true, false}) {
    gripper.ctrl = GripperCtrl{.open = 100, .closed = 99.999};
    if (!stated) gripper.ctrl.reset();
    const std::string text =
        ExpectThrow<SpecError>([&] { ValidateRun(run); }, "the finger distance stays at 0.0900 m");
    EXPECT_EQ(text.find("finger distance stays"), text.rfind("finger distance stays")) << text;
  }
}

TEST(ValidateRun, ARunWithStreamsNeedsAnEncoder) {
  const RunConfig run = Demo();
  setenv("ROBOCELL_FFMPEG", "/no/such/ffmpeg", 1);
  ExpectThrow<IoError>([&] { ValidateRun(run); },
                       "run 'demo' records 2 camera streams, on this machine that fails: "
                       "ROBOCELL_FFMPEG is '/no/such/ffmpeg'");
  EXPECT_NO_THROW(ValidateRun(run, {.on_this_machine = false}));
  RunConfig blind = Demo();
  blind.cameras.streams = {};
  EXPECT_NO_THROW(ValidateRun(blind));
  unsetenv("ROBOCELL_FFMPEG");
}

TEST(ValidateRun, AppliesScriptedExpertRequirementsToItsRunsOnly) {
  RunConfig run = Demo();
  run.robot.config.base.kind = BaseKind::kFixed;
  ExpectThrow<SpecError>([&] { ValidateRun(run); }, "a fixed base cannot be moved");
  EXPECT_NO_THROW(ValidateRun(run, {.scripted_expert = false}));
}

}  // namespace
}  // namespace robocell
