#include "robocell/scenes/catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/validate.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

TEST(Catalogue, HasPrimitivesAndTheBuiltInModels) {
  EXPECT_THAT(ObjectKinds(), testing::IsSupersetOf({"box", "cylinder", "sphere", "mug", "bottle"}));
}

TEST(Catalogue, EveryKindIsAValidObjectThatBuilds) {
  SceneSpec spec{.name = "catalogue", .timestep = 0.002, .add_floor = true, .add_skybox = false};
  for (const std::string& kind : ObjectKinds()) {
    for (int i = 0; i < 20; ++i) {
      Rng rng = Rng::Stream(1, kind, i);
      const SceneObject object = MakeCatalogueObject(kind, kind + std::to_string(i), rng);
      EXPECT_NO_THROW(RequireValid(object, kind));
      const ObjectSize size = ObjectSizes().Of(object);
      EXPECT_GT(size.radius, 0) << kind;
      EXPECT_LT(size.radius, 0.12) << kind;
      EXPECT_GT(size.height, 0) << kind;
      if (i == 0) spec.objects.push_back(object);
    }
  }
  const Scene scene = Scene::Build(spec);
  for (const ObjectRecord& object : scene.compiled()->objects())
    EXPECT_TRUE(object.free_joint) << object.name;
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
