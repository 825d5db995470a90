#include "robocell/scenes/related_places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/names.h"
#include "robocell/scenes/spatial_relation.h"
#include "robocell/scenes/testing/start_on_table.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

TEST(RelatedPlaces, ObjectsKeepTheirRelationsAfterSettling) {
  Start start({Block("cube", {0.015, 0.015, 0.015}),
               Block("brick", {0.05, 0.04, 0.02}),
               {.name = "dish", .mjcf_path = "tray", .fixed = false},
               Block("peg", {0.01, 0.01, 0.01}),
               Block("die", {0.01, 0.01, 0.01})});
  const RelatedPlaces related = start.Related({{"cube", {.on_top_of = "brick"}},
                                               {"peg", {.inside = "dish"}},
                                               {"die", {.next_to = "brick", .gap = {0.02, 0.06}}}});
  for (int k = 0; k < 12; ++k) {
    Rng rng = Rng::Stream(4, "related", k);
    ASSERT_EQ(start.Put(related, rng), std::nullopt) << k;
    const Scene scene = start.Settled();
    EXPECT_EQ(related.WhyNotKept(scene, start.objects), std::nullopt) << k;
    EXPECT_TRUE(SpatialRelation(scene, "cube", Relation::kOnTopOf, "brick").Holds()) << k;
    EXPECT_TRUE(SpatialRelation(scene, "peg", Relation::kInside, "dish").Holds()) << k;
    EXPECT_TRUE(SpatialRelation(scene, "die", Relation::kNextTo, "brick").Holds()) << k;
    EXPECT_FALSE(SpatialRelation(scene, "die", Relation::kInside, "dish").Holds()) << k;
  }
}

TEST(RelatedPlaces, FollowEachOther) {
  Start start({Block("top", {0.012, 0.012, 0.01}), Block("middle", {0.02, 0.02, 0.01}),
               Block("bottom", {0.03, 0.03, 0.01})});
  const RelatedPlaces related =
      start.Related({{"top", {.on_top_of = "middle"}}, {"middle", {.on_top_of = "bottom"}}});
  Rng rng = Rng::Stream(4, "tower");
  ASSERT_EQ(start.Put(related, rng), std::nullopt);
  const Scene scene = start.Settled();
  EXPECT_NEAR(
      scene.body_pose("top").translation().z() - scene.body_pose("bottom").translation().z(), 0.04,
      0.003);
}

TEST(RelatedPlaces, AreSpreadOverTheWholePlace) {
  Start start({Block("cube", {0.01, 0.01, 0.01}), Block("brick", {0.1, 0.04, 0.02})});
  const RelatedPlaces related = start.Related({{"cube", {.on_top_of = "brick"}}});
  double least = 1, most = -1;
  for (int k = 0; k < 200; ++k) {
    Rng rng = Rng::Stream(4, "spread", k);
    ASSERT_EQ(start.Put(related, rng), std::nullopt);
    const Eigen::Vector3d at =
        (start.objects[1].pose().inverse() * start.objects[0].pose()).translation();
    least = std::min(least, at.x());
    most = std::max(most, at.x());
    EXPECT_LE(std::abs(at.y()), 0.04);
  }
  EXPECT_LT(least, -0.07);
  EXPECT_GT(most, 0.07);
}

TEST(RelatedPlaces, BodiesOfTheSceneCanBeReferences) {
  Start start({Block("cube", {0.01, 0.01, 0.01})});
  start.base.objects.push_back({.name = "cabinet", .mjcf_path = "cabinet", .fixed = true});
  start.base.objects.back().pos = {0.3, 0, 0.451};
  const RelatedPlaces related = start.Related({{"cube", {.inside = "cabinet"}}});
  Rng rng = Rng::Stream(4, "cabinet");
  ASSERT_EQ(start.Put(related, rng), std::nullopt);
  const Scene scene = start.Settled();
  EXPECT_TRUE(SpatialRelation(scene, "cube", Relation::kInside, "cabinet").Holds());
}

TEST(RelatedPlaces, ReportsTheSizeOfAnObjectThatDoesNotFit) {
  Start start({Block("plank", {0.2, 0.01, 0.01}), {.name = "dish", .mjcf_path = "tray"}});
  const RelatedPlaces related = start.Related({{"plank", {.inside = "dish"}}});
  Rng rng = Rng::Stream(4, "plank");
  EXPECT_THAT(start.Put(related, rng),
              Optional(HasSubstr("'plank' inside 'dish': the object, 0.400 m wide")));
}

TEST(RelatedPlaces, AKindAppliesToItsObjectsAndCanBeAbsent) {
  Start start({Block("target", {0.01, 0.01, 0.01}), {.name = "object_1", .mjcf_path = "tray"}});
  const Start fresh = start;
  Rng rng = Rng::Stream(4, "kinds");
  const RelatedPlaces by_kind = start.Related({{"box", {.inside = "tray"}}});
  EXPECT_TRUE(by_kind.IsRelated(0));
  EXPECT_FALSE(by_kind.IsRelated(1));
  EXPECT_EQ(start.Put(by_kind, rng), std::nullopt);
  const RelatedPlaces none = fresh.Related({{"mug", {.inside = "tray"}}});
  EXPECT_FALSE(none.IsRelated(0));
  const RelatedPlaces missing = fresh.Related({{"target", {.next_to = "mug"}}});
  EXPECT_THAT(start.Put(missing, rng),
              Optional(HasSubstr("there is no other 'mug' in this start")));
}

// An object in a dish is beside other objects in it, and on top of them.
TEST(RelatedPlaces, ObjectsInOneContainerCanBeRelated) {
  Start start({{.name = "dish", .mjcf_path = "tray", .fixed = false},
               Block("peg", {0.01, 0.01, 0.01}),
               Block("die", {0.01, 0.01, 0.01}),
               Block("lid", {0.008, 0.008, 0.003})});
  const RelatedPlaces related = start.Related({{"peg", {.inside = "dish"}},
                                               {"die", {.next_to = "peg", .gap = {0.005, 0.02}}},
                                               {"lid", {.on_top_of = "peg"}}});
  int put = 0;
  for (int k = 0; k < 10; ++k) {
    Rng rng = Rng::Stream(4, "in one dish", k);
    if (start.Put(related, rng)) continue;
    ++put;
    const Scene scene = start.Settled();
    EXPECT_EQ(related.WhyNotKept(scene, start.objects), std::nullopt) << k;
    EXPECT_TRUE(SpatialRelation(scene, "die", Relation::kInside, "dish").Holds()) << k;
  }
  EXPECT_GE(put, 7);
}

TEST(RelatedPlaces, PlacesOfTheRunOverrideTheTask) {
  Start start({Block("target", {0.01, 0.01, 0.01}),
               Block("brick", {0.05, 0.04, 0.02}),
               {.name = "dish", .mjcf_path = "tray", .fixed = false}});
  start.kinds = {"cube", "brick", "tray"};
  const RelatedPlaces related =
      start.Related({{"cube", {.inside = "dish"}}}, {{"target", {.on_top_of = "brick"}}});
  Rng rng = Rng::Stream(4, "run first");
  ASSERT_EQ(start.Put(related, rng), std::nullopt);
  EXPECT_TRUE(SpatialRelation(start.Settled(), "target", Relation::kInside, "dish").Holds());
}

// The gap is between the outlines along the line between the two, however long the object is.
TEST(RelatedPlaces, TheGapNextToALongObjectIsFree) {
  Start start({Block("bar", {0.1, 0.01, 0.01}), Block("brick", {0.03, 0.03, 0.02})});
  const RelatedPlaces related = start.Related({{"bar", {.next_to = "brick", .gap = {0.01, 0.03}}}});
  for (int k = 0; k < 12; ++k) {
    Rng rng = Rng::Stream(4, "bar", k);
    if (start.Put(related, rng)) continue;
    const Scene scene = start.Settled();
    EXPECT_EQ(related.WhyNotKept(scene, start.objects), std::nullopt) << k;
    mjtNum fromto[6];
    const auto geom = [&](const char* name) { return FindId(scene.model(), mjOBJ_GEOM, name); };
    const double gap = mj_geomDistance(scene.model(), scene.data(), geom("bar_geom"),
                                       geom("brick_geom"), 1, fromto);
    EXPECT_GE(gap, 0.01 - 0.003) << k;
    const auto is_within = [&](double most) {
      return SpatialRelation(scene, "bar", Relation::kNextTo, "brick", most).Holds();
    };
    EXPECT_TRUE(is_within(0.03 + 0.003)) << k;
    EXPECT_FALSE(is_within(0.01 - 0.003)) << k;
  }
}

}  // namespace
}  // namespace robocell::internal
