#include "robocell/scenes/catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/log.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/validate.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/scoped_env.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

TEST(Catalogue, HasPrimitivesAndTheBuiltInModels) {
  EXPECT_THAT(ObjectKinds(), testing::IsSupersetOf({"box", "cylinder", "sphere", "mug", "bottle"}));
}

TEST(Catalogue, EveryKindIsAValidObjectThatBuilds) {
  SceneSpec spec{.name = "catalogue", .timestep = 0.002, .add_floor = true, .add_skybox = false};
  const std::vector<std::string> defaults = DefaultObjectKinds();
  for (const std::string& kind : ObjectKinds()) {
    const bool is_default = std::ranges::find(defaults, kind) != defaults.end();
    for (int i = 0; i < 20; ++i) {
      Rng rng = Rng::Stream(1, kind, i);
      const SceneObject object = MakeCatalogueObject(kind, kind + std::to_string(i), rng);
      EXPECT_NO_THROW(RequireValid(object, kind));
      const ObjectSize size = ObjectSizes().Of(object);
      EXPECT_GT(size.radius, 0) << kind;
      EXPECT_LT(size.radius, is_default ? 0.12 : 0.2) << kind;
      EXPECT_GT(size.height, 0) << kind;
      if (i > 0) continue;
      spec.objects.push_back(object);
      spec.objects[spec.objects.size() - 1].pos =
          Vec3{0.5 * static_cast<double>(spec.objects.size()), 0, 0.3};
    }
  }
  const Scene scene = Scene::Build(spec);
  for (const ObjectRecord& object : scene.compiled()->objects())
    EXPECT_TRUE(object.free_joint) << object.name;
}

// The same seed keeps its draws however the catalogue grows.
TEST(Catalogue, TheDefaultKindsStayTheSame) {
  EXPECT_THAT(DefaultObjectKinds(), testing::ElementsAre("box", "cylinder", "sphere", "bottle",
                                                         "bracket", "mug", "nut", "spool"));
  EXPECT_EQ(KindsToDraw({}), DefaultObjectKinds());
}

TEST(Catalogue, AUsersMugIsDrawnInThePlaceOfTheBuiltInOne) {
  TempDir temp;
  std::filesystem::create_directories(temp.path() / "objects/mug");
  AtomicWrite(
      temp / "objects/mug/mug.xml",
      "<mujoco><worldbody><body><freejoint/><geom size='.03'/></body></worldbody></mujoco>");
  const std::vector<std::string> before = DefaultObjectKinds();
  const ScopedEnv env("ROBOCELL_MODEL_PATH", temp.path().string());
  EXPECT_EQ(DefaultObjectKinds(), before);
  EXPECT_NEAR(ObjectSizes().Of({.name = "mug", .mjcf_path = "mug"}).height, 0.03, 1e-9);
}

TEST(Catalogue, CategoriesStandForTheirKinds) {
  const std::map<std::string, std::vector<std::string>> categories = ObjectCategories();
  EXPECT_THAT(categories.at("fruit"),
              testing::ElementsAre("apple", "banana", "lemon", "orange", "pear"));
  EXPECT_THAT(categories.at("primitives"), testing::ElementsAre("box", "cylinder", "sphere"));
  EXPECT_THAT(ObjectKindsOf({"mug", "fruit", "apple", "mug"}),
              testing::ElementsAre("mug", "apple", "banana", "lemon", "orange", "pear"));
  EXPECT_THAT(ObjectKindsOf({"mgu"}), testing::ElementsAre("mgu"));
  // A category is no kind: `objects: [bottle]` means the one of that name.
  const std::vector<std::string> kinds = ObjectKinds();
  for (const auto& [category, members] : categories) {
    EXPECT_EQ(std::ranges::count(kinds, category), 0) << category;
    for (const std::string& kind : members) EXPECT_EQ(std::ranges::count(kinds, kind), 1) << kind;
  }
}

TEST(Catalogue, EveryKindHasWordsAndTheSizeOfItsModel) {
  for (const std::string& kind : ObjectKinds()) {
    const ObjectInfo info = ObjectInfoOf(kind);
    EXPECT_NE(info.category, "") << kind;
    if (!info.size) continue;
    EXPECT_NE(info.colour, "") << kind;
    const ObjectSize size = ObjectSizes().Of({.name = kind, .mjcf_path = kind});
    EXPECT_NEAR(size.height + size.top, (*info.size)[2], 0.004) << kind;
  }
  EXPECT_EQ(WordOfKind("milk_carton"), "milk carton");
  EXPECT_THROW(ObjectInfoOf("mugg"), NotFoundError);
  EXPECT_EQ(ObjectInfoOf("lid_box").category, "containers") << "equipment has words, too";
  EXPECT_EQ(ObjectInfoOf("table").category, "") << "or none";
}

TEST(Catalogue, UsersObjectsAreKinds) {
  TempDir temp;
  const std::string folder = temp / "objects/my_ball";
  std::filesystem::create_directories(folder);
  AtomicWrite(
      folder + "/my_ball.xml",
      "<mujoco><worldbody><body><freejoint/><geom size='.02'/></body></worldbody></mujoco>");
  const ScopedEnv env("ROBOCELL_MODEL_PATH", temp.path().string());
  EXPECT_THAT(ObjectKinds(), testing::Contains("my_ball"));
  EXPECT_EQ(ObjectInfoOf("my_ball").category, "") << "object.yaml may be missing";
  AtomicWrite(folder + "/object.yaml", "category: toys\nsynonyms: [marble]\n");
  EXPECT_THAT(ObjectKindsOf({"toys"}), testing::Contains("my_ball"));
  EXPECT_THAT(DefaultObjectKinds(), testing::Not(testing::Contains("my_ball")));
  Rng rng = Rng::Stream(1, "x");
  EXPECT_EQ(MakeCatalogueObject("my_ball", "x", rng).mjcf_path, "my_ball");
  AtomicWrite(folder + "/object.yaml", "category: toys\ncolor: red   # it changed\n");
  ExpectThrow<SpecError>([] { ObjectInfoOf("my_ball"); }, "object.yaml:2:1: color");
}

TEST(Catalogue, AFaultyFileOfOneKindLeavesTheOthersAlone) {
  const std::vector<std::string> defaults = DefaultObjectKinds();
  const std::vector<std::string> fruit = ObjectKindsOf({"fruit"});
  TempDir temp;
  for (const char* name : {"my_ball", "box"}) {  // that of a primitive's name is never read
    const std::string folder = temp / (std::string("objects/") + name);
    std::filesystem::create_directories(folder);
    AtomicWrite(folder + "/" + name + ".xml", "<mujoco/>");
    AtomicWrite(folder + "/object.yaml", "categry: fruit\n");
  }
  const ScopedEnv env("ROBOCELL_MODEL_PATH", temp.path().string());
  std::vector<std::string> warnings;
  const ScopedLogSink capture(
      [&](LogLevel, std::string_view text) { warnings.emplace_back(text); });
  EXPECT_EQ(DefaultObjectKinds(), defaults);
  EXPECT_EQ(ObjectKindsOf({"fruit"}), fruit);
  EXPECT_EQ(ObjectInfoOf("mug").category, "kitchen");
  EXPECT_THAT(warnings, testing::ElementsAre(testing::HasSubstr("my_ball/object.yaml:1:1")))
      << "once";
  EXPECT_EQ(ObjectKindsOf({"my_ball"}), std::vector<std::string>{"my_ball"});
  ExpectThrow<SpecError>([] { ObjectInfoOf("my_ball"); }, "object.yaml:1:1: categry");
  EXPECT_EQ(ObjectInfoOf("box").category, "primitives");
}

TEST(Catalogue, AKindIsFoundWithoutTheOthers) {
  for (const std::string& kind : ObjectKinds()) EXPECT_TRUE(IsObjectKind(kind)) << kind;
  for (const char* other : {"", "..", "table", "objects/mug", "mug/mug.xml"})
    EXPECT_FALSE(IsObjectKind(other)) << other;
}

TEST(Catalogue, ASizeFollowsTheModelsFile) {
  TempDir temp;
  SceneObject object{.name = "ball", .mjcf_path = temp / "ball.xml"};
  for (const char* radius : {"0.02", "0.03"}) {
    AtomicWrite(temp / "ball.xml",
                std::string("<mujoco><worldbody><body><freejoint/><geom size='") + radius +
                    "'/></body></worldbody></mujoco>");
    EXPECT_NEAR(ObjectSizes().Of(object).height, std::stod(radius), 1e-9);
  }
}

TEST(Catalogue, ReadsEachFileOnce) {
  ObjectSizes sizes;
  std::optional<ObjectSize> first;
  {
    TempDir temp;
    const SceneObject object{.name = "ball", .mjcf_path = temp / "ball.xml"};
    AtomicWrite(
        temp / "ball.xml",
        "<mujoco><worldbody><body><freejoint/><geom size='.02'/></body></worldbody></mujoco>");
    first = sizes.Of(object);
    std::filesystem::remove(temp / "ball.xml");
    EXPECT_EQ(sizes.Of(object).height, first->height);
    EXPECT_THROW(ObjectSizes().Of(object), NotFoundError);
  }
}

TEST(Catalogue, SameStreamSameObject) {
  Rng a = Rng::Stream(3, "object"), b = Rng::Stream(3, "object");
  EXPECT_TRUE(MakeCatalogueObject("box", "x", a) == MakeCatalogueObject("box", "x", b));
}

TEST(Catalogue, SuggestsTheNearestKind) {
  Rng rng = Rng::Stream(1, "x");
  try {
    MakeCatalogueObject("mugg", "x", rng);
    FAIL() << "no error";
  } catch (const NotFoundError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("no kind 'mugg'"));
    EXPECT_THAT(e.what(), testing::HasSubstr("Did you mean 'mug'?"));
  }
}

TEST(Catalogue, ObjectsInMillimetresAreTooLargeUnlessTheyAreFixed) {
  SceneObject box{.name = "box", .shape = Shape::kBox, .size = Vec3{20, 20, 30}};
  EXPECT_THAT(WhyTooLarge(box, ObjectSizes().Of(box)),
              testing::AllOf(testing::HasSubstr("object 'box' is 60 m large"),
                             testing::HasSubstr("a thousandth as large (in millimetres it would "
                                                "be 0.06 m)")));
  box.fixed = true;
  EXPECT_EQ(WhyTooLarge(box, ObjectSizes().Of(box)), "") << "a floor may be that large";
  SceneObject model{.name = "mug", .mjcf_path = "mug"};
  EXPECT_EQ(WhyTooLarge(model, ObjectSizes().Of(model)), "");
  EXPECT_THAT(WhyTooLarge(model, {.radius = 40}), testing::HasSubstr("give its <mesh> scale"));
}

}  // namespace
}  // namespace robocell
