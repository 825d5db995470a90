#include "robocell/task/door_swings.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/motion/clearance.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/task/relation_task_config.h"
#include "robocell/task/start_sampler.h"
#include "robocell/testing/pick_scene.h"

namespace robocell::internal {
namespace {

// A door of `height` m whose hinge stands at x = 1, with the robot of the demo beside it.
struct Doorway {
  ModelFolder folder;
  Scene scene;
  Robot robot;
};

Scene SceneWithDoor(ModelFolder& folder, double height) {
  SceneSpec spec = EmptyScene();
  const std::string h = std::to_string(0.5 * height);
  const std::string model =
      folder.Write("door",
                   "<worldbody><body name=\"frame\"><body name=\"leaf\"><joint name=\"hinge\" "
                   "axis=\"0 0 1\" range=\"0 90\"/>"
                   "<geom type=\"box\" size=\"0.4 0.02 " +
                       h + "\" pos=\"0.4 0 " + h + "\"/></body></body></worldbody>");
  spec.objects.push_back({.name = "door", .mjcf_path = model, .pos = Vec3{1, 0, 0}, .fixed = true});
  const RunConfig run = ExampleRun("demo.yaml");
  spec.robots.push_back({.name = "arm", .config = run.robot.config, .prefix = "robot_0/"});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return scene;
}

TEST(DoorSwings, OnlyHighHingedPartsAreDoors) {
  ModelFolder folder;
  const Scene high = SceneWithDoor(folder, 2);
  const std::vector<Articulation> doors = DoorsOf(DeriveAnnotations(high), high);
  ASSERT_EQ(doors.size(), 1U);
  EXPECT_EQ(doors[0].joint, "door_hinge");
  const Scene low = SceneWithDoor(folder, 0.8);
  EXPECT_TRUE(DoorsOf(DeriveAnnotations(low), low).empty());
}

TEST(DoorSwings, ARobotIsRefusedExactlyWhereTheDoorWouldTouchItInSomePosture) {
  ModelFolder folder;
  Scene scene = SceneWithDoor(folder, 2);
  Robot robot = Robot::Of(scene, "arm");
  const std::vector<Articulation> doors = DoorsOf(DeriveAnnotations(scene), scene);
  const mjModel* m = scene.model();
  const int joint = FindId(m, mjOBJ_JOINT, "door_hinge");
  int refused = 0;
  for (int seed = 0; seed < 40; ++seed) {
    Rng rng = Rng::Stream(seed, "swing");
    robot.base().SetPose(Pose::FromRpy({rng.Uniform(0, 2.2), rng.Uniform(-0.8, 1.2), 0.3},
                                       {0, 0, rng.Uniform(-3, 3)}));
    scene.Forward();
    const std::vector<double> before = scene.state();
    const bool is_refused = ValidateDoorSwings(scene, robot, doors, 0.01).has_value();
    EXPECT_EQ(scene.state(), before);
    refused += is_refused;
    // The oracle opens the door in fine steps and measures the distance of the whole robot.
    double least = 1;
    for (double angle = 0; angle <= M_PI / 2; angle += 0.03) {
      scene.data()->qpos[m->jnt_qposadr[joint]] = angle;
      scene.Forward();
      least = std::min(least, RobotClearance(scene, robot, 1).distance);
    }
    scene.data()->qpos[m->jnt_qposadr[joint]] = 0;
    scene.Forward();
    // Between the postures of the two, the leaf's tip moves by 3 cm at most.
    if (least < -0.005) {
      EXPECT_TRUE(is_refused) << "seed " << seed << ", " << least;
    }
    if (least > 0.03) {
      EXPECT_FALSE(is_refused) << "seed " << seed << ", " << least;
    }
  }
  EXPECT_GT(refused, 4);
  EXPECT_LT(refused, 36);
}

// What a robot moves itself: only the part of the swing that it moves the door through counts, and only
// the base, as the arm goes along.
TEST(DoorSwings, ABaseStandsOutsideOfThePartThatItMoves) {
  ModelFolder folder;
  Scene scene = SceneWithDoor(folder, 2);
  Robot robot = Robot::Of(scene, "arm");
  const std::vector<Articulation> doors = DoorsOf(DeriveAnnotations(scene), scene);
  const JointOpening opening = JointOpening::Of(scene, "door");
  // The leaf turns from +x towards +y about x = 1; the base stands at 60 degrees of its swing.
  robot.base().SetPose(Pose::FromRpy({1 + 0.6 * 0.5, 0.6 * 0.87, 0}, {0, 0, 0}));
  scene.Forward();
  const std::vector<double> before = scene.state();
  EXPECT_TRUE(ValidateDoorSwings(scene, robot, doors, 0.01).has_value());
  EXPECT_FALSE(ValidateMovedJoint(scene, robot, opening, 0.1, 0.01).has_value());
  const auto refusal = ValidateMovedJoint(scene, robot, opening, 0.9, 0.01);
  ASSERT_TRUE(refusal.has_value());
  EXPECT_EQ(refusal->reason, Refusal::kInDoorSwing);
  EXPECT_EQ(scene.state(), before);
  // Of a robot beside the swing, the arm alone may be inside.
  for (int seed = 0; seed < 20; ++seed) {
    Rng rng = Rng::Stream(seed, "part of a swing");
    robot.base().SetPose(Pose::FromRpy({rng.Uniform(0, 2.2), rng.Uniform(-0.8, 1.2), 0.3},
                                       {0, 0, rng.Uniform(-3, 3)}));
    scene.Forward();
    if (ValidateMovedJoint(scene, robot, opening, 1, 0.01)) {
      EXPECT_TRUE(ValidateDoorSwings(scene, robot, doors, 0.01).has_value()) << seed;
    }
  }
}

// A table, and a door with a handle in a doorway behind it.
class WithADoor final : public SceneSource {
 public:
  struct Config {
    static constexpr const char* kKind = "with_a_door_of_test";
    static constexpr const char* kTypeName = "Config";
    std::string model;
    template <class V>
    static void Fields(V&& v) {
      v("model", &Config::model, "The door.");
    }
  };
  explicit WithADoor(const Config& fields) : fields_(fields) {}
  std::optional<int> size() const override { return 1; }
  SceneSpec Make(int /*index*/) override {
    SceneSpec spec{.base = "tabletop", .add_floor = true, .add_skybox = true};
    spec.objects.push_back(
        {.name = "door", .mjcf_path = fields_.model, .pos = Vec3{0, 3, 0}, .fixed = true});
    return spec;
  }

 protected:
  std::optional<SceneAnnotations> KnownAnnotations(int index) override { return Derive(index); }

 private:
  Config fields_;
};

// A robot that opens a door stands in its swing; one that does anything else does not.
TEST(DoorSwings, ARobotThatOpensADoorStandsInFrontOfIt) {
  RegisterSceneSource<WithADoor::Config>(
      std::make_shared<SceneSourceKindOf<WithADoor::Config, WithADoor>>());
  ModelFolder folder;
  const std::string model = folder.Write("door", R"(
    <worldbody><body name="frame"><body name="leaf"><joint name="hinge" axis="0 0 1" range="0 86"/>
      <geom type="box" size=".02 .4 1" pos="0 .4 1.01" mass="5"/>
      <geom name="handle" type="capsule" size=".01 .08" pos="-.07 .7 .8" mass=".1"/>
      <geom type="box" size=".03 .01 .01" pos="-.04 .7 .8" mass=".1"/>
    </body></body></worldbody>)");
  RunConfig run = ExampleRun("pick_and_place.yaml");
  run.start = {};
  run.scenes = WithADoor::Config{model};
  run.task = RelationsTaskConfig{.goal = {"door open 0.25"}};
  StartSampler sampler(run);
  std::optional<EpisodeStart> start;
  RefusalCounts reasons;
  for (int attempt = 0; attempt < 20 && !start; ++attempt) {
    Rng rng = Rng::Stream(1, "door", attempt);
    SampleResult result = sampler.Sample({.attempt = attempt}, rng);
    start = std::move(result.start);
    if (!start) ++reasons[result.refusal.reason + ": " + result.refusal.detail];
  }
  ASSERT_TRUE(start.has_value()) << ::testing::PrintToString(reasons);
  Scene scene = start->scene;
  Robot robot = RobotsOf(scene).front();
  const JointOpening opening = JointOpening::Of(scene, "door");
  EXPECT_FALSE(ValidateMovedJoint(scene, robot, opening, 0.35, 0.005).has_value());
  const std::vector<Articulation> doors = DoorsOf(DeriveAnnotations(scene), scene);
  ASSERT_EQ(doors.size(), 1U);
  EXPECT_TRUE(ValidateDoorSwings(scene, robot, doors, 0.01).has_value());
}

// A hinge may turn many times; its postures come again after the first turn.
TEST(DoorSwings, AHingeOfManyTurnsIsCheckedForOne) {
  ModelFolder folder;
  Scene scene = SceneWithDoor(folder, 2);
  Robot robot = Robot::Of(scene, "arm");
  std::vector<Articulation> doors = DoorsOf(DeriveAnnotations(scene), scene);
  robot.base().SetPose(Pose({1, 0.4, 0.3}));  // half a meter along the open leaf
  scene.Forward();
  doors[0].range = {0, 1e9};
  EXPECT_TRUE(ValidateDoorSwings(scene, robot, doors, 0.01));
  robot.base().SetPose(Pose({1, 0.4, 5}));  // above it
  scene.Forward();
  EXPECT_FALSE(ValidateDoorSwings(scene, robot, doors, 0.01));
}

}  // namespace
}  // namespace robocell::internal
