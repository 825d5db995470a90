// Tests the built-in relations: objects are put into and out of each relation by their poses; nothing
// is simulated and no robot is there. The samplers and the predicates judge each other.
#include "robocell/scenes/built_in_relations.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "robocell/base/error.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/joint_opening.h"
#include "robocell/scenes/relations.h"

namespace robocell {
namespace {

constexpr double kBoardTop = 0.2;          // of the board, m
constexpr double kPressedTogether = 1e-4;  // m, penetration of what touches

// A box or a cylinder of random size, a board, a tray and drawers on the floor, and two regions.
class BuiltInRelationsTest : public ::testing::Test {
 protected:
  Scene Make(Rng& rng) {
    SceneSpec spec = EmptyScene();
    SceneObject object = BoxObject("thing", {0, 0, 1});
    if (rng.Uniform() < 0.5) {
      object.size = Vec3{rng.Uniform(0.01, 0.03), rng.Uniform(0.01, 0.03), rng.Uniform(0.01, 0.05)};
    } else {
      object.shape = Shape::kCylinder;
      object.size = Vec3{rng.Uniform(0.01, 0.03), rng.Uniform(0.01, 0.05), 0};
    }
    half_height_ = (*object.size)[object.shape == Shape::kBox ? 2 : 1];
    spec.objects.push_back(object);
    SceneObject board = BoxObject("board", {1, rng.Uniform(-1, 1), kBoardTop / 2});
    board.size = Vec3{rng.Uniform(0.05, 0.3), rng.Uniform(0.05, 0.3), kBoardTop / 2};
    board.euler = {0, 0, rng.Uniform(-180, 180)};
    board.fixed = true;
    spec.objects.push_back(board);
    spec.objects.push_back(
        {.name = "dish", .mjcf_path = "tray", .pos = Vec3{-1, 0, 0.01}, .fixed = true});
    spec.objects.push_back(
        {.name = "chest", .mjcf_path = "drawer_unit", .pos = Vec3{0, 2, 0}, .fixed = true});
    const std::string marks = folder_.Write("marks", R"(<worldbody><body name="marks">
      <geom name="mark" type="box" size=".1 .05 .001" contype="0" conaffinity="0"/>
      <site name="spot" type="cylinder" size=".08 .001" pos="0 .5 0"/></body></worldbody>)");
    spec.objects.push_back(
        {.name = "field", .mjcf_path = marks, .pos = Vec3{-2, 0, 0}, .fixed = true});
    return Scene::Build(spec);
  }
  static void Put(Scene& scene, const Pose& pose) {
    scene.SetBodyPose("thing", pose);
    scene.Forward();
  }
  static Pose Moved(const Pose& pose, const Eigen::Vector3d& by) { return Pose(by) * pose; }
  static bool Holds(const Scene& scene, const std::string& text) {
    return BindRelation(scene, ParseRelation(text))->Holds();
  }

  ModelFolder folder_;
  double half_height_ = 0;
};

TEST_F(BuiltInRelationsTest, SamplesHoldAndWhatIsFarFromThemDoesNot) {
  const Eigen::Vector3d down(0, 0,
                             -kPressedTogether);  // samples stand on their support, without contact
  for (uint64_t seed = 0; seed < 12; ++seed) {
    Rng rng = Rng::Stream(seed, "relations");
    Scene scene = Make(rng);
    scene.Reset();
    Put(scene, Pose(Eigen::Vector3d(0, 0, half_height_)));
    for (const std::string text : {"thing on board", "thing inside dish",
                                   "thing next_to board 0.08", "thing in_region field_mark",
                                   "thing in_region field_spot", "thing in_region 0.5 0.25 0.1"}) {
      const auto bound = BindRelation(scene, ParseRelation(text));
      const Pose before = scene.body_pose("thing");
      EXPECT_FALSE(bound->Holds()) << text;
      EXPECT_LT(bound->Progress(), 1) << text;
      const std::vector<Pose> poses = bound->Sample(rng, 8).poses;
      EXPECT_EQ(poses.size(), 8u) << text;
      for (const Pose& pose : poses) {
        Put(scene, Moved(pose, down));
        EXPECT_TRUE(bound->Holds()) << text << " seed " << seed << " " << pose;
        EXPECT_EQ(bound->Progress(), 1) << text;
        Put(scene, Moved(pose, {0, 0, 1}));
        const bool level = text.find("in_region") != std::string::npos;
        EXPECT_EQ(bound->Holds(), level) << text;  // a region has no height
        Put(scene, Moved(pose, {0.7, 0.7, 0}));
        EXPECT_FALSE(bound->Holds()) << text;
      }
      Put(scene, before);
    }
  }
}

TEST_F(BuiltInRelationsTest, NextToEndsExactlyAtTheGap) {
  for (uint64_t seed = 0; seed < 8; ++seed) {
    Rng rng = Rng::Stream(seed, "gaps");
    Scene scene = Make(rng);
    scene.Reset();
    Put(scene, Pose(Eigen::Vector3d(0, 0, half_height_)));
    const auto wide = BindRelation(scene, ParseRelation("thing next_to board 10"));
    const Pose pose = wide->Sample(rng, 1).poses.front();
    Put(scene, pose);
    // The sampler's gap is found by bisection of the predicate.
    double low = 0, high = 10;
    for (int i = 0; i < 60; ++i) {
      const double gap = (low + high) / 2;
      (Holds(scene, fmt::format("thing next_to board {}", gap)) ? high : low) = gap;
    }
    EXPECT_GT(high, 0.3 * 10 - 0.01);
    EXPECT_LT(high, 0.8 * 10 + 0.01);
  }
}

TEST_F(BuiltInRelationsTest, RegionsEndExactlyAtTheirOutline) {
  Rng rng = Rng::Stream(0, "regions");
  Scene scene = Make(rng);
  scene.Reset();
  for (const double off : {-1e-6, 1e-6}) {
    Put(scene, Pose(Eigen::Vector3d(-2 + 0.1 + off, 0.049, 0.3)));
    EXPECT_EQ(Holds(scene, "thing in_region field_mark"), off < 0);
    EXPECT_EQ(Holds(scene, "thing in_region field"), off < 0);  // the object's largest geom
    Put(scene, Pose(Eigen::Vector3d(-2, 0.5 + 0.08 + off, 0.3)));
    EXPECT_EQ(Holds(scene, "thing in_region field_spot"), off < 0);
    Put(scene, Pose(Eigen::Vector3d(0.5, 0.25 + 0.1 + off, 0.3)));
    EXPECT_EQ(Holds(scene, "thing in_region 0.5 0.25 0.1"), off < 0);
  }
}

TEST_F(BuiltInRelationsTest, UprightEndsExactlyAtTheAngle) {
  Rng rng = Rng::Stream(1, "upright");
  Scene scene = Make(rng);
  scene.Reset();
  for (int i = 0; i < 10; ++i) {
    const double yaw = rng.Uniform(-3, 3), limit = rng.Uniform(0.05, 1);
    for (const double off : {-1e-6, 1e-6}) {
      const Pose turn = Pose::FromRpy({0, 0, 0}, {0, 0, yaw});
      Put(scene, turn * Pose::FromRpy({0, 0, 0.5}, {limit + off, 0, 0}));
      EXPECT_EQ(Holds(scene, fmt::format("thing upright {:.17g}", limit)), off < 0);
    }
    const auto bound = BindRelation(scene, ParseRelation("thing upright"));
    for (const Pose& pose : bound->Sample(rng, 4).poses) {
      Put(scene, pose);
      EXPECT_TRUE(bound->Holds());
    }
  }
}

TEST_F(BuiltInRelationsTest, JointsAreOpenAndClosedExactlyFromTheirShare) {
  Rng rng = Rng::Stream(2, "joints");
  Scene scene = Make(rng);
  scene.Reset();
  JointOpening drawer = JointOpening::Of(scene, "chest_drawer_1");
  EXPECT_EQ(drawer.joint(), "chest_drawer_1_slide");
  for (int i = 0; i < 10; ++i) {
    const double share = rng.Uniform(0.1, 0.9);
    for (const double off : {-1e-6, 1e-6}) {
      drawer.Put(share + off);
      scene.Forward();
      EXPECT_NEAR(drawer.share(), share + off, 1e-12);
      EXPECT_EQ(Holds(scene, fmt::format("chest_drawer_1 open >= {:.17g}", share)), off > 0);
      EXPECT_EQ(Holds(scene, fmt::format("chest_drawer_1 pressed {:.17g}", share)), off > 0);
      EXPECT_EQ(Holds(scene, fmt::format("chest_drawer_1 closed {:.17g}", share)), off < 0);
    }
    for (const char* relation : {"open", "closed"}) {
      const auto bound =
          BindRelation(scene, ParseRelation(fmt::format("chest_drawer_1 {} {}", relation, share)));
      const std::optional<double> at = bound->Sample(rng, 1).joint;
      ASSERT_TRUE(at.has_value());
      drawer.Put((*at - drawer.closed()) / (drawer.open() - drawer.closed()));
      scene.Forward();
      EXPECT_TRUE(bound->Holds()) << relation;
    }
  }
}

}  // namespace
}  // namespace robocell
