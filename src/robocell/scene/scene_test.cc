#include "robocell/scene/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scene/testing/workplace.h"
#include "robocell/testing/count_allocations.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

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

TEST(Scene, PosesMatchTheStateAfterAStep) {
  Scene scene = Scene::Build(Workplace());
  scene.SetActuatorCtrl("servo1", 1);
  EXPECT_TRUE(scene.StepN(20).ok());
  const Pose after_step = scene.site_pose("tcp");
  const Pose camera = scene.camera_pose("wrist_camera");
  scene.Forward();
  EXPECT_EQ(after_step, scene.site_pose("tcp"));
  EXPECT_EQ(camera, scene.camera_pose("wrist_camera"));
}

TEST(Scene, RejectsNegativeSteps) {
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

TEST(Scene, UsesAssignedLists) {
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

TEST(Scene, ReadingPosesDoesNotChangePhysics) {
  Scene quiet = Scene::Build(Workplace()), queried = Scene::Build(Workplace());
  for (int i = 0; i < 200; ++i) {
    quiet.data()->ctrl[0] = queried.data()->ctrl[0] = 0.01 * i;
    EXPECT_TRUE(quiet.Step().ok());
    EXPECT_TRUE(queried.Step().ok());
    queried.body_pose("cube");
  }
  EXPECT_EQ(quiet.state(), queried.state());
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

TEST(Scene, DivergenceIsAValue) {
  Scene scene = Scene::Build(Workplace());
  scene.data()->qvel[0] = 1e11;
  const StepResult result = scene.StepN(10);
  EXPECT_EQ(result.status, StepResult::kDiverged);
  EXPECT_EQ(result.steps, 1);
}

TEST(Scene, CopiesShareOneSimulation) {
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

TEST(Scene, ReportsThatItIsClosed) {
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
  const auto more = std::make_shared<CloseWatch>();
  Scene(inner).KeepObserver(more, "robot right");
  EXPECT_EQ(more.use_count(), 2) << "kept like through any other handle";
  last = inner.outer();
  EXPECT_EQ(weak.handles(), 1u) << "an outer handle counts";
  EXPECT_EQ(last->FindObserver("robot left"), watch.lock());
  last.reset();
  EXPECT_TRUE(watch.expired());
  EXPECT_EQ(weak.handles(), 0u);
  ExpectThrow<Error>([&] { Scene(inner).KeepObserver(std::make_shared<CloseWatch>(), "x"); },
                     "only inner handles are left");
  EXPECT_EQ(weak.lock(), std::nullopt);
  EXPECT_EQ(inner.time(), 0) << "the simulation lives";
}

TEST(Scene, NotifiesKeptObserversOfCloseAndReleasesThem) {
  Scene scene = Scene::Build(Workplace());
  auto watch = std::make_shared<CloseWatch>();
  scene.KeepObserver(watch, "robot left");
  scene.Close();
  EXPECT_EQ(watch->closed, 1);
  EXPECT_EQ(watch.use_count(), 1);
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
