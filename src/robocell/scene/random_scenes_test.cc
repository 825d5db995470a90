// Tests laws of every scene on random ones: robots of all available models with tools on tools,
// objects, rigs, cameras.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/model_compare.h"
#include "robocell/scene/testing/random_scenes.h"
#include "robocell/scene/testing/saved.h"
#include "robocell/testing/long_form.h"
#include "robocell/testing/menagerie.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

// The first seeds do not use the Menagerie, whose meshes take time. The short form tries kFew seeds.
constexpr uint64_t kPlain = 8, kFew = 16, kAll = 40;

class RandomCells : public ::testing::TestWithParam<uint64_t> {
 protected:
  RandomCells()
      : rng_(Rng::Stream(GetParam(), "cell")),
        scenes_(GetParam() >= kPlain, GetParam()),
        spec_(scenes_.NextCell(rng_)) {}

  void SetUp() override {
    if (GetParam() >= kPlain) REQUIRE_MENAGERIE();
  }

  Rng rng_;
  RandomScenes scenes_;
  SceneSpec spec_;
};

using Poses = std::map<std::string, Pose>;

// Returns metres and radians, over all bodies.
double LargestDifference(const Poses& a, const Poses& b) {
  double largest = 0;
  for (const auto& [body, pose] : a)
    largest = std::max(largest, PoseDifference(pose, b.at(body)).norm());
  return largest;
}

// Starts with velocities that differ by up to `off`, to either side.
Poses PosesAfter(const SceneSpec& spec, int steps, double off = 0) {
  Scene scene = Scene::Build(spec);
  for (int i = 0; i < scene.model()->nv; ++i) scene.data()->qvel[i] += i % 2 == 0 ? off : -off;
  EXPECT_TRUE(scene.StepN(steps).ok());
  Poses poses;
  for (const std::string& body : scene.body_names()) {
    if (!body.empty()) poses[body] = scene.body_pose(body);
  }
  return poses;
}

template <class T>
void Shuffle(Rng& rng, List<T>& list) {
  rng.Shuffle(list.boxes());
}

// Returns the growth of rounding in these steps: in about one cell of a hundred to 1e-6 and more,
// by stiff contacts.
double GrownRounding(const SceneSpec& spec, const Poses& poses, int steps) {
  double largest = 0;
  for (const double off : {1e-15, -1e-15, 3e-15})
    largest = std::max(largest, LargestDifference(poses, PosesAfter(spec, steps, off)));
  return largest;
}

void ExpectNoEffectOfTheOrder(SceneSpec spec, Rng& rng) {
  // Runs the solver to the end: otherwise the order decides where it stops.
  spec.options.tolerance = 0;
  spec.options.iterations = 500;
  const SceneSpec in_order = spec;
  const Poses before = PosesAfter(in_order, 50);
  Shuffle(rng, spec.robots);
  Shuffle(rng, spec.objects);
  // Supports are declared before the objects on them.
  auto& objects = spec.objects.boxes();
  std::stable_partition(objects.begin(), objects.end(),
                        [](const auto& box) { return box->name == "stand"; });
  Shuffle(rng, spec.cameras);
  const Poses after = PosesAfter(spec, 50);
  ASSERT_EQ(after.size(), before.size());
  const double difference = LargestDifference(before, after);
  if (difference < 1e-9) return;
  EXPECT_LT(difference, 10 * GrownRounding(in_order, before, 50)) << "more than rounding";
}

TEST_P(RandomCells, TheOrderOfIndependentEntitiesChangesNothing) {
  ExpectNoEffectOfTheOrder(spec_, rng_);
}

TEST_P(RandomCells, SaveAndLoadRoundTrips) {
  const TempDir folder;
  const Scene scene = Scene::Build(spec_);
  scene.SaveBinary((folder / "scene.mjb").string());
  EXPECT_EQ(ModelDifferences(scene.model(), LoadBinary(folder / "scene.mjb").get(), 0), "");
  EXPECT_EQ(DifferencesAfterXml(scene, folder / "scene.xml"), "");
}

TEST_P(RandomCells, AddingThenRemovingRestoresTheState) {
  Scene scene = Scene::Build(spec_);
  EXPECT_TRUE(scene.StepN(10).ok());
  const std::vector<double> state = scene.state();
  const std::string model = SaveBinaryString(scene.model());
  scene.AddObject(scenes_.Object(rng_, "new"));
  EXPECT_NE(SaveBinaryString(scene.model()), model);
  scene.RemoveObject("new");
  EXPECT_TRUE(scene.state() == state);
  EXPECT_TRUE(SaveBinaryString(scene.model()) == model);
}

// Returns the body of a joint; "" if it has no name.
std::string BodyOf(const mjModel* model, int joint, const std::string& prefix = "") {
  const std::string name = ElementName(model, mjOBJ_BODY, model->jnt_bodyid[joint]);
  return name.empty() ? "" : prefix + name;
}

// Checks that every name of a part's own model exists under the part's name, refers to that element
// and no other, and resolves to itself.
void ExpectElementsOf(const Scene& scene, const std::string& file, const std::string& prefix) {
  const mjModel *alone = RandomScenes::Alone(file), *all = scene.model();
  for (const mjtObj kind : {mjOBJ_BODY, mjOBJ_JOINT, mjOBJ_SITE, mjOBJ_ACTUATOR, mjOBJ_CAMERA}) {
    const std::vector<std::string> names = ElementNames(alone, kind);
    for (int own = 0; own < static_cast<int>(names.size()); ++own) {
      if (names[own].empty() || names[own] == "world") continue;
      const std::string name = prefix + names[own];
      const int id = FindId(all, kind, name);
      ASSERT_GE(id, 0) << name;
      switch (kind) {
        case mjOBJ_BODY:
          EXPECT_DOUBLE_EQ(all->body_mass[id], alone->body_mass[own]) << name;
          (void)scene.body_pose(name);
          break;
        case mjOBJ_JOINT:
          EXPECT_EQ(all->jnt_type[id], alone->jnt_type[own]) << name;
          EXPECT_DOUBLE_EQ(all->jnt_range[2 * id + 1], alone->jnt_range[2 * own + 1]) << name;
          EXPECT_EQ(BodyOf(all, id), BodyOf(alone, own, prefix)) << name;
          break;
        case mjOBJ_SITE:
          for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(all->site_pos[3 * id + i], alone->site_pos[3 * own + i], 1e-12) << name;
          (void)scene.site_pose(name);
          break;
        case mjOBJ_ACTUATOR:
          EXPECT_EQ(all->actuator_trntype[id], alone->actuator_trntype[own]) << name;
          (void)scene.actuator_ctrl(name);
          break;
        default:
          EXPECT_DOUBLE_EQ(all->cam_fovy[id], alone->cam_fovy[own]) << name;
          (void)scene.camera_pose(name);
      }
    }
  }
}

#define EXPECT_POSE(actual, expected) \
  EXPECT_TRUE((actual).is_close((expected), 1e-8, 1e-8)) << (actual) << "\nexpected\n" << (expected)

// Every name leads to the element at its stated place: robots, tools on tools, objects, cameras,
// the rig.
TEST_P(RandomCells, EveryNameResolves) {
  const Scene scene = Scene::Build(spec_);
  for (const RobotSpec& robot : spec_.robots) {
    const std::string file = RandomScenes::FileOf(robot);
    ExpectElementsOf(scene, file, robot.prefix);
    const Pose place = scenes_.Parent(spec_, robot.attach_to) * robot.pose();
    EXPECT_POSE(
        scene.body_pose(robot.prefix + ElementNames(RandomScenes::Alone(file), mjOBJ_BODY)[1]),
        robot.reset_root_pose.value_or(false) ? place : place * RandomScenes::RootPose(file));
    for (const AttachmentSpec& tool : robot.attachments) {
      ExpectElementsOf(scene, tool.mjcf_path, robot.prefix + tool.prefix);
      const std::string root = ElementNames(RandomScenes::Alone(tool.mjcf_path), mjOBJ_BODY)[1];
      EXPECT_POSE(scene.body_pose(robot.prefix + tool.prefix + root),
                  scenes_.Parent(scene, robot, tool.attach_to) * tool.pose() *
                      RandomScenes::RootPose(tool.mjcf_path));
    }
  }
  EXPECT_EQ(scene.object_names().size(), spec_.objects.size());
  for (const SceneObject& object : spec_.objects) {
    Pose place = scenes_.Parent(spec_, object.attach_to) * object.pose();
    if (!object.mjcf_path.empty()) {
      const std::string file = assets::Resolve(object.mjcf_path);
      ExpectElementsOf(scene, file, object.name + "_");
      place = place * RandomScenes::RootPose(file);
    }
    EXPECT_POSE(scene.body_pose(scene.compiled()->object(object.name).root_body), place);
  }
  for (const CameraSpec& camera : spec_.cameras) {
    const Pose in = camera.attach_to.kind == AttachKind::kRoot ? spec_.root_frame_to_world : Pose();
    EXPECT_POSE(scene.camera_pose(camera.name), in * Pose(ToEigen(*camera.pos)));
  }
  EXPECT_POSE(scene.root_frame_to_world(), spec_.root_frame_to_world);
  EXPECT_POSE(scene.shared_base_frame_to_world(),
              spec_.root_frame_to_world * spec_.shared_base_frame_to_root_frame);
}

std::string Stem(const std::string& file) { return std::filesystem::path(file).stem().string(); }

// The generator covers everything that it claims.
TEST(RandomCellsOnTheWhole, HaveEveryKindOfRobotAndManyTools) {
  REQUIRE_MENAGERIE();
  std::set<std::string> robots;
  std::map<AttachKind, int> stands, lies, hangs;
  std::set<std::string> tools;
  int within_reach = 0;
  size_t most_robots = 0, most_objects = 0, most_tools = 0;
  for (uint64_t seed = 0; seed < kAll; ++seed) {
    RandomScenes scenes(seed >= kPlain, seed);
    Rng rng = Rng::Stream(seed, "cell");
    const SceneSpec spec = scenes.NextCell(rng);
    most_robots = std::max(most_robots, spec.robots.size());
    most_objects = std::max(most_objects, spec.objects.size());
    for (const RobotSpec& robot : spec.robots) {
      most_tools = std::max(most_tools, robot.attachments.size());
      robots.insert(Stem(RandomScenes::FileOf(robot)));
      ++stands[robot.attach_to.kind];
      for (const AttachmentSpec& tool : robot.attachments) {
        ++hangs[tool.attach_to.kind];
        tools.insert(Stem(tool.mjcf_path));
      }
      for (const SceneObject& object : spec.objects) {
        const auto at = [&](const auto& entity) {
          return (scenes.Parent(spec, entity.attach_to) * entity.pose()).translation();
        };
        if ((at(object) - at(robot)).norm() < 1) ++within_reach;
      }
    }
    for (const SceneObject& object : spec.objects) ++lies[object.attach_to.kind];
  }
  using enum AttachKind;
  EXPECT_EQ(most_robots, 3);
  EXPECT_EQ(most_objects, 10);
  EXPECT_EQ(most_tools, 5);
  // Written and built-in ones, and all that tests use from the Menagerie.
  EXPECT_THAT(robots, ElementsAre("2f85", "arm", "fr3", "gen3", "panda", "rc7", "xarm7"));
  EXPECT_THAT(tools, ElementsAre("2f85", "ft_sensor", "gripper", "probe"));
  EXPECT_GE(within_reach, 5);
  for (const AttachKind kind : {kBody, kSite, kFrame}) EXPECT_GE(hangs[kind], 3) << ToString(kind);
  for (const AttachKind kind : {kWorld, kRoot, kSharedBase, kSite}) {
    EXPECT_GE(stands[kind], 1) << ToString(kind);
    EXPECT_GE(lies[kind], 1) << ToString(kind);
  }
}

// A cell in which rounding grows.
TEST(ChaoticCell, TheOrderOfIndependentEntitiesChangesNothing) {
  REQUIRE_MENAGERIE();
  constexpr uint64_t kSeed = 113;
  Rng rng = Rng::Stream(kSeed, "cell");
  RandomScenes scenes(true, kSeed);
  ExpectNoEffectOfTheOrder(scenes.NextCell(rng), rng);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomCells,
                         ::testing::Range(uint64_t{0}, LongForm() ? kAll : kFew));

}  // namespace
}  // namespace robocell
