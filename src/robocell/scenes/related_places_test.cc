#include "robocell/scenes/related_places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/object_places.h"
#include "robocell/scenes/settle.h"
#include "robocell/scenes/spatial_relation.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

SceneObject Block(const std::string& name, const Vec3& half) {
  SceneObject block = BoxObject(name, {0, 0, 0});
  block.size = half;
  return block;
}

// A table and a start on it.
struct Start {
  SceneSpec base{.name = "kitchen", .base = "tabletop", .add_floor = true};
  std::vector<SceneObject> objects;
  std::vector<std::string> kinds;

  explicit Start(std::vector<SceneObject> of) : objects(std::move(of)) {
    for (const SceneObject& object : objects) kinds.push_back(object.shape ? "box" : "tray");
  }
  std::vector<ObjectSize> sizes() const {
    std::vector<ObjectSize> out;
    ObjectSizes measured;
    for (const SceneObject& object : objects) out.push_back(measured.Of(object));
    return out;
  }
  RelatedPlaces Related(const Map<ObjectPlace>& places,
                        const Map<ObjectPlace>& of_task = {}) const {
    const std::vector<SaidPlaces> said = {
        {places, [](const std::string& key) { return "start.places." + key; }},
        {of_task, [](const std::string& key) { return "the task's " + key; }}};
    const auto may_come = [](const std::string& name) { return name == "mug"; };
    return RelatedPlaces(LinkPlaces(LandmarksOf(base), said, {objects, kinds, may_come}));
  }
  std::string Error(const Map<ObjectPlace>& places) const {
    return ExpectThrow<SpecError>([&] { (void)Related(places); }, "");
  }
  // Puts all, those without a place on the table.
  std::optional<std::string> Put(const RelatedPlaces& related, Rng& rng) {
    const Support table = FindSupport(base);
    const std::vector<ObjectSize> all = sizes();
    std::vector<SceneObject> loose;
    std::vector<ObjectSize> loose_sizes;
    for (size_t i = 0; i < objects.size(); ++i) {
      if (related.IsRelated(i)) continue;
      loose.push_back(objects[i]);
      loose_sizes.push_back(all[i]);
    }
    if (!PlaceOn(table, loose_sizes, loose, rng)) return "no room on the table";
    for (size_t i = 0, next = 0; i < objects.size(); ++i) {
      if (!related.IsRelated(i)) objects[i] = loose[next++];
    }
    return related.Put(table, all, objects, rng);
  }
  // The scene after everything came to rest.
  Scene Settled() const {
    SceneSpec spec = base;
    for (const SceneObject& object : objects) spec.objects.push_back(object);
    Scene scene = Scene::Build(spec);
    scene.Reset();
    EXPECT_TRUE(scene.StepN(400).ok());
    return scene;
  }
};

TEST(RelatedPlaces, ThingsLieWhereTheyAreSaidToAfterTheySettled) {
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

TEST(RelatedPlaces, BodiesOfTheSceneAreReferencesToo) {
  Start start({Block("cube", {0.01, 0.01, 0.01})});
  start.base.objects.push_back({.name = "cabinet", .mjcf_path = "cabinet", .fixed = true});
  start.base.objects.back().pos = {0.3, 0, 0.451};
  const RelatedPlaces related = start.Related({{"cube", {.inside = "cabinet"}}});
  Rng rng = Rng::Stream(4, "cabinet");
  ASSERT_EQ(start.Put(related, rng), std::nullopt);
  const Scene scene = start.Settled();
  EXPECT_TRUE(SpatialRelation(scene, "cube", Relation::kInside, "cabinet").Holds());
}

TEST(RelatedPlaces, WhatDoesNotFitIsSaidWithItsSize) {
  Start start({Block("plank", {0.2, 0.01, 0.01}), {.name = "dish", .mjcf_path = "tray"}});
  const RelatedPlaces related = start.Related({{"plank", {.inside = "dish"}}});
  Rng rng = Rng::Stream(4, "plank");
  EXPECT_THAT(start.Put(related, rng),
              Optional(HasSubstr("'plank' inside 'dish': the object, 0.400 m wide")));
}

TEST(RelatedPlaces, AKindStandsForItsObjectsAndMayBeMissingInAnEpisode) {
  Start start({Block("target", {0.01, 0.01, 0.01}), {.name = "object_1", .mjcf_path = "tray"}});
  Rng rng = Rng::Stream(4, "kinds");
  const RelatedPlaces by_kind = start.Related({{"box", {.inside = "tray"}}});
  EXPECT_TRUE(by_kind.IsRelated(0));
  EXPECT_FALSE(by_kind.IsRelated(1));
  EXPECT_EQ(start.Put(by_kind, rng), std::nullopt);
  const RelatedPlaces none = start.Related({{"mug", {.inside = "tray"}}});
  EXPECT_FALSE(none.IsRelated(0));
  const RelatedPlaces missing = start.Related({{"target", {.next_to = "mug"}}});
  EXPECT_THAT(start.Put(missing, rng),
              Optional(HasSubstr("there is no other 'mug' in this start")));
}

// What lies in a dish is beside other things in it, and on top of them.
TEST(RelatedPlaces, ThingsInOneContainerAreRelatedToEachOther) {
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

TEST(RelatedPlaces, AKindMayReferToTheTargetThatIsOfThatKind) {
  const Start start({Block("target", {0.01, 0.01, 0.01}), Block("object_1", {0.01, 0.01, 0.01})});
  const RelatedPlaces boxes = start.Related({{"box", {.next_to = "target"}}});
  EXPECT_FALSE(boxes.IsRelated(0)) << "it is what the others are next to";
  EXPECT_TRUE(boxes.IsRelated(1));
  const RelatedPlaces target = start.Related({{"target", {.next_to = "box"}}});
  EXPECT_TRUE(target.IsRelated(0)) << "the other box";
  Start alone({Block("target", {0.01, 0.01, 0.01})});
  Rng rng = Rng::Stream(4, "alone");
  EXPECT_THAT(alone.Put(alone.Related({{"target", {.next_to = "box"}}}), rng),
              Optional(HasSubstr("there is no other 'box' in this start")));
}

TEST(RelatedPlaces, WhatTheRunSaysComesBeforeTheTask) {
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
TEST(RelatedPlaces, TheGapOfALongObjectIsFree) {
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

TEST(RelatedPlaces, MistakesAreNamed) {
  const Start start({Block("cube", {0.01, 0.01, 0.01}), Block("brick", {0.05, 0.04, 0.02})});
  EXPECT_THAT(start.Error({{"cub", {.on_top_of = "brick"}}}),
              AllOf(HasSubstr("start.places"), HasSubstr("Did you mean 'cube'?")));
  EXPECT_THAT(start.Error({{"cube", {.on_top_of = "brik"}}}),
              AllOf(HasSubstr("start.places.cube"), HasSubstr("Did you mean 'brick'?")));
  EXPECT_THAT(start.Error({{"cube", {.inside = "brick"}}}),
              HasSubstr("'brick' has no hollow with a level floor. Say on_top_of"));
  EXPECT_THAT(start.Error({{"cube", {.on_top_of = "cube"}}}),
              HasSubstr("it cannot have its place by itself"));
  EXPECT_THAT(start.Error({{"cube", {.on_top_of = "brick"}}, {"brick", {.next_to = "cube"}}}),
              HasSubstr("run in a circle: 'cube' on_top_of 'brick', 'brick' next_to 'cube'"));
  EXPECT_THAT(start.Error({{"cube", {.on_top_of = "b", .inside = "a"}}}),
              HasSubstr("only one of on_top_of, inside and next_to"));
  EXPECT_THAT(start.Error({{"cube", {.next_to = "brick", .gap = {0.2, 0.1}}}}),
              HasSubstr("start.places.cube"));
  Start fixed = start;
  fixed.objects[0].fixed = true;
  EXPECT_THAT(fixed.Error({{"cube", {.on_top_of = "brick"}}}), HasSubstr("it is a fixed object"));
}

}  // namespace
}  // namespace robocell::internal
