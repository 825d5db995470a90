#include "robocell/task/grasp_candidates.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/random_values.h"

namespace robocell {
namespace {

using Eigen::Vector3d;

std::vector<GraspCandidate> GraspsOf(const PickScene& pick) {
  PlanningScene planning = pick.planning();
  return FindGrasps(planning.model(), planning.data(), planning.target_body(), *pick.shape(),
                    pick.robot.tcp_in_world());
}

SceneObject Box(double x, double y, double z) {
  SceneObject box = ObjectOnTheTable("box");
  box.size = Vec3{x, y, z};
  (*box.pos)[2] = 0.4505 + z;
  return box;
}

TEST(CastRay, AgreesWithTheEnginesRays) {
  Rng rng = Rng::Stream(1, "rays");
  for (const char* kind : {"box", "cylinder", "sphere", "bracket", "mug"}) {
    PickScene pick = MakePickScene(ObjectOnTheTable(kind));
    // The object is far from everything else, and the engine casts rays at solid geoms only.
    pick.scene.SetBodyPose(pick.target_body, Pose({30, 0, 5}, RandomQuaternion(rng)));
    const mjModel* m = pick.scene.model();
    const std::vector<int> geoms =
        internal::CollisionGeomsOf(m, FindId(m, mjOBJ_BODY, pick.target_body));
    mjtByte groups[mjNGROUP] = {0};
    for (const int g : geoms) groups[m->geom_group[g]] = 1;
    int hits = 0;
    for (int i = 0; i < 300; ++i) {
      const Vector3d target = Vector3d(30, 0, 5) + RandomVector(rng, 0.04);
      const Vector3d direction = RandomDirection(rng), from = target - 0.2 * direction;
      int geom = -1;
      const double oracle = mj_ray(m, pick.scene.data(), from.data(), direction.data(), groups, 1,
                                   -1, &geom, nullptr);
      const internal::RayHit hit = internal::CastRay(m, pick.scene.data(), geoms, from, direction);
      ASSERT_EQ(std::isfinite(hit.distance), oracle >= 0 && oracle < 1) << kind;
      if (!std::isfinite(hit.distance)) continue;
      ++hits;
      EXPECT_NEAR(hit.distance, oracle, 1e-9);
      EXPECT_LE(hit.normal.dot(direction), 1e-9);
    }
    EXPECT_GT(hits, 30) << kind;
  }
}

TEST(FindGrasps, PrefersGraspsAcrossTheFacesOfABox) {
  const PickScene pick = MakePickScene(Box(0.015, 0.03, 0.02));
  const std::vector<GraspCandidate> grasps = GraspsOf(pick);
  ASSERT_GE(grasps.size(), 4u);
  const double width = grasps.front().width;
  EXPECT_TRUE(std::abs(width - 0.03) < 1e-4 || std::abs(width - 0.06) < 1e-4) << width;
  const Eigen::Matrix3d box = pick.scene.body_pose(pick.target_body).rotation();
  for (const GraspCandidate& grasp : grasps) {
    const Vector3d closing = (grasp.tcp_in_world * pick.shape()->grasp_in_tcp()).rotation().col(1);
    const double square = (box.transpose() * closing).cwiseAbs().maxCoeff();
    EXPECT_GT(square, std::cos(25 * 3.14159 / 180) - 1e-3);
  }
}

TEST(FindGrasps, CandidatesAreFromAboveSortedAndOffTheTable) {
  for (const std::string& kind : DefaultObjectKinds()) {
    const PickScene pick = MakePickScene(ObjectOnTheTable(kind));
    const std::vector<GraspCandidate> grasps = GraspsOf(pick);
    ASSERT_FALSE(grasps.empty()) << kind;
    const auto shape = pick.shape();
    for (size_t i = 0; i < grasps.size(); ++i) {
      const Pose grasp = grasps[i].tcp_in_world * shape->grasp_in_tcp();
      EXPECT_NEAR(grasp.rotation()(2, 2), -1, 1e-9);
      EXPECT_GE(grasp.translation().z() - shape->TipAt(grasps[i].width), 0.4525) << kind;
      EXPECT_LT(grasps[i].width, shape->open_gap() - 0.011);
      EXPECT_GE(grasps[i].cost, grasps[i > 0 ? i - 1 : 0].cost);
    }
  }
}

// A hand that opens 90 mm takes everything whose object.yaml says that one of 75 mm does.
TEST(FindGrasps, FindsGraspsFromAboveForEveryKindThatHasThem) {
  const std::vector<std::string> defaults = DefaultObjectKinds();
  for (const std::string& kind : ObjectKinds()) {
    const std::vector<ObjectGrasp> grasps = ObjectInfoOf(kind).grasps;
    const bool from_above = std::ranges::find(grasps, ObjectGrasp::kTop) != grasps.end();
    if (!from_above || std::ranges::find(defaults, kind) != defaults.end()) continue;
    const PickScene pick = MakePickScene(ObjectOnTheTable(kind));
    const std::vector<GraspCandidate> found = GraspsOf(pick);
    EXPECT_TRUE(std::ranges::any_of(found, [](const GraspCandidate& grasp) {
      return grasp.width <= 0.075 - 0.011;
    })) << kind;
  }
}

// The centre of the pads lies midway between the points that rays hit on both sides, except near
// edges.
TEST(FindGrasps, TheObjectIsCentredBetweenThePads) {
  for (const char* kind : {"box", "cylinder", "sphere", "bottle", "nut", "spool"}) {
    const PickScene pick = MakePickScene(ObjectOnTheTable(kind));
    PlanningScene planning = pick.planning();
    const std::vector<int> geoms =
        internal::CollisionGeomsOf(planning.model(), planning.target_body());
    const GraspCandidate best = GraspsOf(pick).front();
    const auto shape = pick.shape();
    const Pose grasp = best.tcp_in_world * shape->grasp_in_tcp();
    const Vector3d middle = grasp * shape->PadAt(best.width), y = grasp.rotation().col(1);
    const double left =
        internal::CastRay(planning.model(), planning.data(), geoms, middle + 0.1 * y, -y).distance;
    const double right =
        internal::CastRay(planning.model(), planning.data(), geoms, middle - 0.1 * y, y).distance;
    // Curved pads' edges may touch up to a millimetre or two before the middle does.
    EXPECT_NEAR(left, right, 0.003) << kind;
    EXPECT_NEAR(0.2 - left - right, best.width, 0.004) << kind;
  }
}

// A few candidates that are only just accepted may differ.
TEST(FindGrasps, RotateWithTheObject) {
  const PickScene a = MakePickScene(ObjectOnTheTable("bracket", 0.2));
  const PickScene b = MakePickScene(ObjectOnTheTable("bracket", 1.9));
  const Pose in_a = a.scene.body_pose(a.target_body).inverse();
  const Pose in_b = b.scene.body_pose(b.target_body).inverse();
  const std::vector<GraspCandidate> grasps = GraspsOf(a), turned = GraspsOf(b);
  size_t partners = 0;
  for (const GraspCandidate& grasp : grasps) {
    partners += std::any_of(turned.begin(), turned.end(), [&](const GraspCandidate& other) {
      return (in_b * other.tcp_in_world).is_close(in_a * grasp.tcp_in_world, 0.01, 0.001) &&
             std::abs(other.width - grasp.width) < 0.001;
    });
  }
  EXPECT_GE(partners, grasps.size() * 9 / 10);
  EXPECT_GT(partners, 50u);
}

TEST(FindGrasps, ReturnsNoneForUnsuitableSizes) {
  EXPECT_TRUE(GraspsOf(MakePickScene(Box(0.05, 0.05, 0.02))).empty());
  SceneObject rod = Box(0.0015, 0.0015, 0.02);
  rod.fixed = true;  // it would fall over
  EXPECT_TRUE(GraspsOf(MakePickScene(rod)).empty());
  EXPECT_TRUE(GraspsOf(MakePickScene(Box(0.02, 0.02, 0.005))).empty());
}

TEST(HeldWidths, AreNoRangeIfTheGripperHoldsNothing) {
  EXPECT_EQ(DescribeHeldWidths(0.002, 0.09), "holds from 0.007 to 0.078 m");
  for (const double open : {0.01, 0.01799, 0.018, 0.0184}) {
    EXPECT_THAT(DescribeHeldWidths(0, open),
                ::testing::StartsWith("holds nothing: open, its fingers are 0.01"));
  }
  EXPECT_EQ(DescribeHeldWidths(0, 0.01799),
            "holds nothing: open, its fingers are 0.018 m apart, which leaves 0.00599 m between "
            "0.006 m of clearance on both sides, and 0.006 m are the least that it can hold");
}

// A vice: one jaw is part of the hand, the other slides. The object is beside the middle of the open
// hand, clear of the jaw that cannot make room.
TEST(FindGrasps, KeepsClearOfAJawThatDoesNotMove) {
  ModelFolder folder;
  const RobotConfig config{
      .name = "vice",
      .model = folder.Write("vice", R"(<worldbody><body name="mast" pos="0 0 1">
  <body name="hand"><joint name="lift" type="slide" axis="0 0 1" range="-.1 .1"/>
    <geom type="box" size=".05 .05 .01" mass=".2"/>
    <geom name="fixed" type="box" size=".01 .005 .03" pos="0 -.035 -.05" mass=".05"/>
    <site name="tip" pos="0 0 -.07" quat="0 1 0 0"/>
    <body name="jaw" pos="0 .035 -.05"><joint name="slide" type="slide" axis="0 -1 0"
        range="0 .06" damping="5" armature=".1"/>
      <geom name="moving" type="box" size=".01 .005 .03" mass=".05"/></body></body></body></worldbody>
  <actuator><position name="servo" joint="lift" kp="2000" kv="100"/>
    <position name="grip" joint="slide" kp="800" kv="20" ctrlrange="0 .06"/></actuator>)"),
      .move_groups = {{"arm",
                       {.kind = MoveGroupKind::kArm,
                        .joints = {"lift"},
                        .actuators = {"servo"},
                        .leaf = ElementRef{.name = "tip"}}},
                      {"grip",
                       {.kind = MoveGroupKind::kGripper,
                        .joints = {"slide"},
                        .actuators = {"grip"},
                        .leaf = ElementRef{.name = "tip"},
                        .fingers = {{.name = "fixed"}, {.name = "moving"}}}}}};
  const auto shape = GripperShape::Of(config, {}, 0.002);
  ASSERT_NEAR(shape->open_gap(), 0.06, 1e-3);
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(BoxObject("box", {0.4, 0, 0.5}));
  Scene scene = Scene::Build(spec);
  scene.Forward();
  const std::vector<GraspCandidate> grasps = FindGrasps(
      scene.model(), scene.data(), FindId(scene.model(), mjOBJ_BODY, "box"), *shape, Pose());
  ASSERT_FALSE(grasps.empty());
  for (const GraspCandidate& grasp : grasps) {
    // The middle of the object's faces, in the grasp frame of the open hand.
    const Pose frame = grasp.tcp_in_world * shape->grasp_in_tcp();
    const double object = (frame.inverse() * Vector3d(0.4, 0, 0.5)).y();
    const double middle = shape->PadAt(shape->open_gap()).y(), half = shape->open_gap() / 2;
    EXPECT_GE(object - grasp.width / 2 - (middle - half), 0.0039);
    EXPECT_GE(middle + half - (object + grasp.width / 2), 0.0039);
    EXPECT_NEAR(grasp.aside, 0.004, 2e-4);
  }
}

// The tips of a jaw that swings part along an arc, so that their distance grows more than the space
// between them. The oracle is where the model has the jaw that stays.
TEST(FindGrasps, KeepsClearOfAFixedJawWhileTheOtherSwings) {
  ModelFolder folder;
  const RobotConfig config{
      .name = "pliers",
      .model = folder.Write("pliers", R"(<worldbody><body name="mast" pos="0 0 1">
  <body name="hand"><joint name="lift" type="slide" axis="0 0 1" range="-.1 .1"/>
    <geom type="box" size=".05 .05 .01" mass=".2"/>
    <geom type="box" size=".01 .005 .03" pos="0 -.015 -.05" mass=".05"/>
    <site name="fixed" pos="0 -.01 -.08"/>
    <site name="tip" pos="0 0 -.08" quat="0 1 0 0"/>
    <body name="jaw" pos="0 .015 -.02"><joint name="hinge" axis="1 0 0" range="-.3 1.2"
        damping=".2" armature=".002"/>
      <geom type="box" size=".01 .005 .03" pos="0 0 -.03" mass=".05"/>
      <site name="moving" pos="0 -.005 -.06"/></body></body></body></worldbody>
  <compiler angle="radian"/>
  <actuator><position name="servo" joint="lift" kp="2000" kv="100"/>
    <position name="grip" joint="hinge" kp="10" kv=".5" ctrlrange="-.3 1.2"/></actuator>)"),
      .move_groups = {{"arm",
                       {.kind = MoveGroupKind::kArm,
                        .joints = {"lift"},
                        .actuators = {"servo"},
                        .leaf = ElementRef{.name = "tip"}}},
                      {"grip",
                       {.kind = MoveGroupKind::kGripper,
                        .joints = {"hinge"},
                        .actuators = {"grip"},
                        .leaf = ElementRef{.name = "tip"},
                        .fingers = {{.name = "fixed"}, {.name = "moving"}}}}}};
  const auto shape = GripperShape::Of(config, {}, 0.002);
  EXPECT_LT(shape->AcrossAt(shape->open_gap()), shape->open_gap() - 0.005) << "it swings";
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(BoxObject("box", {0.4, 0, 0.5}));
  Scene scene = Scene::Build(spec);
  scene.Forward();
  const std::vector<GraspCandidate> grasps = FindGrasps(
      scene.model(), scene.data(), FindId(scene.model(), mjOBJ_BODY, "box"), *shape, Pose());
  ASSERT_FALSE(grasps.empty());
  const Pose hand_in_tcp = Pose({0, 0, -0.08}, Quaternion{1, 0, 0, 0}).inverse();
  for (const GraspCandidate& grasp : grasps) {
    const Pose frame = grasp.tcp_in_world * shape->grasp_in_tcp();
    const Pose hand = grasp.tcp_in_world * hand_in_tcp;
    const double face = (frame.inverse() * (hand * Vector3d(0, -0.01, -0.05))).y();
    const double object = (frame.inverse() * Vector3d(0.4, 0, 0.5)).y();
    EXPECT_GE(std::abs(object - face) - grasp.width / 2, 0.0035) << "clear of the fixed jaw";
  }
}

}  // namespace
}  // namespace robocell
