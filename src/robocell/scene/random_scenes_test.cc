// Laws that every scene obeys, on random ones: robots of all models at hand with tools on tools,
// objects, rigs, cameras.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

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
#include "robocell/testing/menagerie.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

// The first seeds without the Menagerie, whose meshes take their time.
constexpr uint64_t kPlain = 8, kAll = 20;

class RandomCells : public ::testing::TestWithParam<uint64_t> {
 protected:
  RandomCells()
      : rng_(Rng::Stream(GetParam(), "cell")),
        scenes_(GetParam() >= kPlain),
        spec_(scenes_.NextCell(rng_)) {}

  void SetUp() override {
    if (GetParam() >= kPlain) REQUIRE_MENAGERIE();
  }

  Rng rng_;
  RandomScenes scenes_;
  SceneSpec spec_;
};

using Poses = std::map<std::string, Pose>;

Poses PosesAfter(const SceneSpec& spec, int steps) {
  Scene scene = Scene::Build(spec);
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

TEST_P(RandomCells, TheOrderOfIndependentEntitiesChangesNothing) {
  // To the end: else the order decides where the solver stops.
  spec_.options.tolerance = 0;
  spec_.options.iterations = 500;
  const Poses before = PosesAfter(spec_, 50);
  Shuffle(rng_, spec_.robots);
  Shuffle(rng_, spec_.objects);
  Shuffle(rng_, spec_.cameras);
  const Poses after = PosesAfter(spec_, 50);
  ASSERT_EQ(after.size(), before.size());
  for (const auto& [body, pose] : before)
    EXPECT_TRUE(pose.is_close(after.at(body), 1e-9, 1e-9)) << body << pose << after.at(body);
}

TEST_P(RandomCells, SavedAndLoadedTheyAreTheSame) {
  const TempDir folder;
  const Scene scene = Scene::Build(spec_);
  scene.SaveBinary((folder / "scene.mjb").string());
  EXPECT_EQ(ModelDifferences(scene.model(), LoadBinary(folder / "scene.mjb").get(), 0), "");
  EXPECT_EQ(DifferencesAfterXml(scene, folder / "scene.xml"), "");
}

TEST_P(RandomCells, AddingThenRemovingGivesBackTheState) {
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

// By its name everything is found, and nothing else: bodies of robots, of tools on tools and of
// objects, cameras, the rig.
TEST_P(RandomCells, EveryNameResolves) {
  const Scene scene = Scene::Build(spec_);
  for (const mjtObj kind : {mjOBJ_BODY, mjOBJ_JOINT, mjOBJ_SITE, mjOBJ_ACTUATOR, mjOBJ_CAMERA}) {
    const std::vector<std::string> names = ElementNames(scene.model(), kind);
    for (size_t id = 0; id < names.size(); ++id) {
      if (names[id].empty()) continue;  // an object's model need not name all it has
      EXPECT_EQ(FindId(scene.model(), kind, names[id]), static_cast<int>(id)) << names[id];
    }
  }
  for (const RobotSpec& robot : spec_.robots) {
    for (const AttachmentSpec& tool : robot.attachments) {
      const std::string palm = robot.prefix + tool.prefix + "palm";
      const std::string on = robot.prefix + tool.attach_to.name;
      const Pose there = scene.body_pose(on) * tool.pose();
      EXPECT_NEAR((scene.body_pose(palm).translation() - there * Eigen::Vector3d(0, 0, .01)).norm(),
                  0, 1e-9)
          << palm << " on " << on;
    }
  }
  EXPECT_EQ(scene.object_names().size(), spec_.objects.size());
  for (const SceneObject& object : spec_.objects) {
    const std::string& root = scene.compiled()->object(object.name).root_body;
    EXPECT_NEAR((scene.body_pose(root).translation() - ToEigen(object.pos)).norm(), 0, 0.1)
        << object.name << ": as far as its model's root is from its origin";
  }
  for (const CameraSpec& camera : spec_.cameras) {
    const Pose in = camera.attach_to.kind == AttachKind::kRoot ? spec_.root_frame_to_world : Pose();
    EXPECT_TRUE(
        scene.camera_pose(camera.name).is_close(in * Pose(ToEigen(*camera.pos)), 1e-9, 1e-9));
  }
  EXPECT_TRUE(scene.root_frame_to_world().is_close(spec_.root_frame_to_world, 1e-9, 1e-9));
  EXPECT_TRUE(scene.shared_base_frame_to_world().is_close(
      spec_.root_frame_to_world * spec_.shared_base_frame_to_root_frame, 1e-9, 1e-9));
}

// The generator makes what it is said to make.
TEST(RandomCellsOnTheWhole, HaveEveryKindOfRobotAndManyTools) {
  REQUIRE_MENAGERIE();
  RandomScenes scenes(true);
  std::set<std::string> robots;
  size_t tools = 0, objects = 0;
  for (uint64_t seed = kPlain; seed < kAll; ++seed) {
    Rng rng = Rng::Stream(seed, "cell");
    const SceneSpec spec = scenes.NextCell(rng);
    for (const RobotSpec& robot : spec.robots) {
      robots.insert(robot.path.empty() ? robot.config->model : robot.path);
      tools += robot.attachments.size();
    }
    objects += spec.objects.size();
  }
  EXPECT_GE(robots.size(), 6) << ::testing::PrintToString(robots);
  EXPECT_GE(tools, 12);
  EXPECT_GE(objects, 20);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomCells, ::testing::Range(uint64_t{0}, kAll));

}  // namespace
}  // namespace robocell
