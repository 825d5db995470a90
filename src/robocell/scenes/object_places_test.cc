#include "robocell/scenes/object_places.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <vector>
#include <Eigen/Core>

#include "robocell/mujoco/compile.h"

namespace robocell::internal {
namespace {

const Support kTable{Pose::FromRpy({1, 2, 0.4}, {0, 0, 0.7}), 0.3, 0.2, 0.02};

std::vector<SceneObject> Spheres(int count) {
  std::vector<SceneObject> objects;
  for (int i = 0; i < count; ++i) {
    objects.push_back({.name = "s" + std::to_string(i),
                       .shape = Shape::kSphere,
                       .size = Vec3{0.02 + 0.01 * i, 0, 0}});
  }
  return objects;
}

std::vector<ObjectSize> SizesOf(const std::vector<SceneObject>& objects) {
  ObjectSizes sizes;
  std::vector<ObjectSize> out;
  for (const SceneObject& object : objects) out.push_back(sizes.Of(object));
  return out;
}

TEST(ObjectPlaces, AreOnTheSupportAndSeparated) {
  std::vector<SceneObject> objects = Spheres(3);
  const std::vector<ObjectSize> sizes = SizesOf(objects);
  for (int k = 0; k < 200; ++k) {
    Rng rng = Rng::Stream(1, "places", k);
    for (SceneObject& object : objects) ForgetPose(object);
    ASSERT_TRUE(PlaceOn(kTable, sizes, objects, rng));
    for (size_t i = 0; i < objects.size(); ++i) {
      const Eigen::Vector3d at =
          (kTable.frame_to_world.inverse() * objects[i].pose()).translation();
      EXPECT_LE(std::abs(at.x()), 0.3 - kEdgeMargin - sizes[i].radius);
      EXPECT_LE(std::abs(at.y()), 0.2 - kEdgeMargin - sizes[i].radius);
      EXPECT_NEAR(at.z(), sizes[i].height + 0.001, 1e-9);
      for (size_t j = 0; j < i; ++j) {
        const double apart =
            (objects[i].pose().translation() - objects[j].pose().translation()).head<2>().norm();
        EXPECT_GE(apart, sizes[i].radius + sizes[j].radius + kObjectGap);
      }
    }
  }
}

TEST(ObjectPlaces, KeepClearOfWhatStandsOrHangsLow) {
  std::vector<SceneObject> objects = Spheres(2);
  const std::vector<ObjectSize> sizes = SizesOf(objects);
  int placed = 0;
  for (int k = 0; k < 100; ++k) {
    Rng rng = Rng::Stream(1, "occupied", k);
    std::vector<StillBox> boxes;
    for (int i = 0; i < 3; ++i) {
      boxes.push_back(
          {kTable.frame_to_world * Pose::FromRpy({rng.Uniform(-0.3, 0.3), rng.Uniform(-0.2, 0.2),
                                                  rng.Uniform(-0.2, 0.5)},
                                                 {rng.Uniform(-3, 3), rng.Uniform(-3, 3), 0}),
           Eigen::Vector3d(0.05, 0.1, 0.02)});
    }
    for (SceneObject& object : objects) ForgetPose(object);
    if (!PlaceOn(kTable, sizes, objects, rng, FindOver(kTable, boxes))) continue;
    ++placed;
    for (size_t i = 0; i < objects.size(); ++i) {
      // Points of the boxes over or beside the object, in the support's frame.
      const Pose world_to_support = kTable.frame_to_world.inverse();
      const Eigen::Vector3d at = world_to_support * objects[i].pose().translation();
      for (const StillBox& box : boxes) {
        for (int p = 0; p < 30; ++p) {
          const Eigen::Vector3d inside(rng.Uniform(-1, 1), rng.Uniform(-1, 1), rng.Uniform(-1, 1));
          const Eigen::Vector3d point =
              world_to_support * (box.frame_to_world * box.half.cwiseProduct(inside));
          if (point.z() < 0.006 || point.z() > 2 * sizes[i].radius + kGapAbove) continue;
          EXPECT_GT((point - at).head<2>().norm(), sizes[i].radius) << k;
        }
      }
    }
  }
  EXPECT_GT(placed, 50);
}

// A box with this height that hangs over the whole table.
StillBox CeilingAt(double height) {
  return {kTable.frame_to_world * Pose::FromRpy({0, 0, height + 0.01}, {0, 0, 0}),
          Eigen::Vector3d(0.4, 0.3, 0.01)};
}

TEST(ObjectPlaces, AnObjectNeedsRoomForItselfAbove) {
  for (const double height : {0.04, 0.1, 0.3, 0.5}) {
    const std::vector<SceneObject> column = {
        {.name = "a", .shape = Shape::kBox, .size = Vec3{0.02, 0.02, height / 2}}};
    const std::vector<ObjectSize> sizes = SizesOf(column);
    for (const double room : {0.05, 0.15, 0.25, 0.35, 0.55}) {
      std::vector<SceneObject> objects = column;
      Rng rng = Rng::Stream(1, "room", 0);
      const std::vector<StillBox> ceiling = {CeilingAt(room)};
      const bool fits = height + kGapAbove < room;
      EXPECT_EQ(PlaceOn(kTable, sizes, objects, rng, FindOver(kTable, ceiling)), fits)
          << height << " below " << room;
    }
  }
}

TEST(ObjectPlaces, PlacesWithRoomForAHandComeFirst) {
  const std::vector<StillBox> shelf = {
      {kTable.frame_to_world * Pose::FromRpy({-0.15, 0, 0.15}, {0, 0, 0}),
       Eigen::Vector3d(0.15, 0.2, 0.01)}};  // over one half of the table
  for (int k = 0; k < 20; ++k) {
    std::vector<SceneObject> objects = Spheres(1);
    Rng rng = Rng::Stream(1, "hand", k);
    ASSERT_TRUE(PlaceOn(kTable, SizesOf(objects), objects, rng, FindOver(kTable, shelf)));
    EXPECT_GT((kTable.frame_to_world.inverse() * objects[0].pose()).translation().x(), 0);
  }
}

// The axes of this mesh's inertia are tilted.
TEST(ObjectPlaces, AMeshTakesUpTheBoxAlongTheAxesOfItsBody) {
  const SpecPtr spec = ParseXmlString(R"(
    <mujoco>
      <asset><mesh name="desk" vertex="-.5 -.3 .7  .5 -.3 .7  -.5 .3 .7  .5 .3 .7  .4 .3 0"/></asset>
      <worldbody><body pos="1 2 0" euler="0 0 30">
        <geom type="mesh" mesh="desk"/><geom type="box" size=".1 .2 .3" euler="10 20 30"/>
      </body></worldbody>
    </mujoco>)");
  const ModelPtr model = Compile(spec.get());
  const DataPtr data = MakeData(model.get());
  mj_forward(model.get(), data.get());
  const StillBox desk = StillBoxOf(model.get(), data.get(), 0);
  EXPECT_TRUE(desk.frame_to_world.is_close(
      Pose::FromRpy({1, 2, 0}, {0, 0, M_PI / 6}) * Pose(Eigen::Vector3d(0, 0, 0.35)), 1e-6, 1e-6));
  EXPECT_TRUE(desk.half.isApprox(Eigen::Vector3d(0.5, 0.3, 0.35), 1e-6));
  const Support top{Pose::FromRpy({1, 2, 0.7}, {0, 0, 0.5}), 0.3, 0.2, 0.02};
  EXPECT_TRUE(FindOver(top, std::vector{desk}).empty()) << "it ends at its top";
  const StillBox box = StillBoxOf(model.get(), data.get(), 1);
  EXPECT_TRUE(box.half.isApprox(Eigen::Vector3d(0.1, 0.2, 0.3), 1e-9));
}

TEST(ObjectPlaces, KeepAGivenPoseAtTheOrigin) {
  std::vector<SceneObject> objects = Spheres(3);
  objects[1].pos = Vec3{0, 0, 0};
  const std::vector<ObjectSize> sizes = SizesOf(objects);
  const Support around_origin{Pose(), 0.3, 0.2, 0.02};
  for (int k = 0; k < 50; ++k) {
    std::vector<SceneObject> placed = objects;
    Rng rng = Rng::Stream(1, "given", k);
    ASSERT_TRUE(PlaceOn(around_origin, sizes, placed, rng));
    EXPECT_EQ(placed[1], objects[1]);
    for (const size_t i : {0, 2}) {
      EXPECT_TRUE(placed[i].has_pose());
      EXPECT_GE(placed[i].pose().translation().head<2>().norm(),
                sizes[i].radius + sizes[1].radius + kObjectGap);
    }
  }
}

TEST(ObjectPlaces, FailWithoutEnoughSpace) {
  Rng rng = Rng::Stream(1, "places");
  std::vector<SceneObject> one = Spheres(1), many = Spheres(12);
  EXPECT_FALSE(PlaceOn({Pose(), 0.04, 0.2, 0.02}, SizesOf(one), one, rng));
  EXPECT_FALSE(PlaceOn(kTable, SizesOf(many), many, rng));
}

TEST(ObjectPlaces, AreTheSameForTheSameNumbers) {
  std::vector<SceneObject> a = Spheres(2), b = Spheres(2);
  Rng ra = Rng::Stream(5, "x"), rb = Rng::Stream(5, "x");
  ASSERT_TRUE(PlaceOn(kTable, SizesOf(a), a, ra));
  ASSERT_TRUE(PlaceOn(kTable, SizesOf(b), b, rb));
  EXPECT_EQ(a, b);
}

}  // namespace
}  // namespace robocell::internal
