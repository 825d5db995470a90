// The examples of the C++ reference: cpp_reference.py shows each with the names before the colon of
// its comment. tests/integration/test_cpp_examples.py compiles and runs them, and compares what they
// print with the comments on the lines that print.
//
//   cpp_examples            prints the names of the examples
//   cpp_examples PoseOf     runs one of them
#include <robocell/media/video_reader.h>
#include <robocell/media/video_writer.h>
#include <robocell/mujoco/compile.h>
#include <robocell/mujoco/step.h>
#include <robocell/robocell.h>
#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

using namespace robocell;
using std::cout;

namespace {

// begin: what the examples start with
SceneSpec CellSpec() {
  SceneSpec spec{.name = "cell", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  const RobotConfig rc7 = RobotConfig::Load(assets::BuiltinRobotFile("rc7"));
  spec.robots.push_back({.name = "arm", .config = rc7});
  spec.objects.push_back({.name = "cube",
                          .shape = Shape::kBox,
                          .size = Vec3{0.02, 0.02, 0.02},
                          .rgba = Vec4{1, 0.5, 0, 1},
                          .mass = 0.1,
                          .friction = Vec3{0.8, 0.02, 0.001},
                          .pos = Vec3{0.5, 0, 0.02}});
  return spec;
}

struct Start {
  SceneSpec spec = CellSpec();
  Scene scene = Scene::Build(spec);
  Robot robot = Robot::Of(scene, "arm");
  EnvConfig config = EnvConfig::Load(assets::BuiltinCellFile("rc7"));
  RunConfig run = RunConfig::Load("examples/demo.yaml");
  std::filesystem::path demo = "experiment_output/demo";  // `make demo` makes it
};
// end

std::map<std::string, std::function<void()>>& Examples() {
  static std::map<std::string, std::function<void()>> examples;
  return examples;
}

struct Registered {
  Registered(const std::string& name, std::function<void()> run) {
    Examples()[name] = std::move(run);
  }
};

#define EXAMPLE(name)                                              \
  struct name : Start {                                            \
    void Run();                                                    \
  };                                                               \
  const Registered registered_##name(#name, [] { name().Run(); }); \
  void name::Run()

// Scene, SceneSpec, StepResult: builds a scene, steps it and reads a pose.
EXAMPLE(SceneSteps) {
  Scene cell = Scene::Build(spec);
  cell.Reset({.seed = 1});
  const StepResult result = cell.StepN(500);  // 1 s; a divergence is a value, no exception
  const Pose cube = cell.body_pose("cube");
  const Pose tcp = cell.site_pose("tcp");
  cout << result.ok() << "\n";                                      // 1
  cout << (cube.translation() - tcp.translation()).norm() << "\n";  // 0.611...
}

// Scene: reads and writes MuJoCo's own model and data.
EXAMPLE(SceneModel) {
  cout << scene.model()->njnt << "\n";         // 10
  cout << scene.compiled()->frozen() << "\n";  // 0
  scene.data()->ctrl[0] = 0.3;
  scene.data()->qpos[scene.model()->jnt_qposadr[0]] += 0.1;
  scene.Forward();  // poses follow what was written
}

// Scene: returns to a state, to the bit.
EXAMPLE(SceneState) {
  const std::vector<double> start = scene.state();
  if (!scene.StepN(100).ok()) return;
  scene.SetState(start);
  cout << (scene.state() == start) << "\n";  // 1
}

// SceneObject, Shape, Vec3, Scene: adds an object to a running scene and removes it.
EXAMPLE(AddAndRemove) {
  SceneObject ball{.name = "ball", .shape = Shape::kSphere, .size = Vec3{0.03, 0, 0}};
  ball.rgba = {0.2, 0.4, 0.9, 1}, ball.mass = 0.05, ball.friction = {0.8, 0.02, 0.001};
  ball.pos = {0.5, 0.2, 0.1};
  scene.AddObject(ball);
  if (!scene.Step().ok()) return;
  scene.RemoveObject("ball");
  cout << scene.object_names().size() << "\n";  // 1
}

// RobotSpec, RobotConfig, JointVector: puts a second robot beside the first one.
EXAMPLE(TwoRobots) {
  const RobotConfig rc7 = RobotConfig::Load(assets::BuiltinRobotFile("rc7"));
  spec.robots.push_back({.name = "left", .config = rc7, .prefix = "left_", .pos = {0, 0.8, 0}});
  Scene cell = Scene::Build(spec);
  cout << Robot::Of(cell, "left").base_in_world().translation().y() << "\n";  // 0.8
}

// RobotConfig, Edit, ElementRef, BaseConfig, BaseKind, ControlKind, MoveGroupKind: describes a robot.
EXAMPLE(DescribeARobot) {
  RobotConfig arm{.name = "rc7", .model = "rc7"};
  arm.edits.push_back({.joint = ElementRef{.name = "joint1"}, .damping = 2.0});
  arm.base = BaseConfig{.kind = BaseKind::kMocap, .size = Vec3{0.2, 0.2, 0.3}};
  arm.move_groups["arm"].kind = MoveGroupKind::kArm;
  arm.move_groups["arm"].joints = {"joint1", "joint2", "joint3"};
  arm.control["arm"] = ControlKind::kJointPosition;
  cout << arm.move_groups["arm"].joints.size() << "\n";  // 3
}

// Robot: drives an arm through its ports.
EXAMPLE(RobotPorts) {
  robot.Update();  // reads the state, runs the controllers
  robot.jnt_pos_cmd()[0] += 0.3;
  for (int i = 0; i < 1000; ++i) {
    robot.Update();
    if (!scene.Step().ok()) break;
  }
  cout << (std::abs(robot.jnt_pos_msr()[0] - 0.3) < 0.01) << "\n";  // 1
}

// Robot, GroupCommand, MoveGroup: commands whole groups of a robot.
EXAMPLE(RobotCommands) {
  const std::vector<double> q = robot.arm().joint_pos();
  robot.Apply({{"arm", GroupCommand::Joints(q)}, {"gripper", GroupCommand::Opening(1)}});
  for (int i = 0; i < 500; ++i)
    if (!robot.Step().ok()) break;                    // Update() and a step of the scene
  cout << robot.arm().ctrl().size() << "\n";          // 7
  cout << (robot.gripper().opening() > 0.9) << "\n";  // 1
}

// Robot: makes a robot of two bodies, without a configuration.
EXAMPLE(RobotFromScene) {
  Robot arm = Robot::FromScene(scene, "base_link", "link7");
  cout << arm.n_joints() << "\n";          // 7
  cout << (arm.scene() == scene) << "\n";  // 1
}

// Robot: finds where base and tool are.
EXAMPLE(RobotPoses) {
  const Pose tcp = robot.base_in_world() * robot.FkFrame();
  cout << tcp.is_close(robot.tcp_in_world(), 1e-6, 1e-6) << "\n";  // 1
  robot.base().SetPose(Pose(Eigen::Vector3d(0.2, 0, 0)));
  cout << robot.base_in_world().translation().x() << "\n";  // 0.2
}

// Robot, CtrlMode: switches the arm to torques; the switch itself moves nothing.
EXAMPLE(TorqueMode) {
  spec.robots[0].control_modes = {CtrlMode::kPosition, CtrlMode::kTorque};
  Scene cell = Scene::Build(spec);
  Robot arm = Robot::Of(cell, "arm");
  arm.Update();
  arm.set_ctrl_mode(CtrlMode::kTorque);
  for (int i = 0; i < 500; ++i) {
    arm.Update();
    arm.GravityTorques(arm.jnt_trq_cmd());  // Nm; the arm stays where it is
    if (!cell.Step().ok()) break;
  }
  cout << (arm.ctrl_mode() == CtrlMode::kTorque) << "\n";  // 1
}

// Robot, Controller: gives a group another controller.
EXAMPLE(OtherController) {
  robot.SetController("arm", "cartesian_pose");
  cout << robot.controller("arm").kind() << "\n";  // cartesian_pose
}

// Pose, Quaternion: composes poses; quaternions are xyzw, angles radians.
EXAMPLE(PoseOf) {
  const Pose down = Pose::FromRpy({0.4, 0, 0.3}, {std::numbers::pi, 0, 0});
  const Pose above = down * Pose(Eigen::Vector3d(0, 0, -0.1));
  cout << above.translation().z() << "\n";  // 0.4
  cout << down.rotation()(2, 2) << "\n";    // -1
  const Quaternion xyzw = down.quaternion();
  cout << Pose(down.translation(), xyzw).is_close(down, 1e-9, 1e-9) << "\n";  // 1
}

// AngleBetween, Twist: measures a rotation and moves a pose.
EXAMPLE(Angles) {
  const Quaternion turned = Pose::FromRpy({0, 0, 0}, {0, 0, 0.5}).quaternion();
  cout << AngleBetween(turned, {0, 0, 0, 1}) << "\n";  // 0.5
  const Twist twist{.linear = {0.1, 0, 0}, .angular = {0, 0, 0.2}};
  cout << twist.vector()[5] << "\n";  // 0.2
}

// Chain, ChainTip, Transform: takes the kinematics out of a model.
EXAMPLE(ChainOfAModel) {
  const Chain chain(scene.model(), "base_link", ChainTip::Site("tcp"));
  cout << chain.n_joints() << " " << chain.joints()[0].name << "\n";  // 7 joint1
  const Pose tip_in_base = chain.Fk(JointVector(7, 0.1));
  cout << (tip_in_base.translation().norm() < 1.5) << "\n";  // 1
}

// Ik, IkResult, IkOptions, IkPrefer: solves inverse kinematics near a posture.
EXAMPLE(InverseKinematics) {
  const JointVector q{0, 0.2, 0, 1.5, 0, 1.2, 0};
  const Pose target = robot.chain().Fk(q);
  const IkResult found = Ik(robot.chain(), target, {.seed = q, .prefer = IkPrefer::kSeed});
  cout << found.success << "\n";                        // 1
  cout << (std::abs(found.q[3] - 1.5) < 1e-3) << "\n";  // 1
}

// IkBatch, IkBatchResult: solves many poses in one call.
EXAMPLE(ManyPoses) {
  const Pose target = robot.FkFrame();
  std::vector<Pose> targets(64, target);
  const IkBatchResult found = IkBatch(robot.chain(), targets);
  cout << found.solved() << "\n";       // 64
  cout << found.row(0).size() << "\n";  // 7
}

// Env, EnvConfig, EnvStep, EndReason, ControlMode, RelativeTo: steps an environment.
EXAMPLE(EnvSteps) {
  config.control_mode = ControlMode::kJoints;
  config.relative_to = RelativeTo::kNone;
  config.max_relative_movement = {};
  Env env(config);
  env.Reset({.seed = 1});
  std::vector<double> action(env.layout().action.lower);  // one number for each joint, the gripper
  const EnvStep step = env.Step(action);
  if (step.reason == EndReason::kDiverged) LogWarn(step.message);
  cout << env.observation().size() << "\n";            // 21
  cout << (env.motions()[0].joint_error > 0) << "\n";  // 1
  cout << (env.scene().time() > 0) << "\n";            // 1
}

// EnvBatch: steps copies of an environment on several threads.
EXAMPLE(BatchOfEnvs) {
  EnvBatch batch(config, 4);
  const std::vector<std::optional<uint64_t>> seeds = {0, 1, 2, 3};
  batch.Reset(seeds);
  const std::vector<double> actions(4 * batch.layout().action.size());
  const BatchStep& step = batch.Step(actions);
  cout << step.reward.size() << "\n";  // 4
}

// EnvRecorder: records what an environment does as a dataset.
EXAMPLE(RecordAnEnv) {
  std::filesystem::remove_all("out/recorded");
  Env env(config);
  EnvRecorder recorder(env, "out/recorded");
  env.Reset({.seed = 1});
  env.Step(env.layout().action.lower);
  recorder.Save({.success = true, .reason = "done"});
  cout << recorder.episodes()[0] << "\n";  // episode-000000
}

// RunConfig, PickTaskConfig, Rates, ValidateRun: configures a run and checks it.
EXAMPLE(ConfigureARun) {
  run.task = PickTaskConfig{.objects = {"box", "nut"}};
  run.rates = Rates{.policy_ms = 66, .control_ms = 2, .sim_ms = 2};
  const std::vector<Finding> warnings = ValidateRun(run);  // throws SpecError with all problems
  cout << warnings.size() << "\n";                         // 0
}

// List: a list of parts of a spec: what is added last is at its end, and copies share nothing.
EXAMPLE(ListOfParts) {
  spec.objects.back().mass = 0.2;
  const List<SceneObject> before = spec.objects;
  spec.objects.push_back({.name = "ball", .shape = Shape::kSphere, .size = Vec3{0.03, 0, 0}});
  cout << spec.objects.back().name << ", " << before.back().name << "\n";  // ball, cube
}

// Problems: collects what is wrong with a spec, so that everything is reported at once.
EXAMPLE(CollectProblems) {
  Problems problems;
  problems.AddAt("mass", "has to be above 0");
  problems.AddAt("size", "has one number too few");
  cout << problems.list().size() << "\n";      // 2
  cout << problems.list()[1].message << "\n";  // has one number too few
}

// Runner, PrepareDataset, MakePlan, ItemResult, Verify, VerifyResult: generates one episode.
EXAMPLE(GenerateOneEpisode) {
  run.output = "examples_output";
  PrepareDataset(run);
  Runner runner(run);
  const ItemResult result = runner.Run(MakePlan(run).front());
  cout << result.success << "\n";                         // 1
  cout << Verify("examples_output").good.size() << "\n";  // 1
}

// StartSampler, EpisodeStart, Rng, SampleRequest: samples the start of an episode.
EXAMPLE(SampleAStart) {
  StartSampler sampler(run);
  Rng rng = Rng::Stream(0, "start");
  const SampleResult result = sampler.Sample({.scene = 0, .episode = 0}, rng);
  if (result.start)
    std::cerr << result.start->task->instruction() << "\n";
  else
    std::cerr << result.refusal.reason << "\n";
}

// RunEnv: steps through an episode of a run by hand.
EXAMPLE(StepARun) {
  RunEnv env(run);
  env.Reset(0);
  cout << env.start().object_kinds.empty() << "\n";  // 0
}

// ObjectPlace, Relation: says where objects start.
EXAMPLE(ObjectPlaces) {
  const ObjectPlace place{.on_top_of = "table"};
  cout << (place.relation() == Relation::kOnTopOf) << "\n";  // 1
}

// Dataset, Episode, CameraInfo: reads a dataset.
EXAMPLE(ReadADataset) {
  const Dataset dataset(demo);
  cout << dataset.ids()[0] << "\n";  // s0000_e0000
  const Episode episode = dataset.At(0);
  const std::vector<double> q = episode.Read<double>("robots/rc7/arm/qpos");  // rows x 7
  cout << (q.size() == 7 * static_cast<size_t>(episode.rows())) << "\n";      // 1
  cout << episode.success() << " " << episode.camera("wrist").width << "\n";  // 1 64
  cout << episode.json().front() << "\n";                                     // {
}

// EpisodeWriter, EpisodeSchema: writes an episode of your own.
EXAMPLE(WriteAnEpisode) {
  std::filesystem::remove_all("out/own");
  std::filesystem::create_directories("out/own");
  EpisodeSchema schema;
  const ColumnId time = schema.AddColumn({.name = "time", .units = "s"});
  EpisodeWriter episode("out/own", "own_0", schema);
  for (int i = 0; i < 10; ++i) {
    episode.Put(time, 0.1 * i);
    episode.EndRow();
  }
  episode.Commit({.success = true, .terminated = true, .end_reason = "success"});
  cout << Dataset("out/own").At(0).rows() << "\n";  // 10
}

// DatasetLock: keeps other runs and repairs out while you write.
EXAMPLE(LockADataset) {
  const DatasetLock lock(demo);
  try {
    DatasetLock second(demo);
  } catch (const IoError& error) {
    cout << "locked\n";  // locked
  }
}

// VideoWriter: writes a video; the file appears when it is complete.
EXAMPLE(WriteAVideo) {
  const std::vector<uint8_t> rgb(3 * 64 * 48, 128);
  VideoWriter writer("gray.mp4", {.width = 64, .height = 48, .fps_num = 25});
  for (int i = 0; i < 10; ++i) writer.Write(std::span<const uint8_t>(rgb));
  writer.Finish();
  cout << ReadVideoInfo("gray.mp4").frames << "\n";  // 10
}

// Viewer, ViewerOptions: shows a scene, here in memory; a window opens without on_screen = false.
EXAMPLE(ViewAScene) {
  Viewer viewer = Viewer::Open(robot, {.width = 320, .height = 240, .on_screen = false});
  viewer.set_realtime_factor(0);
  for (int i = 0; i < 10; ++i) viewer.Step();
  cout << viewer.is_running() << " " << scene.time() << "\n";  // 1 0.02
}

// Rng: draws numbers that depend on their keys alone.
EXAMPLE(RandomNumbers) {
  Rng rng = Rng::Stream(0, "scene", "kitchen", 17);
  const double x = rng.Uniform(-0.2, 0.2);
  const double noise = 0.001 * rng.Normal();
  cout << (std::abs(x) <= 0.2 && std::abs(noise) < 0.01) << "\n";  // 1
}

// AtomicWrite, ReadFile: replaces a file in one step.
EXAMPLE(ReplaceAFile) {
  AtomicWrite("note.txt", "the new content or the old one, never half");
  cout << ReadFile("note.txt").substr(0, 7) << "\n";  // the new
}

// Error, NotFoundError: names what exists when a name does not.
EXAMPLE(UnknownNames) {
  try {
    Robot::Of(scene, "art");
  } catch (const NotFoundError& error) {
    cout << error.what()
         << "\n";  // scene 'cell': no robot 'art'. Its robots: arm. Did you mean 'arm'?
  }
}

// Error, ArgumentError: rejects arguments of a wrong size.
EXAMPLE(WrongArguments) {
  try {
    robot.FkFrame(JointVector(2));
  } catch (const ArgumentError& error) {
    cout << error.what()
         << "\n";  // chain 'base_link' -> site 'tcp': q: expected 7 joint values, got 2
  }
}

// Error, SpecError: reports every problem of a spec at once.
EXAMPLE(WrongSpecs) {
  try {
    Scene::Build({.name = "cell", .timestep = 0, .add_floor = true, .add_skybox = true});
  } catch (const SpecError& error) {
    cout << error.what() << "\n";  // scene 'cell' is not valid: timestep: 0 must be greater than 0
  }
}

// Error, IoError: names the file and the reason.
EXAMPLE(MissingFiles) {
  try {
    Dataset("nowhere");
  } catch (const IoError& error) {
    cout << error.what() << "\n";  // no dataset 'nowhere': there is no such folder...
  }
}

// Error, ClosedError: distinguishes a closed scene from a wrong call.
EXAMPLE(ClosedScenes) {
  scene.Close();
  try {
    scene.Forward();
  } catch (const ClosedError& error) {
    cout << error.what() << "\n";  // scene 'cell' is closed
  }
}

// LogLevel, SetLogLevel: shows warnings and errors only.
EXAMPLE(LessLog) {
  SetLogLevel(LogLevel::kWarn);
  LogInfo("not shown");
  cout << LogLevelName(GetLogLevel()) << "\n";  // warn
}

// ParseXmlString, Compile, ModelPtr, Step, Forward: compiles MJCF and steps it, guarded.
EXAMPLE(CompileXml) {
  const std::string xml =
      "<mujoco><worldbody><body><freejoint/><geom size='.1'/></body></worldbody></mujoco>";
  const SpecPtr mjcf = ParseXmlString(xml, "ball");
  const ModelPtr model = Compile(mjcf.get());
  const DataPtr data = MakeData(model.get());
  Forward(model.get(), data.get());
  cout << Step(model.get(), data.get(), 500).ok() << "\n";  // 1
  cout << (data->qpos[2] < 0) << "\n";                      // 1
}

// Body, Site: attaches to an element of the scene.
EXAMPLE(AttachTo) {
  spec.objects[0].attach_to = Body("link7");
  spec.objects[0].fixed = true;
  spec.cameras.push_back(
      {.name = "wrist", .pos = Vec3{0.1, 0, 0}, .fovy = 60, .attach_to = Site("tcp")});
  cout << Scene::Build(spec).model()->ncam << "\n";  // 3
}

// Resolve: finds a model by its name.
EXAMPLE(FindAModel) {
  const std::string file = assets::Resolve("mug");
  cout << std::filesystem::path(file).extension().string() << "\n";  // .xml
}

}  // namespace

int main(int argc, char** argv) try {
  for (const auto& [name, run] : Examples())
    if (argc < 2)
      cout << name << "\n";
    else if (name == argv[1])
      run();
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
