#include "robocell/scenes/free_floor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

SceneObject FixedBox(const std::string& name, const Vec3& pos, const Vec3& half, double yaw = 0) {
  SceneObject box = BoxObject(name, pos);
  box.size = half;
  box.fixed = true;
  box.quat = Pose::FromRpy({0, 0, 0}, {0, 0, yaw}).quaternion();
  return box;
}

std::vector<FloorArea> FreeFloorOf(const Scene& scene) {
  return FindFreeFloor(scene, std::vector<bool>(static_cast<size_t>(scene.model()->nbody), false));
}

// Returns true if a ray from above ends on something higher than the floor.
bool IsCovered(const Scene& scene, const Eigen::Vector3d& at) {
  std::vector<int> geoms;
  for (int g = 0; g < scene.model()->ngeom; ++g) {
    if (scene.model()->geom_type[g] != mjGEOM_PLANE) geoms.push_back(g);
  }
  const Eigen::Vector3d from(at.x(), at.y(), kHeadroom);
  return CastRay(scene.model(), scene.data(), geoms, from, -Eigen::Vector3d::UnitZ()).distance <
         kHeadroom - 0.02;
}

TEST(FreeFloor, ContainsNoObjects) {
  for (int k = 0; k < 20; ++k) {
    Rng rng = Rng::Stream(7, "free floor", k);
    SceneSpec spec{.name = "room", .timestep = 0.002, .add_floor = true, .add_skybox = true};
    for (int i = 0; i < 6; ++i) {
      spec.objects.push_back(
          FixedBox("box" + std::to_string(i), {rng.Uniform(-2, 2), rng.Uniform(-2, 2), 0.3},
                   {rng.Uniform(0.02, 0.6), rng.Uniform(0.02, 0.6), 0.3}, rng.Uniform(-3, 3)));
    }
    const Scene scene = Scene::Build(spec);
    const std::vector<FloorArea> areas = FreeFloorOf(scene);
    ASSERT_FALSE(areas.empty());
    for (const FloorArea& area : areas) {
      EXPECT_GE(2 * std::min(area.half_x, area.half_y), kLeastSide - 1e-9);
      for (int s = 0; s < 200; ++s) {
        const Eigen::Vector3d at =
            area.frame_to_world * Eigen::Vector3d(rng.Uniform(-area.half_x, area.half_x),
                                                  rng.Uniform(-area.half_y, area.half_y), 0);
        EXPECT_FALSE(IsCovered(scene, at)) << k << ": " << at.transpose();
        EXPECT_NEAR(at.z(), 0, 1e-9);
      }
    }
  }
}

TEST(FreeFloor, ExtendsToTheWallsOfARoom) {
  SceneSpec spec{.name = "room", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.objects.push_back(FixedBox("north", {0, 2, 1}, {2, 0.05, 1}));
  spec.objects.push_back(FixedBox("south", {0, -2, 1}, {2, 0.05, 1}));
  spec.objects.push_back(FixedBox("east", {2, 0, 1}, {0.05, 2, 1}));
  spec.objects.push_back(FixedBox("west", {-2, 0, 1}, {0.05, 2, 1}));
  const std::vector<FloorArea> areas = FreeFloorOf(Scene::Build(spec));
  ASSERT_FALSE(areas.empty());
  const FloorArea& inner = areas.front();
  EXPECT_NEAR(inner.frame_to_world.translation().norm(), 0, 0.06);
  EXPECT_NEAR(inner.half_x, 1.95, 0.08);
  EXPECT_NEAR(inner.half_y, 1.95, 0.08);
}

TEST(FreeFloor, ExcludesTheAreaUnderATable) {
  SceneSpec spec{.name = "table", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.objects.push_back(FixedBox("top", {0, 0, 0.7}, {0.5, 0.5, 0.02}));
  for (const FloorArea& area : FreeFloorOf(Scene::Build(spec))) {
    const Eigen::Vector3d middle = area.frame_to_world.inverse() * Eigen::Vector3d::Zero();
    EXPECT_FALSE(std::abs(middle.x()) < area.half_x && std::abs(middle.y()) < area.half_y);
  }
}

TEST(FreeFloor, EndsAtTheEdgesOfABoxFloor) {
  SceneSpec spec{.name = "slab", .timestep = 0.002, .add_floor = false, .add_skybox = true};
  spec.objects.push_back(FixedBox("slab", {1, 0, -0.05}, {1.5, 1, 0.05}, 0.4));
  const std::vector<FloorArea> areas = FreeFloorOf(Scene::Build(spec));
  ASSERT_EQ(areas.size(), 1u);
  EXPECT_NEAR(areas[0].frame_to_world.translation().x(), 1, 0.03);
  EXPECT_NEAR(areas[0].half_x, 1.5, 0.05);
  EXPECT_NEAR(areas[0].half_y, 1, 0.05);
}

TEST(FreeFloor, ListsFloorsOfOneHeightOnce) {
  SceneSpec spec{.name = "house", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.objects.push_back(FixedBox("kitchen", {-1, 0, -0.04}, {1, 1, 0.05}));
  spec.objects.push_back(FixedBox("hall", {1, 0, -0.04}, {1, 1, 0.05}));
  const std::vector<FloorArea> areas = FreeFloorOf(Scene::Build(spec));
  double total = 0;
  for (const FloorArea& area : areas) total += 4 * area.half_x * area.half_y;
  EXPECT_LE(total, (4 + 2 * kMargin) * (2 + 2 * kMargin) + 1e-6);
}

// A gallery over a room, with a table on each of the two levels.
TEST(FreeFloor, IncludesAllLevelsWithoutTables) {
  SceneSpec spec{.name = "house", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.objects.push_back(FixedBox("gallery", {0, 0, 2.95}, {2, 1.5, 0.05}));
  spec.objects.push_back(FixedBox("low_table", {-1, 0, 0.35}, {0.5, 0.8, 0.35}));
  spec.objects.push_back(FixedBox("high_table", {1, 0, 3.35}, {0.5, 0.8, 0.35}));
  spec.objects.push_back(FixedBox("step", {4, 0, 0.05}, {0.6, 0.6, 0.05}));
  spec.objects.push_back(FixedBox("stage", {-5, 0, 0.25}, {1, 1.2, 0.25}));
  const Scene scene = Scene::Build(spec);
  SceneAnnotations known;
  known.free_floor = FreeFloorOf(scene);
  const auto heights = [&](const std::string& floor) {
    std::set<int> centimetres;
    for (const FloorArea& area : robocell::FreeFloorOf(known, floor))
      centimetres.insert(
          static_cast<int>(std::lround(100 * area.frame_to_world.translation().z())));
    return centimetres;
  };
  EXPECT_EQ(heights("gallery_geom"), std::set<int>{300});
  EXPECT_EQ(heights("step_geom"), std::set<int>{10});
  EXPECT_EQ(heights("stage_geom"), std::set<int>{50});
  for (const FloorArea& area : known.free_floor) {
    EXPECT_THAT(area.floor, Not(HasSubstr("table")));
    const Eigen::Vector3d high = area.frame_to_world.inverse() * Eigen::Vector3d(1, 0, 3);
    EXPECT_FALSE(std::abs(high.z()) < 0.1 && std::abs(high.x()) < area.half_x &&
                 std::abs(high.y()) < area.half_y)
        << "under the high table";
  }
  // The room goes on under the gallery, where there is headroom.
  const auto is_free = [&](const Eigen::Vector3d& at) {
    return std::ranges::any_of(known.free_floor, [&](const FloorArea& area) {
      const Eigen::Vector3d in_area = area.frame_to_world.inverse() * at;
      return in_area.cwiseAbs().x() <= area.half_x && std::abs(in_area.y()) <= area.half_y &&
             std::abs(in_area.z()) < 1e-6;
    });
  };
  EXPECT_TRUE(is_free({1, 0, 0}));
  EXPECT_TRUE(is_free({-1, 0, 3}));
  EXPECT_FALSE(is_free({-1, 0, 0})) << "under the low table";
}

TEST(FreeFloor, SelectsAFloorByNameOrRoom) {
  const SceneAnnotations known{.free_floor = {{.half_x = 1, .half_y = 1, .floor = "ground"},
                                              {.half_x = 2, .half_y = 1, .room = "attic"},
                                              {.half_x = 1, .half_y = 3, .room = "attic"}}};
  EXPECT_EQ(robocell::FreeFloorOf(known, "ground").size(), 1u);
  const std::vector<FloorArea> attic = robocell::FreeFloorOf(known, "attic");
  ASSERT_EQ(attic.size(), 2u);
  EXPECT_EQ(attic[0].half_y, 3) << "the larger one first";
  EXPECT_THAT(
      ExpectThrow<NotFoundError>([&] { (void)robocell::FreeFloorOf(known, "atic"); }, "'atic'"),
      HasSubstr("Did you mean 'attic'?"));
}

TEST(FreeFloor, IsEmptyWithoutAFloor) {
  SceneSpec spec{.name = "air", .timestep = 0.002, .add_floor = false, .add_skybox = true};
  spec.objects.push_back(FixedBox("shelf", {1, 0, 1}, {0.3, 0.2, 0.05}));
  EXPECT_THAT(FreeFloorOf(Scene::Build(spec)), IsEmpty());
}

TEST(FreeFloor, AnEndlessFloorReachesToTheGivenPoints) {
  SceneSpec spec{.name = "plain", .timestep = 0.002, .add_floor = true, .add_skybox = false};
  spec.objects.push_back(BoxObject("aside", {30, 0, 0.5}));
  const Scene scene = Scene::Build(spec);
  const std::vector<std::string> moved = {scene.compiled()->object("aside").root_body};
  const std::vector<bool> ignored = MovedBodies(scene, moved);
  const std::vector<Eigen::Vector3d> points = {{4, 3, 0}, {5, 5, 0}};
  const auto reaches = [&](const std::vector<FloorArea>& areas, const Eigen::Vector3d& point) {
    return std::ranges::any_of(areas, [&](const FloorArea& area) {
      const Eigen::Vector3d at = area.frame_to_world.inverse() * point;
      return std::abs(at.x()) <= area.half_x && std::abs(at.y()) <= area.half_y;
    });
  };
  EXPECT_FALSE(reaches(FindFreeFloor(scene, ignored), points[1]));
  for (const Eigen::Vector3d& point : points)
    EXPECT_TRUE(reaches(FindFreeFloor(scene, ignored, points), point));
}

}  // namespace
}  // namespace robocell::internal
