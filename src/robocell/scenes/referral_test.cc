// Referral expressions against an interpreter of their own: whoever reads one has to find the object
// that was meant, and no other.
#include "robocell/scenes/referral.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <string>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

ReferableObject Thing(const std::string& name, std::vector<std::string> nouns, double x, double y,
                      double half = 0.04, double z = 0) {
  return {.object = name,
          .nouns = std::move(nouns),
          .low = {x - half, y - half, z},
          .high = {x + half, y + half, z + 2 * half}};
}

Eigen::Vector3d MiddleOf(const ReferableObject& thing) { return 0.5 * (thing.low + thing.high); }

bool Has(const ReferableObject& thing, const std::string& noun) {
  return std::ranges::find(thing.nouns, noun) != thing.nouns.end();
}

// Whether a reader could call a thing so: one whose colour nobody knows may have any.
bool MayHave(const ReferableObject& thing, const std::string& noun) {
  if (Has(thing, noun)) return true;
  const size_t space = noun.find(' ');
  return space != std::string::npos && thing.nouns.size() == 1 &&
         thing.nouns[0] == noun.substr(space + 1);
}

// What a reader of an expression takes it to mean: a viewer at the origin looks along x.
std::set<std::string> Meant(const std::vector<ReferableObject>& things, const std::string& text) {
  std::set<std::string> found;
  const auto each = [&](const std::string& noun, const auto& holds) {
    for (const ReferableObject& thing : things) {
      if (MayHave(thing, noun) && holds(thing)) found.insert(thing.object);
    }
  };
  const std::string body = text.substr(4);  // "the "
  using Test =
      std::function<bool(const Eigen::Vector3d&, const ReferableObject&, const ReferableObject&)>;
  static const std::map<std::string, Test> kRelations = {
      {" left of the ", [](auto& d, auto&, auto&) { return d.y() > 0; }},
      {" right of the ", [](auto& d, auto&, auto&) { return d.y() < 0; }},
      {" behind the ", [](auto& d, auto&, auto&) { return d.x() > 0; }},
      {" in front of the ", [](auto& d, auto&, auto&) { return d.x() < 0; }},
      {" next to the ",
       [](auto& d, auto& a, auto& b) {
         const Eigen::Vector3d apart = d.cwiseAbs() - 0.5 * (a.high - a.low + b.high - b.low);
         return apart.head<2>().cwiseMax(0).norm() <= 0.2;
       }},
      {" on the ", [](auto&, auto& a, auto& b) { return std::abs(a.low.z() - b.high.z()) < 0.03; }},
      {" in the ", [](auto&, auto& a, auto& b) { return MiddleOf(a).z() < b.high.z(); }}};
  for (const auto& [words, test] : kRelations) {
    const size_t at = body.find(words);
    if (at == std::string::npos) continue;
    const std::string other = body.substr(at + words.size());
    for (const ReferableObject& landmark : things) {
      if (!MayHave(landmark, other)) continue;
      each(body.substr(0, at), [&, &words = words, &test = test](const ReferableObject& thing) {
        const Eigen::Vector3d d = MiddleOf(thing) - MiddleOf(landmark);
        // Directions are said of what is near, and mostly in that direction.
        const bool is_direction = words != " next to the " && words != " on the ";
        if (&thing == &landmark || d.head<2>().norm() > 0.8) return false;
        const bool is_ahead = words == " behind the " || words == " in front of the ";
        const double along = std::abs(is_ahead ? d.x() : d.y());
        const double across = std::abs(is_ahead ? d.y() : d.x());
        if (is_direction && words != " in the " && across > 1.4 * along) return false;
        return test(d, thing, landmark);
      });
    }
    return found;
  }
  using Measure = std::function<double(const Eigen::Vector3d&)>;
  static const std::map<std::string, Measure> kOrders = {
      {"leftmost ", [](auto& at) { return -at.y(); }},
      {"rightmost ", [](auto& at) { return at.y(); }},
      {"nearest ", [](auto& at) { return std::hypot(at.x(), at.y()); }},
      {"farthest ", [](auto& at) { return -std::hypot(at.x(), at.y()); }}};
  for (const auto& [words, measure] : kOrders) {
    if (!body.starts_with(words)) continue;
    const ReferableObject* first = nullptr;
    for (const ReferableObject& thing : things) {
      if (MayHave(thing, body.substr(words.size())) &&
          (!first || measure(MiddleOf(thing)) < measure(MiddleOf(*first))))
        first = &thing;
    }
    return {first->object};
  }
  each(body, [](const ReferableObject&) { return true; });
  return found;
}

TEST(Referrals, EachExpressionMeansItsObjectAlone) {
  int said = 0, objects = 0;
  for (int seed = 0; seed < 300; ++seed) {
    Rng rng = Rng::Stream(seed, "referral");
    static const std::vector<std::vector<std::string>> kNouns = {
        {"mug", "red mug"}, {"mug", "blue mug"}, {"mug"}, {"laptop"}, {"box", "red box"}, {"bowl"}};
    std::vector<ReferableObject> things;
    const int count = 2 + static_cast<int>(rng.UniformInt(6));
    for (int i = 0; i < count; ++i) {
      things.push_back(Thing("thing_" + std::to_string(i), kNouns[rng.UniformInt(kNouns.size())],
                             rng.Uniform(0.3, 1.1), rng.Uniform(-0.4, 0.4),
                             rng.Uniform(0.02, 0.08)));
    }
    for (const ReferableObject& thing : things) {
      ++objects;
      const std::vector<std::string> ways = ReferralsTo(things, thing.object, {});
      said += !ways.empty();
      for (const std::string& way : ways)
        EXPECT_THAT(Meant(things, way), ElementsAre(thing.object)) << way << ", seed " << seed;
    }
  }
  EXPECT_GT(said, 0.7 * objects);  // most objects of such scenes can be told apart
}

TEST(Referrals, BeginWithTheSimplest) {
  const std::vector<ReferableObject> things = {Thing("a", {"mug", "red mug"}, 0.5, 0.3),
                                               Thing("b", {"mug", "blue mug"}, 0.5, -0.3),
                                               Thing("c", {"laptop"}, 0.5, 0, 0.1)};
  EXPECT_EQ(ReferralsTo(things, "c", {}).front(), "the laptop");
  const std::vector<std::string> of_a = ReferralsTo(things, "a", {});
  EXPECT_EQ(of_a.front(), "the red mug");
  EXPECT_THAT(of_a, Contains("the mug left of the laptop"));
  EXPECT_THAT(of_a, Contains("the leftmost mug"));
  EXPECT_THAT(of_a, Not(Contains("the mug")));
  // The one who looks from the other side sees it on the right.
  const Viewer opposite{.position = {1, 0, 0}, .forward = {-1, 0, 0}};
  EXPECT_THAT(ReferralsTo(things, "a", opposite), Contains("the mug right of the laptop"));
}

TEST(Referrals, DoNotSayWhatIsInDoubt) {
  // Twins at one place: nothing tells them apart.
  const std::vector<ReferableObject> twins = {Thing("a", {"mug"}, 0.5, 0),
                                              Thing("b", {"mug"}, 0.5, 0.02)};
  EXPECT_THAT(ReferralsTo(twins, "a", {}), IsEmpty());
  ExpectThrow<NotFoundError>([&] { ReferralsTo(twins, "c", {}); }, "no object with words 'c'");
}

TEST(Referrals, KnowWhatIsOnAndInSomething) {
  ReferableObject tray = Thing("tray", {"tray"}, 0.5, 0, 0.2);
  tray.high.z() = 0.1;
  std::vector<ReferableObject> things = {tray, Thing("a", {"mug"}, 0.5, 0, 0.03, 0.1),
                                         Thing("b", {"mug"}, 0.5, 0.6, 0.03)};
  EXPECT_THAT(ReferralsTo(things, "a", {}), Contains("the mug on the tray"));
  things[1] = Thing("a", {"mug"}, 0.5, 0, 0.03, 0.01);
  EXPECT_THAT(ReferralsTo(things, "a", {}), Not(Contains("the mug in the tray")));
  things[0].has_hollow = true;
  EXPECT_THAT(ReferralsTo(things, "a", {}), Contains("the mug in the tray"));
}

TEST(Referrals, TheNearestIsTheOneAtTheShortestDistance) {
  // Ahead of the viewer, b is farther than a; a is far to the left.
  const std::vector<ReferableObject> things = {Thing("a", {"mug"}, 0.3, 1.0),
                                               Thing("b", {"mug"}, 0.4, 0)};
  EXPECT_THAT(ReferralsTo(things, "b", {}), Contains("the nearest mug"));
  EXPECT_THAT(ReferralsTo(things, "a", {}), Contains("the farthest mug"));
  EXPECT_THAT(ReferralsTo(things, "a", {}), Not(Contains("the nearest mug")));
  // From where a is, it is the nearest.
  EXPECT_THAT(ReferralsTo(things, "a", {.position = {0.3, 0.9, 0}}), Contains("the nearest mug"));
}

TEST(Referrals, AThingMayHaveTheColourThatNobodyKnows) {
  std::vector<ReferableObject> things = {Thing("a", {"mug", "red mug"}, 0.5, 0.3),
                                         Thing("b", {"mug"}, 0.5, -0.3)};
  EXPECT_THAT(ReferralsTo(things, "a", {}), Not(Contains("the red mug")));
  EXPECT_THAT(ReferralsTo(things, "a", {}), Contains("the leftmost mug"));
  things[1].nouns.emplace_back("blue cup");  // words of people
  EXPECT_THAT(ReferralsTo(things, "a", {}), Contains("the red mug"));
  // A tea box is a box.
  things = {Thing("a", {"box"}, 0.5, 0.3), Thing("b", {"tea box"}, 0.5, -0.3)};
  EXPECT_THAT(ReferralsTo(things, "a", {}), Not(Contains("the box")));
  EXPECT_THAT(ReferralsTo(things, "a", {}), Contains("the leftmost box"));
}

TEST(Referrals, AShelfWithAMugInsideHasNoMugOnIt) {
  ReferableObject shelf = Thing("shelf", {"shelf"}, 0.5, 0, 0.2);
  shelf.high.z() = 1;
  std::vector<ReferableObject> things = {shelf, Thing("top", {"mug"}, 0.5, 0, 0.04, 1),
                                         Thing("board", {"mug"}, 0.5, 0.05, 0.04, 0.5)};
  EXPECT_EQ(Holds(SeenRelation::kOn, things[2], shelf, {}), Answer::kInDoubt);
  EXPECT_THAT(ReferralsTo(things, "top", {}), Not(Contains("the mug on the shelf")));
  EXPECT_THAT(ReferralsTo(things, "board", {}), Not(Contains("the mug on the shelf")));
  things.pop_back();
  things.push_back(Thing("floor", {"mug"}, 0.5, 0.6, 0.04));
  EXPECT_THAT(ReferralsTo(things, "top", {}), Contains("the mug on the shelf"));
}

TEST(Referrals, ObjectsOfASceneHaveTheWordsOfTheirShapesAndColours) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(BoxObject("left", {0.4, 0.2, 0.02}));
  spec.objects.push_back(BoxObject("right", {0.4, -0.2, 0.02}));
  spec.objects[0].rgba = Vec4{0.9, 0.1, 0.1, 1};
  spec.objects[1].rgba = Vec4{0.1, 0.2, 0.9, 1};
  Scene scene = Scene::Build(spec);
  scene.Reset();
  const std::vector<ReferableObject> objects = ReferableObjects(scene);
  EXPECT_EQ(ReferralsTo(objects, "left", {}).front(), "the red box");
  EXPECT_EQ(ReferralsTo(objects, "right", {}).front(), "the blue box");
  // Between red and orange, the other one has no colour that all would name.
  spec.objects[1].rgba = Vec4{1, 0.25, 0, 1};
  Scene doubtful = Scene::Build(spec);
  doubtful.Reset();
  EXPECT_THAT(ReferralsTo(ReferableObjects(doubtful), "left", {}), Not(Contains("the red box")));
  const std::vector<ObjectWords> known = {
      {.object = "left", .category = "RemoteControl", .words = {"the grey thing"}}};
  EXPECT_THAT(ReferableObjects(scene, known)[0].nouns,
              ElementsAre("remote control", "grey thing", "red remote control"));
}

}  // namespace
}  // namespace robocell
