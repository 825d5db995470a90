// Tests the judge of insertions without a robot: pegs of random shapes are put into, over and beside
// holes by their poses.
#include "robocell/scenes/insertion.h"

#include <gtest/gtest.h>

#include <string>

#include "robocell/base/error.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/relations.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

// A peg and its hole, somewhere on the floor.
Scene PegAndHole(bool is_round, double clearance, Rng& rng) {
  SceneSpec spec = EmptyScene();
  const double half = 0.015 - clearance / 2, tall = rng.Uniform(0.03, 0.08);
  SceneObject peg = BoxObject("peg", {0, 0, 0.3});
  peg.shape = is_round ? Shape::kCylinder : Shape::kBox;
  peg.size = is_round ? Vec3{half, tall, 0} : Vec3{half, half, tall};
  spec.objects.push_back(peg);
  spec.objects.push_back({.name = "block",
                          .mjcf_path = is_round ? "round_hole" : "square_hole",
                          .pos = Vec3{rng.Uniform(-1, 1), rng.Uniform(-1, 1), 0.021},
                          .euler = {0, 0, rng.Uniform(-180, 180)},
                          .fixed = true});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return scene;
}

void Put(Scene& scene, const Pose& pose) {
  scene.SetBodyPose("peg", pose);
  scene.Forward();
}

TEST(Insertion, HoldsFromItsShareOfTheDepthOnAndOnlyInTheHole) {
  Rng rng = Rng::Stream(0, "insertion");
  for (int i = 0; i < 8; ++i) {
    const bool is_round = i % 2 == 0;
    Scene scene = PegAndHole(is_round, rng.Uniform(2e-4, 1e-3), rng);
    const auto bound = BindRelation(scene, ParseRelation("peg inserted block"));
    const internal::Insertion insertion(scene, "peg", "block");
    EXPECT_NEAR(insertion.full_depth(), 0.03, 1e-9);
    EXPECT_FALSE(bound->Holds());
    const std::vector<Pose> poses = bound->Sample(rng, 16).poses;
    // A square peg fits four ways round.
    ASSERT_EQ(poses.size(), is_round ? 16u : 4u);
    for (const Pose& pose : poses) {
      Put(scene, pose);
      EXPECT_TRUE(bound->Holds());
      EXPECT_EQ(bound->Progress(), 1);
    }
    double before = 1;
    for (double share = 0.95; share > -1; share -= 0.1) {
      Put(scene, insertion.PoseAt(0, share * insertion.full_depth()));
      EXPECT_NEAR(insertion.Depth(), share * insertion.full_depth(), 1e-9);
      EXPECT_EQ(bound->Holds(), share >= 0.8) << share;
      EXPECT_LE(bound->Progress(), before) << share;
      before = bound->Progress();
    }
    Put(scene, Pose(Eigen::Vector3d(0.03, 0, 0)) * insertion.PoseAt(0, 0.03));
    EXPECT_FALSE(bound->Holds()) << "beside the hole";
    EXPECT_EQ(insertion.Depth(), 0);
  }
}

TEST(Insertion, IsNotThroughAHoleThatTheObjectHasLeft) {
  Rng rng = Rng::Stream(1, "insertion");
  for (int i = 0; i < 4; ++i) {
    Scene scene = PegAndHole(i % 2 == 0, 5e-4, rng);
    const auto bound = BindRelation(scene, ParseRelation("peg inserted block"));
    const internal::Insertion insertion(scene, "peg", "block");
    for (const double fallen : {0.3, 1.0, 5.0}) {
      Put(scene, insertion.PoseAt(0, 0.03 + fallen));
      EXPECT_FALSE(bound->Holds()) << fallen;
      EXPECT_LT(insertion.Depth(), 0) << fallen;
      EXPECT_LT(bound->Progress(), 0.5) << fallen;
    }
  }
}

TEST(Insertion, SaysWhatIsNoHole) {
  Rng rng = Rng::Stream(0, "insertion");
  const Scene scene = PegAndHole(true, 1e-3, rng);
  ExpectThrow<ArgumentError>([&] { internal::Insertion(scene, "block", "peg"); },
                             "no site whose name ends in 'hole'");
  ExpectThrow<NotFoundError>([&] { internal::Insertion(scene, "peg", "blok"); },
                             "Did you mean 'block'");
}

}  // namespace
}  // namespace robocell
