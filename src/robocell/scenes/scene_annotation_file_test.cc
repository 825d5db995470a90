#include "robocell/scenes/scene_annotation_file.h"

#include <gtest/gtest.h>

#include <string>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

// A bench on a floor, with a cup.
struct Lab {
  TempDir folder;
  RunConfig run = ExampleRun("demo.yaml");

  Lab() {
    AtomicWrite(folder / "lab.xml", R"(<mujoco><worldbody>
      <geom name="floor" type="plane" size="3 3 1"/>
      <body name="bench" pos="1 0 0"><geom type="box" size=".5 .4 .4" pos="0 0 .4"/></body>
      <body name="cup" pos="1 0 .85"><freejoint/><geom type="sphere" size=".05"/></body>
    </worldbody></mujoco>)");
    run.scenes = FilesScenes{.files = {"lab.xml"}, .root = folder.path().string()};
  }
  void Write(const std::string& text) const { AtomicWrite(folder / "lab.annotations.yaml", text); }
  SceneAnnotations Known() const { return MakeSceneSource(run)->Annotations(0); }
};

TEST(SceneAnnotationFile, ReplacesWhatItLists) {
  const Lab lab;
  const SceneAnnotations derived = lab.Known();
  lab.Write(R"(
free_floor: [{pos: [-1, 0.5, 0], size: [2, 1], yaw: 90, body: world, room: lab}]
rooms: [{name: lab, category: workshop, outline: [[-3, -3], [3, -3], [3, 3], [-3, 3]]}]
objects: [{object: cup, words: [the blue cup], room: lab}]
)");
  const SceneAnnotations known = lab.Known();
  ASSERT_EQ(known.free_floor.size(), 1U);
  EXPECT_EQ(known.free_floor[0].half_x, 1);
  EXPECT_EQ(known.free_floor[0].half_y, 0.5);
  const Eigen::Vector3d end = known.free_floor[0].frame_to_world * Eigen::Vector3d(1, 0, 0);
  EXPECT_LT((end - Eigen::Vector3d(-1, 1.5, 0)).norm(), 1e-12);
  ASSERT_EQ(known.rooms.size(), 1U);
  EXPECT_EQ(known.rooms[0].category, "workshop");
  ASSERT_EQ(known.objects.size(), 1U);
  EXPECT_EQ(known.objects[0].words, std::vector<std::string>{"the blue cup"});
  // The geometry gives what the file does not list.
  ASSERT_FALSE(derived.supports.empty());
  ASSERT_EQ(known.supports.size(), derived.supports.size());
  EXPECT_EQ(known.supports[0].body, derived.supports[0].body);
  // A changed file counts.
  lab.Write("supports: [{body: bench, pos: [1, 0, 0.8], size: [0.4, 0.2]}]\n");
  const SceneAnnotations again = lab.Known();
  ASSERT_EQ(again.supports.size(), 1U);
  EXPECT_EQ(again.supports[0].face.half_y, 0.1);
  EXPECT_EQ(again.free_floor.size(), derived.free_floor.size());
}

TEST(SceneAnnotationFile, ErrorsHaveTheirPlace) {
  const Lab lab;
  const auto expect = [&](const std::string& text, const std::string& message) {
    lab.Write(text);
    ExpectThrow<SpecError>([&] { lab.Known(); }, message);
  };
  expect("rooms:\n- {name: lab}\nobjects:\n- {object: cap, words: [a cup]}\n",
         "lab.annotations.yaml:4:12: objects[0].object: the scene: no body 'cap'");
  expect("rooms: [{name: lab}]\nobjects: [{object: cup, room: lap}]\n",
         "lab.annotations.yaml:2:31: object 'cup' (objects[0]).room: 'lap' is not among `rooms`");
  expect("supports: [{pos: [0, 0, .nan], size: [1, 1]}]\n", "lab.annotations.yaml:1:");
  expect("supports: [{pos: [0, 0, 1], size: [1, -1]}]\n", "lab.annotations.yaml:1:");
  expect("support: []\n", "supports");
  expect("rooms: [{name: a}, {name: a}]\n", "two rooms");
  expect("rooms: [{name: a, outline: [[0, 0], [1, 1]]}]\n", "2 corners");
}

TEST(SceneAnnotationFile, IsAFileOfTheScene) {
  const Lab lab;
  EXPECT_TRUE(MakeSceneSource(lab.run)->AnnotationFiles(0).empty());
  lab.Write("rooms: [{name: lab}]\n");
  EXPECT_EQ(MakeSceneSource(lab.run)->AnnotationFiles(0),
            std::vector<std::filesystem::path>{lab.folder / "lab.annotations.yaml"});
}

}  // namespace
}  // namespace robocell::internal
