// Tests the judge of pouring without a robot: grains are put into and beside a vessel by their poses.
#include "robocell/task/pouring.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/relations.h"
#include "robocell/task/held_relation.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

constexpr int kGrains = 20;
constexpr double kRadius = 0.005;  // m

Scene Vessels() {
  internal::RegisterTaskRelations();
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(
      {.name = "bottle", .mjcf_path = "open_bottle", .pos = Vec3{0.3, 0, 0.075}});
  spec.objects.push_back({.name = "bowl", .mjcf_path = "receiver", .pos = Vec3{0, 0, 0.04}});
  for (int i = 0; i < kGrains; ++i) {
    SceneObject grain = BoxObject(fmt::format("bottle_grain_{}", i), {1 + 0.1 * i, 0, kRadius});
    grain.shape = Shape::kSphere;
    grain.size = Vec3{kRadius, 0, 0};
    spec.objects.push_back(grain);
  }
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return scene;
}

TEST(Pouring, CountsGrainsInsideTheWallsAndUnderTheRim) {
  Scene scene = Vessels();
  const auto poured = BindRelation(scene, ParseRelation("bottle poured_into bowl"));
  Rng rng = Rng::Stream(0, "pouring");
  EXPECT_EQ(poured->Progress(), 0);
  for (int i = 0; i < kGrains; ++i) {
    const std::string grain = fmt::format("bottle_grain_{}", i);
    const double angle = rng.Uniform(-internal::kPi, internal::kPi);
    const auto put = [&](double distance, double height) {
      scene.SetBodyPose(grain, Pose(Eigen::Vector3d(distance * std::cos(angle),
                                                    distance * std::sin(angle), height)));
      scene.Forward();
      return poured->Progress() * kGrains;
    };
    EXPECT_NEAR(put(rng.Uniform(0.07, 0.1), rng.Uniform(0.01, 0.07)), i, 1e-6) << "beside it";
    EXPECT_NEAR(put(0.058, kRadius), i, 1e-6) << "under the rim, on the floor";
    EXPECT_NEAR(put(rng.Uniform(0, 0.04), rng.Uniform(0.09, 0.2)), i, 1e-6) << "over it";
    EXPECT_NEAR(put(rng.Uniform(0, 0.035), rng.Uniform(0.014, 0.07)), i + 1, 1e-6) << "in it";
    EXPECT_EQ(poured->Holds(), i + 1 >= 0.8 * kGrains);
  }
}

TEST(Pouring, GrainsHaveTheNameOfTheirVesselAndANumber) {
  SceneSpec spec = EmptyScene();
  double x = 0;
  for (const char* name : {"cup", "cup_grain", "cup_grain_0", "cup_grain_12", "cup_grain_mill",
                           "cup_grains", "cup_grain_", "cup_grain_1_lid", "cupola_grain_1"})
    spec.objects.push_back(BoxObject(name, {x += 0.1, 0, 0.02}));
  const Scene scene = Scene::Build(spec);
  EXPECT_THAT(internal::GrainsOf(scene, "cup"),
              ::testing::ElementsAre("cup_grain", "cup_grain_0", "cup_grain_12"));
}

TEST(Pouring, NeedsGrainsAndAHollow) {
  const Scene scene = Vessels();
  ExpectThrow<ArgumentError>([&] { BindRelation(scene, ParseRelation("bowl poured_into bottle")); },
                             "has nothing to pour");
  ExpectThrow<ArgumentError>(
      [&] { BindRelation(scene, ParseRelation("bottle poured_into bottle_grain_0")); },
      "no hollow that is open upwards");
}

}  // namespace
}  // namespace robocell
