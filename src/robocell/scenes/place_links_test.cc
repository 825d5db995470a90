#include "robocell/scenes/place_links.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "robocell/scenes/testing/start_on_table.h"

namespace robocell::internal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Formats the places of a start: "0 on 1" by the objects' indices.
std::vector<std::string> Linked(const Map<ObjectPlace>& places) {
  const Start start({Block("top", {0.01, 0.01, 0.01}), Block("middle", {0.02, 0.02, 0.01}),
                     Block("bottom", {0.03, 0.03, 0.01})});
  const std::vector<StatedPlaces> stated = {{places, "start.places"}};
  Problems problems;
  const auto may_come = [](const std::string&) { return false; };
  std::vector<std::string> links;
  for (const PlaceLink& link : LinkPlaces(LandmarksOf(start.base), stated,
                                          {start.objects, start.kinds, may_come}, problems)) {
    const std::string of = link.other ? std::to_string(*link.other) : link.mark;
    links.push_back(std::to_string(link.object) + " on " + of);
  }
  EXPECT_TRUE(problems.empty()) << problems.Text("it");
  return links;
}

TEST(PlaceLinks, EachFollowsItsReferences) {
  EXPECT_THAT(Linked({{"top", {.on_top_of = "middle"}}, {"middle", {.on_top_of = "bottom"}}}),
              ElementsAre("1 on 2", "0 on 1"));
  EXPECT_THAT(Linked({{"middle", {.on_top_of = "bottom"}}, {"top", {.on_top_of = "middle"}}}),
              ElementsAre("1 on 2", "0 on 1"));
  EXPECT_THAT(Linked({{"bottom", {.on_top_of = "table"}}}), ElementsAre("2 on table"));
}

TEST(PlaceLinks, AllErrorsAreReportedTogether) {
  const Start start({Block("cube", {0.01, 0.01, 0.01}), Block("brick", {0.05, 0.04, 0.02})});
  const std::string text =
      start.Error({{"cube", {.inside = "brick"}}, {"brick", {.on_top_of = "shelf"}}});
  EXPECT_THAT(text, AllOf(HasSubstr("2 problems"), HasSubstr("start.places.cube: 'brick' has no"),
                          HasSubstr("start.places.brick: no object or body 'shelf'")));
}

// A drawer of a cabinet that the start brings itself.
TEST(PlaceLinks, KnowTheBodiesInsideObjectsOfTheStart) {
  SceneObject cabinet{.name = "target", .mjcf_path = "cabinet", .fixed = false};
  const Start start({Block("cube", {0.01, 0.01, 0.01}), cabinet});
  const std::vector<StatedPlaces> stated = {
      {{{"cube", {.inside = "target_drawer"}}}, "start.places"}};
  const auto may_come = [](const std::string&) { return false; };
  Problems problems;
  const std::vector<PlaceLink> links =
      LinkPlaces(LandmarksOf(start.base), stated, {start.objects, start.kinds, may_come}, problems);
  EXPECT_TRUE(problems.empty()) << problems.Text("it");
  ASSERT_EQ(links.size(), 1u);
  EXPECT_EQ(links[0].other, 1u);
  EXPECT_EQ(links[0].mark, "target_drawer");
  EXPECT_FALSE(links[0].marks->Floors(links[0].mark).empty());
  EXPECT_THAT(start.Error({{"cube", {.inside = "target_draver"}}}),
              HasSubstr("Did you mean 'target_drawer'?"));
}

TEST(PlaceLinks, RejectAPlaceForAnObjectWithAPose) {
  Start start({Block("cube", {0.01, 0.01, 0.01}), Block("brick", {0.05, 0.04, 0.02})});
  start.objects[0].pos = Vec3{0, 0, 0};
  EXPECT_THAT(start.Error({{"cube", {.on_top_of = "brick"}}}),
              HasSubstr("start.places.cube: it has a `pos` too"));
}

TEST(PlaceLinks, PlacesOfATaskNameTheirHook) {
  const Start start({Block("cube", {0.01, 0.01, 0.01})});
  ExpectThrow<SpecError>(
      [&] {
        (void)start.Related({}, {{"cube", {.on_top_of = "tabel"}}});
      },
      "task: places(): 'cube': no object or body 'tabel'");
}

TEST(PlaceLinks, AKindCanReferToATargetOfThatKind) {
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

TEST(PlaceLinks, APartNamesTheObjectThatItStandsFor) {
  const Start start({Block("brick", {0.01, 0.01, 0.01}), Block("cube", {0.02, 0.02, 0.01})});
  const auto may_come = [](const std::string&) { return false; };
  const auto linked = [&](const Map<ObjectPlace>& places, std::vector<std::string> parts) {
    const std::vector<StatedPlaces> stated = {{places, "places"}};
    Problems problems;
    std::vector<std::string> links;
    for (const PlaceLink& link :
         LinkPlaces(LandmarksOf(start.base), stated,
                    {start.objects, start.kinds, may_come, std::move(parts)}, problems)) {
      links.push_back(std::to_string(link.object) + " on " +
                      (link.other ? std::to_string(*link.other) : link.mark));
    }
    return problems.empty() ? links : std::vector<std::string>{problems.Text("it")};
  };
  const Map<ObjectPlace> of_target = {{"target", {.next_to = "cube"}}};
  EXPECT_THAT(linked(of_target, {"target", ""}), ElementsAre("0 on 1"));
  EXPECT_THAT(linked(of_target, {"", "target"}), ::testing::IsEmpty()) << "it refers to itself";
  EXPECT_THAT(linked({{"brick", {.on_top_of = "target"}}}, {"", "target"}), ElementsAre("0 on 1"));
  EXPECT_THAT(linked({{"taget", {.on_top_of = "table"}}}, {"", "target"}),
              ElementsAre(HasSubstr("Did you mean 'target'?")));
}

TEST(PlaceLinks, ErrorsAreReported) {
  const Start start({Block("cube", {0.01, 0.01, 0.01}), Block("brick", {0.05, 0.04, 0.02})});
  EXPECT_THAT(start.Error({{"cub", {.on_top_of = "brick"}}}),
              AllOf(HasSubstr("start.places"), HasSubstr("Did you mean 'cube'?")));
  EXPECT_THAT(start.Error({{"cube", {.on_top_of = "brik"}}}),
              AllOf(HasSubstr("start.places.cube"), HasSubstr("Did you mean 'brick'?")));
  EXPECT_THAT(start.Error({{"cube", {.inside = "brick"}}}),
              HasSubstr("'brick' has no hollow with a level floor. Say on_top_of"));
  EXPECT_THAT(start.Error({{"cube", {.on_top_of = "cube"}}}), HasSubstr("it refers to itself"));
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
