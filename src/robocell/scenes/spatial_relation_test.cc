#include "robocell/scenes/spatial_relation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;

// A cube of 4 cm, a tray and a board on the floor; each test places the cube.
class SpatialRelationTest : public ::testing::Test {
 protected:
  static Scene Make() {
    SceneSpec spec{.name = "relations", .timestep = 0.002, .add_floor = true, .add_skybox = true};
    spec.objects.push_back(BoxObject("cube", {0, 0, 1}));
    spec.objects.back().size = Vec3{0.02, 0.02, 0.02};
    spec.objects.push_back({.name = "dish", .mjcf_path = "tray", .fixed = true});
    spec.objects.push_back(BoxObject("board", {1, 0, 0.1}));
    spec.objects.back().size = Vec3{0.1, 0.1, 0.1};
    spec.objects.back().fixed = true;
    return Scene::Build(spec);
  }
  bool Holds(Relation relation, const std::string& reference, const Eigen::Vector3d& at) {
    scene.Reset({.body_poses = {{"cube", Pose(at)}}});
    return SpatialRelation(scene, "cube", relation, reference).Holds();
  }

  Scene scene = Make();
};

TEST_F(SpatialRelationTest, OnTopOfMeansContactFromAbove) {
  EXPECT_TRUE(Holds(Relation::kOnTopOf, "board", {1, 0, 0.2199}));
  EXPECT_TRUE(Holds(Relation::kOnTopOf, "board", {1.08, -0.08, 0.2199}));
  EXPECT_FALSE(Holds(Relation::kOnTopOf, "board", {1, 0, 0.25}));         // above it
  EXPECT_FALSE(Holds(Relation::kOnTopOf, "board", {0.8801, 0, 0.0199}));  // at its side
  EXPECT_FALSE(Holds(Relation::kOnTopOf, "dish", {1, 0, 0.2199}));
}

// The engine has no contacts between bodies that sleep.
TEST_F(SpatialRelationTest, OnTopOfHoldsWhileBothSleep) {
  SceneSpec spec = scene.spec();
  spec.options.enable = {"sleep"};
  for (const bool is_fixed : {true, false}) {
    spec.objects[2].fixed = is_fixed;
    scene = Scene::Build(spec);
    const SpatialRelation on(scene, "cube", Relation::kOnTopOf, "board");
    const auto is_on = [&](const Eigen::Vector3d& at) {
      scene.SetBodyPose("cube", Pose(at));
      EXPECT_TRUE(scene.StepN(1000).ok());
      EXPECT_GE(scene.data()->tree_asleep[scene.model()->body_treeid[RequireId(
                    scene.model(), mjOBJ_BODY, "cube", "")]],
                0);
      return on.Holds();
    };
    EXPECT_TRUE(is_on({1, 0, 0.22}));
    EXPECT_FALSE(is_on({0.5, 0, 0.02}));
    EXPECT_TRUE(is_on({1.05, 0.05, 0.22}));
  }
}

TEST_F(SpatialRelationTest, InsideMeansInAHollow) {
  EXPECT_TRUE(Holds(Relation::kInside, "dish", {0, 0, 0.02}));
  EXPECT_TRUE(Holds(Relation::kInside, "dish", {0.03, -0.02, 0.018}));
  EXPECT_FALSE(Holds(Relation::kInside, "dish", {0, 0, 0.06}));  // above the rim
  EXPECT_FALSE(Holds(Relation::kInside, "dish", {0, 0, 0.2}));
  EXPECT_FALSE(Holds(Relation::kInside, "dish", {0.5, 0, 0.02}));
}

TEST_F(SpatialRelationTest, NextToMeansAdjacentAndNear) {
  EXPECT_TRUE(Holds(Relation::kNextTo, "board", {0.83, 0, 0.02}));
  EXPECT_TRUE(Holds(Relation::kNextTo, "board", {0.8801, 0, 0.0199}));  // touching its side
  EXPECT_FALSE(Holds(Relation::kNextTo, "board", {0.75, 0, 0.02}));     // 13 cm away
  EXPECT_FALSE(Holds(Relation::kNextTo, "board", {1, 0, 0.2199}));      // on it
  EXPECT_FALSE(Holds(Relation::kNextTo, "board", {0.83, 0, 0.5}));      // far above
  scene.Reset({.body_poses = {{"cube", Pose(Eigen::Vector3d(0.75, 0, 0.02))}}});
  EXPECT_TRUE(SpatialRelation(scene, "cube", Relation::kNextTo, "board", 0.15).Holds());
}

TEST_F(SpatialRelationTest, FollowsTheSceneWhenItChanges) {
  const SpatialRelation on(scene, "cube", Relation::kOnTopOf, "board");
  scene.Reset({.body_poses = {{"cube", Pose(Eigen::Vector3d(1, 0, 0.2199))}}});
  EXPECT_TRUE(on.Holds());
  scene.AddObject(BoxObject("other", {2, 0, 0.05}));
  scene.Reset({.body_poses = {{"cube", Pose(Eigen::Vector3d(1, 0, 0.2199))}}});
  EXPECT_TRUE(on.Holds());
}

TEST_F(SpatialRelationTest, RejectsImpossibleRelations) {
  const auto error = [&]<class E>(E, const std::string& object, Relation relation,
                                  const std::string& reference) {
    return ExpectThrow<E>([&] { SpatialRelation(scene, object, relation, reference); }, "");
  };
  EXPECT_THAT(error(ArgumentError(""), "cube", Relation::kInside, "board"),
              HasSubstr("'board' has no hollow"));
  EXPECT_THAT(error(NotFoundError(""), "cub", Relation::kOnTopOf, "board"),
              HasSubstr("Did you mean 'cube'?"));
  EXPECT_THAT(error(NotFoundError(""), "cube", Relation::kOnTopOf, "bord"),
              HasSubstr("Did you mean 'board'?"));
}

}  // namespace
}  // namespace robocell
