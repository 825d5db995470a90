// Tests the start of an environment: falling and fixed objects, a floor, and usable starts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/env/env.h"
#include "robocell/env/env_batch.h"
#include "robocell/env/env_scene.h"
#include "robocell/env/testing/envs.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/body_handle.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Pose PlaceAt(double x, double y, double z) { return Pose(Eigen::Vector3d(x, y, z)); }

// Collects warnings during its lifetime.
class Warnings {
 public:
  Warnings() = default;
  std::vector<std::string> texts;

 private:
  ScopedLogSink sink_{[this](LogLevel level, std::string_view text) {
    if (level == LogLevel::kWarn) texts.emplace_back(text);
  }};
};

double HeightAfter(const EnvConfig& config, const std::string& body, int steps = 1500) {
  Scene scene = Scene::Build(EnvSceneSpec(config));
  scene.Reset();
  EXPECT_TRUE(scene.StepN(steps).ok());
  return scene.body_pose(body).translation().z();
}

EnvObject GreenCube(const Pose& at) { return {.mjcf_path = "green_cube", .offset = at}; }

TEST(EnvStart, FreeObjectsFallAndEquipmentStays) {
  EnvConfig config = Rc7Env();
  config.world_frame_objects["cube"] = GreenCube(PlaceAt(0.5, 0, 0.2));
  config.world_frame_objects["mug"] = {.mjcf_path = "mug", .offset = PlaceAt(0.5, 0.3, 0.2)};
  config.root_frame_objects["other"] = GreenCube(PlaceAt(0.5, -0.3, 0.2));
  config.root_frame_objects["mount"] = {.mjcf_path = "fr3_duo_mount", .offset = PlaceAt(-1, 0, 0)};
  EXPECT_NEAR(HeightAfter(config, "cube_green_cube"), 0.02, 1e-3);
  EXPECT_NEAR(HeightAfter(config, "other_green_cube"), 0.02, 1e-3);
  EXPECT_NEAR(HeightAfter(config, "mug_mug"), 0.04, 2e-3);
  const Scene scene = Scene::Build(EnvSceneSpec(config));
  EXPECT_FALSE(scene.compiled()->object("mount").free_joint);
}

TEST(EnvStart, FixedOverridesAnyModel) {
  TwoArmFolder folder;
  EnvConfig config = Rc7Env();
  config.world_frame_objects["cube"] = GreenCube(PlaceAt(0.5, 0, 0.2));
  config.world_frame_objects["cube"].fixed = true;
  config.world_frame_objects["box"] = {.mjcf_path = folder.box(), .offset = PlaceAt(0.5, 0.3, 0.2)};
  EXPECT_NEAR(HeightAfter(config, "cube_green_cube"), 0.2, 1e-9);
  EXPECT_NEAR(HeightAfter(config, "box_box"), 0.2, 1e-9) << "as its file says";
  config.world_frame_objects["box"].fixed = false;
  EXPECT_NEAR(HeightAfter(config, "box_box"), 0.02, 1e-3);
}

TEST(EnvStart, ObjectsInARobotFrameAreMounted) {
  EnvConfig config = Rc7Env();
  config.robots["robot"].attachment_site = "attachment_site";
  const Scene alone = Scene::Build(EnvSceneSpec(Rc7Env()));
  const std::vector<std::string> sites = ElementNames(alone.model(), mjOBJ_SITE);
  config.robots["robot"].attachment_site = sites.front().substr(std::string("robotrobot_").size());
  config.robot_frame_objects["robot"]["cube"] = GreenCube(PlaceAt(0, 0, 0.1));
  const Scene scene = Scene::Build(EnvSceneSpec(config));
  EXPECT_FALSE(scene.compiled()->object("cube").free_joint);
  config.robot_frame_objects["robot"]["cube"].fixed = false;
  ExpectThrow<SpecError>([&] { Scene::Build(EnvSceneSpec(config)); }, "can move freely");
}

TEST(EnvStart, WarnsAboutAFloatingObjectUnlessItIsDeclaredFixed) {
  TwoArmFolder folder;
  EnvConfig config = Rc7Env();
  config.world_frame_objects["box"] = {.mjcf_path = folder.box(), .offset = PlaceAt(0.5, 0.5, 0.2)};
  constexpr const char* text = "object 'box' hangs in the air: its model has no joint";
  {
    Warnings warnings;
    const Env env(config);
    EXPECT_THAT(warnings.texts, ElementsAre(HasSubstr(text)));
  }
  for (const auto& [fixed, z] :
       {std::pair<std::optional<bool>, double>{true, 0.2}, {false, 0.2}, {{}, 0.02}}) {
    config.world_frame_objects["box"].fixed = fixed;
    config.world_frame_objects["box"].offset = PlaceAt(0.5, 0.5, z);
    Warnings warnings;
    const Env env(config);
    EXPECT_THAT(warnings.texts, IsEmpty());
  }
}

EnvConfig CubeOnly() {
  EnvConfig config = Rc7Env();
  config.root_frame_objects["cube"] = GreenCube(PlaceAt(0.45, 0, 0.02));
  config.task = PickTaskConfig{.object = "cube", .spread = {0.05, 0.1}};
  return config;
}

TEST(EnvStart, TheEmptyWorldHasAFloorByDefault) {
  EnvConfig config = CubeOnly();
  Env env(config);
  env.Reset({.seed = 1});
  EXPECT_GE(FindId(env.scene().model(), mjOBJ_GEOM, "floor"), 0);
  EXPECT_GT(env.scene().model()->nlight, 0);
  config.scene = "tabletop";
  EXPECT_FALSE(config.has_added_floor());
  config.add_floor = true;
  EXPECT_TRUE(config.has_added_floor());
}

TEST(EnvStart, RejectsAnObjectThatFallsForever) {
  EnvConfig config = CubeOnly();
  config.add_floor = false;
  for (const bool batch : {false, true}) {
    ExpectThrow<SpecError>(
        [&] {
          if (batch) {
            EnvBatch(config, 2, 1);
          } else {
            Env env(config);
          }
        },
        "no episode can begin, because the objects of task 'pick' do not come to rest: nothing "
        "is under 'cube'. Put something under them: `add_floor: true`, or an object with");
  }
  config.task.reset();
  Warnings warnings;
  const Env env(config);
  EXPECT_THAT(warnings.texts,
              ElementsAre(HasSubstr("nothing is under cube, which falls for ever")));
}

TEST(EnvStart, AcceptsADroppedObject) {
  EnvConfig config = CubeOnly();
  config.root_frame_objects["cube"].offset = PlaceAt(0.45, 0, 0.15);
  Env env(config);
  env.Reset({.seed = 1});
  EXPECT_NEAR(env.scene().body_pose("cube_green_cube").translation().z(), 0.15, 1e-9);
}

TEST(EnvStart, LowersAnObjectOntoItsSupport) {
  EnvConfig config = CubeOnly();
  for (const double above : {0.001, 0.005, 0.04}) {
    config.root_frame_objects["cube"].offset = PlaceAt(0.45, 0, 0.02 + above);
    Env env(config);
    EnvBatch batch(config, 2, 1);
    for (uint64_t seed = 1; seed < 4; ++seed) {
      env.Reset({.seed = seed});
      batch.Reset(std::vector<std::optional<uint64_t>>{seed, seed}, {});
      const Pose start = env.scene().body_pose("cube_green_cube");
      EXPECT_NEAR(start.translation().z(), 0.02, 1e-6) << above;
      EXPECT_EQ(start, batch.env(1).scene().body_pose("cube_green_cube"));
      EXPECT_TRUE(Scene(env.scene()).StepN(250).ok());
      const Pose rest = env.scene().body_pose("cube_green_cube");
      EXPECT_LT((rest.translation() - start.translation()).norm(), 1e-3);
    }
  }
}

// A bench of 0.2 m on the floor, with the cube on it, beside its edge or over it.
EnvConfig CubeOnABench(double y) {
  EnvConfig config = CubeOnly();
  config.root_frame_objects["bench"] = {.offset = PlaceAt(0.45, 0.1, 0.05),
                                        .fixed = true,
                                        .shape = Shape::kBox,
                                        .size = Vec3{0.1, 0.1, 0.05},
                                        .mass = 1};
  config.root_frame_objects["cube"].offset = PlaceAt(0.45, y, 0.12);
  return config;
}

TEST(EnvStart, ObjectsDoNotOverhangAnEdge) {
  EnvConfig config = CubeOnABench(0.05);
  config.task->As<PickTaskConfig>().spread = {0, 0.08};
  Env env(config);
  double nearest = 1;
  for (uint64_t seed = 0; seed < 60; ++seed) {
    env.Reset({.seed = seed});
    nearest = std::min(nearest, env.scene().body_pose("cube_green_cube").translation().y());
  }
  EXPECT_GT(nearest, 0.015) << "four fifths of the cube's width stand on the bench";
  EXPECT_LT(nearest, 0.03) << "what is near the edge is not left out";
}

TEST(EnvStart, AnObjectPlacedOverAnEdgeMayOverhang) {
  Env env(CubeOnABench(0.005));
  env.Reset({.seed = 1});
  EXPECT_NEAR(env.scene().body_pose("cube_green_cube").translation().z(), 0.12, 1e-9);
}

TEST(EnvStart, WarnsAboutSelfCollisionOfARobot) {
  EnvConfig config = Rc7Env();
  config.robot_frame_objects["robot"]["box"] = {
      .offset = PlaceAt(0, 0, -0.1), .shape = Shape::kBox, .size = Vec3{0.1, 0.1, 0.1}, .mass = 1};
  {
    Warnings warnings;
    const Env env(config);
    EXPECT_THAT(warnings.texts,
                ElementsAre(::testing::AllOf(
                    HasSubstr("at the start robot 'robot' is inside itself: "), HasSubstr("box"),
                    HasSubstr(" deep in "), HasSubstr("Correct where the part is mounted"))));
  }
  Warnings warnings;
  const Env env(Rc7Env());
  EXPECT_THAT(warnings.texts, ::testing::IsEmpty());
}

TEST(EnvStart, WarnsOnceAboutTwoRobotsAtOnePlace) {
  EnvConfig config = Rc7Env();
  config.robots["other"] = config.robots["robot"];
  config.robot_to_shared_base_frame["other"] = PlaceAt(0.01, 0, 0);
  config.task.reset();
  Warnings warnings;
  const Env env(config);
  EXPECT_EQ(std::ranges::count_if(
                warnings.texts,
                [](const std::string& text) { return text.find("inside robot") < text.size(); }),
            1);
}

TEST(EnvStart, SuggestsUnusedFixesForAPenetratingRobot) {
  const auto warning = [](const EnvConfig& config) {
    Warnings warnings;
    const Env env(config);
    return warnings.texts.empty() ? std::string() : warnings.texts.front();
  };
  EnvConfig sunk = Rc7Env();
  sunk.robot_to_shared_base_frame["robot"] = PlaceAt(0, 0, -0.1);
  const std::string keeps = "`reset_root_pose: false`";
  EXPECT_THAT(warning(sunk), HasSubstr("deep in floor. Move the robot"));
  EXPECT_THAT(warning(sunk), HasSubstr(keeps));
  sunk.robots["robot"].reset_root_pose = false;
  EXPECT_THAT(warning(sunk), ::testing::Not(HasSubstr(keeps)));
  EnvConfig cube = Rc7Env();
  cube.root_frame_objects["cube"] = {.offset = PlaceAt(0, 0, 0.1),
                                     .fixed = true,
                                     .shape = Shape::kBox,
                                     .size = Vec3{0.1, 0.1, 0.1},
                                     .mass = 1};
  EXPECT_THAT(warning(cube), HasSubstr("Move 'cube' to a free place, or the robot"));
  EXPECT_THAT(warning(cube), ::testing::Not(HasSubstr(keeps)));
}

TEST(EnvStart, WarnsAboutPenetratingObjects) {
  EnvConfig config = CubeOnABench(0.05);
  config.task.reset();
  config.root_frame_objects["cube"].offset = PlaceAt(0.45, 0.1, 0.11);
  Warnings warnings;
  const Env env(config);
  EXPECT_THAT(warnings.texts,
              ElementsAre(HasSubstr("at the start object 'cube' is 10 mm inside bench")));
}

TEST(EnvStart, WarnsOnceAboutAnObjectInMillimetres) {
  EnvConfig config = CubeOnly();
  config.root_frame_objects["box"] = {
      .offset = PlaceAt(0.7, 0.3, 0.02), .shape = Shape::kBox, .size = Vec3{20, 20, 20}, .mass = 1};
  constexpr const char* text =
      "object 'box' is 40 m large, and lengths are in metres. Is it in millimetres? Then write its "
      "size and its position a thousandth as large (in millimetres it would be 0.04 m)";
  ExpectThrow<SpecError>([&] { Env env(config); }, text);
  config.task.reset();
  for (const bool fixed : {false, true}) {
    config.root_frame_objects["box"].fixed = fixed;
    Warnings warnings;
    const Env env(config);
    EXPECT_THAT(warnings.texts, ElementsAre(HasSubstr(text))) << fixed;
  }
  config.root_frame_objects["box"].size = Vec3{20, 20, 0.01};  // like a floor
  config.root_frame_objects["box"].offset = PlaceAt(0, 0, -0.02);
  Warnings warnings;
  const Env env(config);
  for (const std::string& warning : warnings.texts)
    EXPECT_THAT(warning, ::testing::Not(HasSubstr("millimetres")));
}

TEST(EnvStart, WarnsAboutAnObjectInTheFloor) {
  for (const double z : {-0.1, -0.3}) {
    EnvConfig config = CubeOnly();
    config.task.reset();
    config.root_frame_objects["cube"].offset = PlaceAt(0.45, 0, z);
    Warnings warnings;
    const Env env(config);
    const std::string depth = z == -0.1 ? "120 mm" : "320 mm";
    EXPECT_THAT(warnings.texts, ElementsAre(HasSubstr("object 'cube' is " + depth + " inside ")));
  }
}

std::string WhyRefused(const EnvConfig& config) {
  try {
    const Env env(config);
  } catch (const SpecError& error) {
    return error.what();
  }
  return "";
}

TEST(EnvStart, RejectsAnObjectThatFallsFar) {
  EnvConfig config = CubeOnly();
  config.root_frame_objects["cube"].offset = PlaceAt(0.45, 0, 2);
  EXPECT_THAT(WhyRefused(config),
              HasSubstr("'cube' of task 'pick' does not rest where it starts: it falls by 1.98 m"));
}

TEST(EnvStart, RejectsAnObjectThatTipsOver) {
  for (const double tilt : {0.0, 0.2, 0.3, 0.6}) {  // radians; on an edge, the cube rolls flat
    EnvConfig config = CubeOnly();
    config.root_frame_objects["cube"].offset =
        Pose::FromRpy(Eigen::Vector3d(0.45, 0, 0.03), Eigen::Vector3d(tilt, 0, 0));
    const std::string why = WhyRefused(config);
    if (tilt == 0) {
      EXPECT_EQ(why, "");
    } else {
      EXPECT_THAT(why, HasSubstr("does not rest where it starts: it tips over by")) << tilt;
    }
  }
}

// A second arm in the middle of the cube's range.
EnvConfig CubeAroundAnArm() {
  EnvConfig config = CubeOnly();
  config.robots = {{"left", config.robots.at("robot")}, {"right", config.robots.at("robot")}};
  config.robot_to_shared_base_frame["right"] = PlaceAt(0.55, 0.25, 0);
  config.task->As<PickTaskConfig>().spread = {0.2, 0.3};
  return config;
}

bool TouchesARobot(const Scene& scene) {
  const mjModel* m = scene.model();
  const int cube = FindId(m, mjOBJ_BODY, "cube_green_cube");
  for (int c = 0; c < scene.data()->ncon; ++c) {
    const mjContact& contact = scene.data()->contact[c];
    const int a = m->geom_bodyid[contact.geom[0]], b = m->geom_bodyid[contact.geom[1]];
    if ((a == cube) == (b == cube)) continue;
    if (ElementName(m, mjOBJ_BODY, a == cube ? b : a).starts_with("robot")) return true;
  }
  return false;
}

TEST(EnvStart, ObjectsStartNextToRobots) {
  EnvConfig config = CubeAroundAnArm();
  Env env(config);
  const BodyHandle cube(env.scene(), "cube_green_cube");
  int near = 0;
  for (uint64_t seed = 0; seed < 100; ++seed) {
    env.Reset({.seed = seed});
    const Pose start = cube.pose_in_world();
    EXPECT_FALSE(TouchesARobot(env.scene())) << seed;
    near += (start.translation() - Eigen::Vector3d(0.55, 0.25, 0.02)).norm() < 0.25 ? 1 : 0;
    env.Reset({.seed = seed + 1000});
    env.Reset({.seed = seed});
    EXPECT_EQ(cube.pose_in_world(), start) << "of the seed alone";
  }
  EXPECT_GT(near, 10) << "what lies near the arm is not left out";
}

TEST(EnvStart, CopiesOfABatchStartLikeASingleEnvironment) {
  const EnvConfig config = CubeAroundAnArm();
  Env env(config);
  EnvBatch batch(config, 3, 1);
  const std::vector<std::optional<uint64_t>> seeds = {11, 12, 13};
  batch.Reset(seeds, {});
  const auto size = static_cast<size_t>(env.layout().observation.size());
  for (size_t i = 0; i < seeds.size(); ++i) {
    env.Reset({.seed = seeds[i]});
    const std::span<const double> own = env.observation();
    const auto seen = batch.observations().subspan(i * size, size);
    EXPECT_TRUE(std::equal(own.begin(), own.end(), seen.begin())) << i;
  }
}

TEST(EnvStart, ReportsContactsIfNoPlaceIsFree) {
  EnvConfig config = CubeAroundAnArm();
  config.root_frame_objects["cube"].offset = PlaceAt(0.55, 0.25, 0.02);
  config.task->As<PickTaskConfig>().spread = {0.01, 0.01};
  ExpectThrow<SpecError>([&] { Env env(config); },
                         "environment 'env': task 'pick' found no start in 100 tries: most "
                         "often 'cube' touches robot 'right' (");
}

TEST(EnvStart, ObjectsDoNotStartOffTheirTable) {
  EnvConfig config = CubeOnly();
  config.root_frame_objects["bench"] = {.offset = PlaceAt(0.45, 0, 0.1),
                                        .fixed = true,
                                        .shape = Shape::kBox,
                                        .size = Vec3{0.1, 0.1, 0.1},
                                        .mass = 1};
  config.root_frame_objects["cube"].offset = PlaceAt(0.45, 0, 0.22);
  config.task->As<PickTaskConfig>().spread = {0.1, 0.3};
  Env env(config);
  for (uint64_t seed = 0; seed < 40; ++seed) {
    env.Reset({.seed = seed});
    EXPECT_TRUE(Scene(env.scene()).StepN(500).ok());
    EXPECT_GT(env.scene().body_pose("cube_green_cube").translation().z(), 0.2) << seed;
  }
}

TEST(EnvStart, WarnsAboutAChassisInTheFloor) {
  ModelFolder folder;
  const std::string chassis =
      folder.Write("chassis", R"(<worldbody><body name="chassis" pos="0 0 .1">
      <geom type="box" size=".3 .3 .1"/>
      <body name="link" pos="0 0 .3"><joint name="j" axis="0 1 0" range="-1 1" limited="true"/>
        <geom type="box" size=".02 .02 .1" mass="1"/><site name="tip" pos="0 0 .1"/></body>
    </body></worldbody><actuator><position name="a" joint="j" kp="100" kv="10"/></actuator>)");
  EnvConfig config;
  RobotConfig& robot = config.robots["cart"] = RobotConfig{.name = "cart", .model = chassis};
  robot.move_groups["arm"] = {.kind = MoveGroupKind::kArm,
                              .joints = {"j"},
                              .leaf = ElementRef{.kind = ElementKind::kSite, .name = "tip"}};
  {
    Warnings warnings;
    const Env env(config);
    EXPECT_THAT(warnings.texts,
                ElementsAre(HasSubstr("robot 'cart' (robotcart_chassis) stands 100 mm deep in "
                                      "floor. Move the robot (robot_to_shared_base_frame), or "
                                      "write `reset_root_pose: false`")));
  }
  config.robots["cart"].reset_root_pose = false;
  Warnings warnings;
  const Env env(config);
  EXPECT_THAT(warnings.texts, IsEmpty());
  EXPECT_NEAR(env.scene().body_pose("robotcart_chassis").translation().z(), 0.1, 1e-12);
}

}  // namespace
}  // namespace robocell
