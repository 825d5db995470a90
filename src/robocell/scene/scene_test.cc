#include "robocell/scene/scene.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <limits>
#include <thread>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/mujoco/model_watch.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/count_allocations.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

SceneSpec Workplace() {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.config = RobotConfig::Load(assets::BuiltinRobotFile("rc7"))});
  spec.objects.push_back(BoxObject("cube", {0.5, 0, 0.02}));
  return spec;
}

TEST(Scene, AFreeBoxFallsOntoTheFloor) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(BoxObject("cube", {0, 0, 0.5}));
  Scene scene = Scene::Build(spec);
  ASSERT_TRUE(scene.StepN(1000).ok());
  EXPECT_NEAR(scene.body_pose("cube").translation().z(), 0.02, 1e-3);
  EXPECT_NEAR(scene.time(), 2.0, 1e-9);
  EXPECT_EQ(scene.timestep(), 0.002);
}

TEST(Scene, TheBuiltInRobotStaysAtHome) {
  Scene scene = Scene::Build(Workplace());
  const Pose before = scene.site_pose("tcp");
  EXPECT_TRUE(scene.StepN(500).ok());
  EXPECT_TRUE(scene.site_pose("tcp").is_close(before, 0.005, 0.005));
}

TEST(Scene, StepsWithoutAllocating) {
  Scene scene = Scene::Build(Workplace());
  EXPECT_TRUE(scene.StepN(10).ok());
  const AllocationCount count;
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(scene.Step().ok());
  EXPECT_TRUE(scene.StepN(100).ok());
  scene.SyncPoses();
  scene.Forward();
  EXPECT_EQ(count.allocations(), 0);
}

TEST(Scene, PosesAreThoseOfTheStateAfterTheStep) {
  Scene scene = Scene::Build(Workplace());
  scene.SetActuatorCtrl("servo1", 1);
  EXPECT_TRUE(scene.StepN(20).ok());
  const Pose after_step = scene.site_pose("tcp");
  const Pose camera = scene.camera_pose("wrist_camera");
  scene.Forward();
  EXPECT_EQ(after_step, scene.site_pose("tcp"));
  EXPECT_EQ(camera, scene.camera_pose("wrist_camera"));
}

TEST(Scene, TimeOnlyGoesForward) {
  Scene scene = Scene::Build(EmptyScene());
  ExpectThrow<ArgumentError>([&] { (void)scene.StepN(-1); }, "cannot step -1 times");
  EXPECT_EQ(scene.time(), 0);
  EXPECT_TRUE(scene.StepN(0).ok());
  EXPECT_EQ(scene.time(), 0);
  EXPECT_EQ(scene.timestep(), 0.002);
  EXPECT_TRUE(scene.StepN(10).ok());
  EXPECT_NEAR(scene.time(), 10 * 0.002, 1e-15);
  EXPECT_TRUE(scene.Step().ok());
  EXPECT_NEAR(scene.time(), 11 * 0.002, 1e-15);
}

TEST(Scene, IsMadeOfTheListsThatWereAssigned) {
  ModelFolder folder;
  const RobotSpec arm{.path = folder.Write("arm", kTwoJointArm)};
  RobotSpec left = arm, right = arm;
  left.prefix = "l_", right.prefix = "r_";
  SceneSpec spec = EmptyScene();
  spec.robots = {arm};
  spec.objects = {BoxObject("a", {1, 0, 1}), BoxObject("b", {2, 0, 1})};
  spec.robots = {left, right};
  spec.objects = {BoxObject("c", {1, 0, 1})};
  const Scene scene = Scene::Build(spec);
  EXPECT_THAT(scene.body_names(),
              ::testing::UnorderedElementsAre("world", "l_base", "l_upper", "l_fore", "r_base",
                                              "r_upper", "r_fore", "c"));
  spec.robots = {};
  EXPECT_THAT(Scene::Build(spec).body_names(), ::testing::UnorderedElementsAre("world", "c"));
}

TEST(Scene, AskingForPosesDoesNotChangePhysics) {
  Scene quiet = Scene::Build(Workplace()), asked = Scene::Build(Workplace());
  for (int i = 0; i < 200; ++i) {
    quiet.data()->ctrl[0] = asked.data()->ctrl[0] = 0.01 * i;
    EXPECT_TRUE(quiet.Step().ok());
    EXPECT_TRUE(asked.Step().ok());
    asked.body_pose("cube");
  }
  EXPECT_EQ(quiet.state(), asked.state());
}

TEST(Scene, UnknownNamesSuggestTheNearest) {
  Scene scene = Scene::Build(Workplace());
  ExpectThrow<NotFoundError>([&] { scene.body_pose("cubee"); }, "scene 'test': no body 'cubee'.");
  ExpectThrow<NotFoundError>([&] { scene.site_pose("tpc"); }, "Did you mean 'tcp'?");
  ExpectThrow<NotFoundError>([&] { scene.camera_pose("wrist_cam"); },
                             "Did you mean 'wrist_camera'?");
  ExpectThrow<NotFoundError>([&] { scene.actuator_ctrl("servo11"); }, "no actuator 'servo11'");
  ExpectThrow<NotFoundError>([&] { scene.contacts("cub"); }, "no body 'cub'");
  EXPECT_FALSE(scene.has_actuator("servo11"));
  EXPECT_TRUE(scene.has_actuator("servo1"));
}

TEST(Scene, ListsNamesAndLabels) {
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  spec.robots.push_back(
      {.path = folder.Write("anonymous", R"(<worldbody><body name="base"><geom size="0.1"/>
      <body><joint axis="0 0 1"/><geom size="0.1"/><camera/></body></body></worldbody>)")});
  const Scene scene = Scene::Build(spec);
  EXPECT_THAT(scene.body_names(), ElementsAre("world", "base", "base:body0"));
  EXPECT_THAT(scene.joint_names(), ElementsAre("base:body0:joint0"));
  EXPECT_THAT(scene.camera_names(), IsEmpty());
}

TEST(Scene, MovesFreeBodiesAndStopsThem) {
  Scene scene = Scene::Build(Workplace());
  scene.SetBodyWrench("cube", {0, 0, 5}, {0, 0, 0});
  EXPECT_TRUE(scene.StepN(50).ok());
  scene.SetBodyPose("cube", Pose::FromRpy({1, 2, 3}, {0.1, 0.2, 0.3}));
  EXPECT_TRUE(
      scene.body_pose("cube").is_close(Pose::FromRpy({1, 2, 3}, {0.1, 0.2, 0.3}), 1e-12, 1e-12));
  const int dof =
      scene.model()->jnt_dofadr[RequireId(scene.model(), mjOBJ_JOINT, "cube_joint", "")];
  for (int i = 0; i < 6; ++i) EXPECT_EQ(scene.data()->qvel[dof + i], 0);
  ExpectThrow<ArgumentError>([&] { scene.SetBodyPose("link3", Pose()); },
                             "scene 'test': body 'link3' cannot be moved by its pose: it is "
                             "neither free nor a mocap body");
}

TEST(Scene, AWrenchActsUntilItIsChanged) {
  Scene scene = Scene::Build(Workplace());
  scene.SetBodyWrench("cube", {0, 0, 0.1 * 9.81 + 0.1}, {0, 0, 0});
  EXPECT_TRUE(scene.StepN(500).ok());  // one second with 1 m/s^2
  EXPECT_NEAR(scene.body_pose("cube").translation().z() - 0.02, 0.5, 0.01);
}

TEST(Scene, ActuatorsAreReadAndSetByName) {
  Scene scene = Scene::Build(Workplace());
  EXPECT_TRUE(scene.has_actuator("servo2"));
  EXPECT_FALSE(scene.has_actuator("finger"));
  scene.SetActuatorCtrl("servo2", 0.25);
  EXPECT_EQ(scene.actuator_ctrl("servo2"), 0.25);
  const int actuator = RequireId(scene.model(), mjOBJ_ACTUATOR, "servo2", "test");
  EXPECT_EQ(scene.data()->ctrl[scene.model()->actuator_ctrladr[actuator]], 0.25);
  ExpectThrow<NotFoundError>([&] { scene.actuator_ctrl("servo22"); },
                             "scene 'test': no actuator 'servo22'.");
  ExpectThrow<NotFoundError>([&] { scene.SetActuatorCtrl("srvo2", 0); }, "Did you mean 'servo2'?");
}

TEST(Scene, JointsAreReadByName) {
  Scene scene = Scene::Build(Workplace());
  const int joint = RequireId(scene.model(), mjOBJ_JOINT, "joint2", "test");
  scene.data()->qpos[scene.model()->jnt_qposadr[joint]] = 0.375;
  EXPECT_EQ(scene.joint_pos("joint2"), 0.375);
  ExpectThrow<NotFoundError>([&] { (void)scene.joint_pos("joint22"); },
                             "scene 'test': no joint 'joint22'.");
  ExpectThrow<ArgumentError>([&] { (void)scene.joint_pos("cube_joint"); },
                             "scene 'test': joint 'cube_joint' is free, whose position is more "
                             "than one number; ask for the pose of its body, body_pose(\"cube\")");
}

TEST(Scene, RefusesNumbersThatAreNotFinite) {
  Scene scene = Scene::Build(Workplace());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ExpectThrow<ArgumentError>(
      [&] { scene.SetActuatorCtrl("servo2", nan); },
      "scene 'test': control of actuator 'servo2' must be a finite number, got nan");
  ExpectThrow<ArgumentError>(
      [&] {
        scene.SetBodyWrench("cube", {0, nan, 0}, {0, 0, 0});
      },
      "force on body 'cube' must be a finite number");
}

TEST(Scene, TheWorldCannotBePushed) {
  Scene scene = Scene::Build(Workplace());
  ExpectThrow<ArgumentError>(
      [&] {
        scene.SetBodyWrench("world", {1, 0, 0});
      },
      "scene 'test': body 'world' cannot be pushed: nothing moves it. Name the body that is to "
      "feel the force. Its bodies: ");
}

TEST(Scene, ContactsSayWhoTouchesWhomAndHowHard) {
  Scene scene = Scene::Build(Workplace());
  EXPECT_TRUE(scene.StepN(200).ok());
  const std::vector<Contact> contacts = scene.contacts("cube");
  ASSERT_THAT(contacts, SizeIs(4));
  Eigen::Vector3d on_cube = Eigen::Vector3d::Zero();
  for (const Contact& c : contacts) {
    EXPECT_EQ(c.geom1, "floor");
    EXPECT_EQ(c.geom2, "cube_geom");
    EXPECT_EQ(c.body1, "world");
    EXPECT_EQ(c.body2, "cube");
    EXPECT_NEAR(c.distance, 0, 1e-3);
    EXPECT_NEAR(std::abs(c.position.x() - 0.5), 0.02, 1e-3);
    on_cube += c.force;
  }
  EXPECT_NEAR(on_cube.z(), 0.1 * 9.81, 0.01);
  EXPECT_THAT(scene.contacts("base_link"), IsEmpty());
}

TEST(Scene, GoesOnToTheBitFromASavedState) {
  Scene scene = Scene::Build(Workplace());
  scene.SetActuatorCtrl("servo1", 0.5);
  EXPECT_TRUE(scene.StepN(123).ok());
  const std::vector<double> saved = scene.state();
  EXPECT_TRUE(scene.StepN(77).ok());
  const std::vector<double> expected = scene.state();
  scene.Reset({.seed = 1});
  scene.SetState(saved);
  EXPECT_EQ(scene.state(), saved);
  EXPECT_TRUE(scene.StepN(77).ok());
  EXPECT_EQ(scene.state(), expected);
  ExpectThrow<ArgumentError>([&] { scene.SetState(std::vector<double>(3)); },
                             "numbers, got 3; states fit only the model they were taken from");
}

TEST(Scene, StatesThatAreNotFiniteAreRefusedByTheirNumbers) {
  Scene scene = Scene::Build(Workplace());
  const mjModel* m = scene.model();
  const std::vector<double> before = scene.state();
  const auto refuses = [&](int part, int index, const std::string& what) {
    const auto at = static_cast<size_t>(mj_stateSize(m, part - 1) + index);  // of all before it
    std::vector<double> state = before;
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      state[at] = bad;
      ExpectThrow<ArgumentError>(
          [&] { scene.SetState(state); },
          fmt::format("number {} of the state is {}: {}; all of a state is finite", at, bad, what));
      EXPECT_EQ(scene.state(), before);
    }
  };
  const int last_joint = static_cast<int>(m->njnt) - 1;
  const std::string first = Describe(m, mjOBJ_JOINT, 0);
  refuses(mjSTATE_TIME, 0, "the time");
  refuses(mjSTATE_QPOS, 0, "the position of " + first);
  refuses(mjSTATE_QPOS, static_cast<int>(m->nq) - 1,
          "the position of " + Describe(m, mjOBJ_JOINT, last_joint));
  refuses(mjSTATE_QVEL, 0, "the velocity of " + first);
  refuses(mjSTATE_WARMSTART, 0, "the warm start of " + first);
  refuses(mjSTATE_CTRL, m->actuator_ctrladr[m->nactuator - 1],
          "the control of " + Describe(m, mjOBJ_ACTUATOR, static_cast<int>(m->nactuator) - 1));
  refuses(mjSTATE_QFRC_APPLIED, 0, "the applied force of " + first);
  refuses(mjSTATE_XFRC_APPLIED, 8, "the wrench on " + Describe(m, mjOBJ_BODY, 1));
}

TEST(Scene, DivergenceIsAValue) {
  Scene scene = Scene::Build(Workplace());
  scene.data()->qvel[0] = 1e11;
  const StepResult result = scene.StepN(10);
  EXPECT_EQ(result.status, StepResult::kDiverged);
  EXPECT_EQ(result.steps, 1);
}

TEST(Scene, IsAHandleToOneSimulation) {
  Scene scene = Scene::Build(Workplace());
  Scene same = scene;
  EXPECT_TRUE(same.StepN(5).ok());
  EXPECT_EQ(scene.time(), same.time());
  EXPECT_TRUE(scene == same);
  EXPECT_FALSE(scene == Scene::Build(Workplace()));
}

struct CloseWatch : SceneObserver {
  void OnClose() override { ++closed; }
  int closed = 0;
};

TEST(Scene, SaysThatItIsClosed) {
  Scene scene = Scene::Build(Workplace());
  const Scene other = scene;
  const auto watch = std::make_shared<CloseWatch>();
  scene.AddObserver(watch);
  scene.Close();
  scene.Close();
  EXPECT_EQ(watch->closed, 1);
  EXPECT_TRUE(other.closed());
  ExpectThrow<ClosedError>([&] { EXPECT_TRUE(scene.Step().ok()); }, "scene 'test' is closed");
  ExpectThrow<ClosedError>([&] { other.body_pose("cube"); }, "scene 'test' is closed");
  EXPECT_EQ(scene.name(), "test");
}

TEST(Scene, FindsObserversByKeyWhileTheyLive) {
  Scene scene = Scene::Build(Workplace());
  auto watch = std::make_shared<CloseWatch>();
  scene.AddObserver(watch, "robot left");
  EXPECT_EQ(scene.FindObserver("robot left"), watch);
  EXPECT_EQ(scene.FindObserver("robot right"), nullptr);
  EXPECT_EQ(scene.FindObserver(""), nullptr);
  const auto other = std::make_shared<CloseWatch>(), third = std::make_shared<CloseWatch>();
  scene.AddObserver(other, "lamp");
  scene.AddObserver(third, "robot right");
  EXPECT_THAT(scene.FindObservers("robot "), ::testing::ElementsAre(watch, third));
  EXPECT_THAT(scene.FindObservers("robots"), ::testing::IsEmpty());
  watch.reset();
  EXPECT_THAT(scene.FindObservers("robot "), ::testing::ElementsAre(third));
  EXPECT_EQ(scene.FindObserver("robot left"), nullptr);
}

TEST(Scene, KeepsObserversWhileAnyHandleLives) {
  std::weak_ptr<CloseWatch> watch;
  std::optional<Scene> last;
  {
    Scene scene = Scene::Build(Workplace());
    const auto made = std::make_shared<CloseWatch>();
    watch = made;
    scene.KeepObserver(made, "robot left");
    last = scene;
    EXPECT_EQ(Scene::Weak(scene).handles(), 2u);
  }
  const Scene::Weak weak(*last);
  EXPECT_EQ(weak.handles(), 1u);
  EXPECT_EQ(*weak.lock(), *last);
  EXPECT_EQ(last->FindObserver("robot left"), watch.lock());
  const Scene inner = last->inner();
  EXPECT_EQ(inner, *last);
  EXPECT_EQ(weak.handles(), 1u) << "an inner handle does not count";
  ExpectThrow<Error>([&] { Scene(inner).KeepObserver(std::make_shared<CloseWatch>(), "x"); },
                     "through no inner handle");
  last.reset();
  EXPECT_TRUE(watch.expired());
  EXPECT_EQ(weak.handles(), 0u);
  EXPECT_EQ(weak.lock(), std::nullopt);
  EXPECT_EQ(inner.time(), 0) << "the simulation lives";
}

TEST(Scene, TellsKeptObserversThatItIsClosedAndLetsThemGo) {
  Scene scene = Scene::Build(Workplace());
  auto watch = std::make_shared<CloseWatch>();
  scene.KeepObserver(watch, "robot left");
  scene.Close();
  EXPECT_EQ(watch->closed, 1);
  EXPECT_EQ(watch.use_count(), 1);
}

TEST(Scene, TellsWhereTheControlsOfAnActuatorOfSeveralInputsStand) {
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.path = folder.Write("arm", TwoJointArmWithABall())});
  Scene scene = Scene::Build(spec);
  const std::string why =
      "scene 'test': actuator 'turn' has 3 controls, not one: ctrl[0] to ctrl[2], in the order of "
      "its inputs. Read and write them as data()->ctrl (in Python scene.data.ctrl[0:3])";
  ExpectThrow<ArgumentError>([&] { scene.SetActuatorCtrl("turn", 0.3); }, why);
  ExpectThrow<ArgumentError>([&] { scene.actuator_ctrl("turn"); }, why);
  scene.SetActuatorCtrl("servo1", 0.3);
  EXPECT_EQ(scene.data()->ctrl[3], 0.3);
  EXPECT_EQ(scene.actuator_ctrl("servo1"), 0.3);
}

TEST(CompiledScene, ThatIsNotFrozenServesOneSceneAtATime) {
  const auto compiled = CompileScene(Workplace());
  std::optional<Scene> scene = Scene::FromCompiled(compiled);
  ExpectThrow<Error>([&] { Scene::FromCompiled(compiled); },
                     "scene 'test': its compiled scene is used by another scene already, and what "
                     "one of them writes to the model would change the other. Freeze the compiled "
                     "scene to share it with Freeze (in Python freeze), or compile the spec again");
  scene->Close();
  scene = Scene::FromCompiled(compiled);
  scene.reset();
  scene = Scene::FromCompiled(compiled);
  compiled->Freeze();
  EXPECT_TRUE(Scene::FromCompiled(compiled).Step().ok());
}

TEST(CompiledScene, IsSharedBetweenScenesWhenFrozen) {
  const auto compiled = CompileScene(Workplace());
  compiled->Freeze();
  std::vector<std::vector<double>> ends(4);
  std::vector<std::thread> threads;
  for (auto& end : ends) {
    threads.emplace_back([&] {
      Scene scene = Scene::FromCompiled(compiled);
      EXPECT_TRUE(scene.StepN(200).ok());
      end = scene.state();
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& end : ends) EXPECT_EQ(end, ends[0]);
  Scene scene = Scene::FromCompiled(compiled);
  ExpectThrow<Error>(
      [&] { scene.mutable_model(); },
      "scene 'test': its compiled scene is frozen because it is shared between scenes");
}

TEST(CompiledScene, HasANewGenerationEachTime) {
  const uint64_t first = CompileScene(Workplace())->generation();
  EXPECT_LT(first, CompileScene(Workplace())->generation());
}

TEST(CompiledScene, HandsItsModelOverOnce) {
  const auto compiled = CompileScene(Workplace());
  mjModel* model = compiled->mutable_model();
  int freed = 0;
  compiled->AdoptModelKeeper(std::shared_ptr<void>(model, [&](void* m) {
    mj_deleteModel(static_cast<mjModel*>(m));
    ++freed;
  }));
  EXPECT_TRUE(compiled->model_is_external());
  ExpectThrow<Error>([&] { compiled->AdoptModelKeeper(std::make_shared<int>(1)); },
                     "its model was handed over already");
  {
    Scene scene = Scene::FromCompiled(compiled);
    EXPECT_EQ(scene.model(), model);
    EXPECT_TRUE(scene.StepN(10).ok());
  }
  EXPECT_EQ(freed, 0);
}

// Whoever keeps the model then may free it at any time.
TEST(CompiledScene, EndsItsModelForThoseWhoWatchItAlsoAfterItWasHandedOver) {
  auto compiled = CompileScene(Workplace());
  const std::shared_ptr<void> kept(compiled->mutable_model(),
                                   [](void* m) { mj_deleteModel(static_cast<mjModel*>(m)); });
  const ModelWatch watch(compiled->model());
  compiled->AdoptModelKeeper(kept);
  EXPECT_FALSE(watch.gone());
  compiled.reset();
  EXPECT_TRUE(watch.gone());
}

TEST(CompiledScene, TakesDataThatSomebodyElseMade) {
  int freed = 0;
  {
    Scene scene = Scene::Build(Workplace(), [&](CompiledScene& compiled) {
      mjData* data = mj_makeData(compiled.model());
      return DataHandle{data, std::shared_ptr<void>(data, [&](void* d) {
                          mj_deleteData(static_cast<mjData*>(d));
                          ++freed;
                        })};
    });
    EXPECT_TRUE(scene.StepN(5).ok());
    EXPECT_EQ(scene.data_keeper().use_count(), 1);
  }
  EXPECT_EQ(freed, 1);
}

TEST(CompiledScene, SaysWhatTheEngineRefuses) {
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(
      {.name = "ghost",
       .mjcf_path =
           folder.Write("ghost", R"(<worldbody><body name="g"><joint/></body></worldbody>)")});
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "scene 'test' / object 'ghost': " + spec.objects[0].mjcf_path +
                             ":1: body 'g': mass and inertia of moving bodies must be larger than "
                             "mjMINVAL. A body that moves needs a mass: give one of its geoms a "
                             "`mass` or the body an <inertial>");
}

TEST(Scene, SwappingObjectsOfThePoolAllocatesNothing) {
  SceneSpec spec = EmptyScene();
  spec.objects = {BoxObject("there", {0.5, 0, 0.02}), BoxObject("a", {0.5, 0.2, 0.02})};
  spec.objects[1].parked = true;
  Scene scene = Scene::Build(spec);
  const std::string name = "a";
  const Pose pose(Eigen::Vector3d(0.4, 0.4, 0.02));
  const AllocationCount count;
  for (int i = 0; i < 10; ++i) {
    scene.AddObject(name, pose);
    scene.RemoveObject(name);
  }
  EXPECT_EQ(count.allocations(), 0);
}

}  // namespace
}  // namespace robocell
