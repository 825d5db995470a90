#include "robocell/task/base_placement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/spec/problems.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

BaseRange Ranges() {
  BaseRange task;
  task.distance = {0.3, 0.7};
  task.height_offset = -0.2;
  task.height_noise = {-0.1, 0.1};
  return task;
}

BasePlacement Place(uint64_t turn, int attempt) {
  Rng rng = Rng::Stream(1, "placement", static_cast<int>(turn), attempt);
  return SpreadBasePlacement(Ranges(), 7, turn, attempt, rng);
}

TEST(BasePlacement, ValuesOfTheRunOverrideTheTask) {
  const BaseRange plain = BaseRangeOf({}, Ranges());
  EXPECT_EQ(plain.distance, Ranges().distance);
  EXPECT_EQ(plain.height_offset, Ranges().height_offset);
  const BaseRange range =
      BaseRangeOf({.base_distance = {{0.4, 0.5}}, .base_height_noise = {{-0.3, 0.3}}}, Ranges());
  EXPECT_EQ(range.distance, (Vec2{0.4, 0.5}));
  EXPECT_EQ(range.height_noise, (Vec2{-0.3, 0.3}));
  EXPECT_EQ(range.height_offset, Ranges().height_offset);
}

TEST(BasePlacement, RejectsNonFiniteNumbers) {
  EXPECT_NO_THROW(RequireFinite({.distance = 0.4, .height = -0.1}));
  ExpectThrow<ArgumentError>([] { RequireFinite({.distance = std::nan("")}); },
                             "the distance of a base placement is nan; it must be finite metres");
  ExpectThrow<ArgumentError>([] { RequireFinite({.height = HUGE_VAL}); },
                             "the height of a base placement is inf");
}

TEST(BasePlacement, RangesAreFiniteAndInOrder) {
  EXPECT_NO_THROW(RequireSound(Ranges()));
  EXPECT_NO_THROW(RequireSound({.distance = {0, 0}}));
  ExpectThrow<ArgumentError>(
      [] {
        RequireSound({.distance = {0.5, 0.3}});
      },
      "the distance of a base range is [0.5, 0.3]; it is [smallest, largest] "
      "in finite metres, from 0 on");
  ExpectThrow<ArgumentError>([] { RequireSound({.distance = {-1, 0.3}}); }, "[-1, 0.3]");
  ExpectThrow<ArgumentError>([] { RequireSound({.distance = {0.3, HUGE_VAL}}); }, "[0.3, inf]");
  ExpectThrow<ArgumentError>(
      [] {
        RequireSound({.height_noise = {0.2, 0.1}});
      },
      "the height_noise of a base range is [0.2, 0.1]");
  ExpectThrow<ArgumentError>([] { RequireSound({.height_offset = std::nan("")}); },
                             "the height_offset of a base range is nan");
}

TEST(BasePlacement, EachConditionRejectsWithItsReason) {
  PickScene made = MakePickScene(ObjectOnTheTable("box"));
  const Pose target = made.scene.body_pose(made.target_body);
  made.scene.Forward();
  EXPECT_FALSE(ValidateBaseDistance(made.robot, target, {.distance = {0.4, 0.44}}));
  EXPECT_EQ(ValidateBaseDistance(made.robot, target, {.distance = {0.5, 0.6}})->reason,
            Refusal::kNoReachableBasePose);
  EXPECT_FALSE(ValidateBaseReach(made.robot, target));
  EXPECT_EQ(ValidateBaseReach(made.robot, Pose({0, 0, 9}))->reason, Refusal::kNoReachableBasePose);
  EXPECT_FALSE(ValidateBaseClearance(made.scene, made.robot, 0.01));
  const auto near = ValidateBaseClearance(made.scene, made.robot, 1);
  ASSERT_TRUE(near);
  EXPECT_EQ(near->reason, Refusal::kBaseInCollision);
  made.run.start.visible_from = {"exo_camera"};
  made.run.start.visible_share = 0.01;
  EXPECT_FALSE(ValidateVisibility(made.scene, made.target_body, made.run));
  made.run.start.visible_from = {"exo_camra"};
  EXPECT_THROW(ValidateVisibility(made.scene, made.target_body, made.run), NotFoundError);
}

TEST(BasePlacement, VisibilityIsJudgedInTheImageOfTheStream) {
  PickScene made = MakePickScene(ObjectOnTheTable("box"));
  made.scene.Forward();
  made.run.start.visible_share = 2;  // always refused, with the visible share
  made.run.start.visible_from = {"exo_camera"};
  const auto seen = [&] {
    return ValidateVisibility(made.scene, made.target_body, made.run)->detail;
  };
  made.run.cameras.streams = {};
  made.run.cameras.resolution = {640, 480};
  const std::string wide = seen();
  made.run.cameras.resolution = {4, 400};
  const std::string slit = seen();
  ASSERT_NE(slit, wide);
  made.run.cameras.streams = {{.name = "exo", .camera = "exo_camera", .width = 640, .height = 480}};
  EXPECT_EQ(seen(), wide);
  made.run.start.visible_from = {"exo"};
  EXPECT_EQ(seen(), std::regex_replace(wide, std::regex("exo_camera"), "exo"));
}

TEST(BasePlacement, RejectsAnUnknownCamera) {
  PickScene made = MakePickScene(ObjectOnTheTable("box"));
  made.run.start.visible_from = {"exo_camra"};
  const std::string text = ExpectThrow<NotFoundError>(
      [&] { ValidateVisibility(made.scene, made.target_body, made.run); },
      "Did you mean 'exo_camera'?");
  EXPECT_EQ(text.find("stream"), std::string::npos) << text;
}

TEST(BasePlacement, AProposedBaseFacesTheTargetAtItsDistance) {
  PickScene made = MakePickScene(ObjectOnTheTable("box"));
  const Pose target = made.scene.body_pose(made.target_body);
  const Support support = FindSupport(made.scene.compiled()->spec());
  Rng rng = Rng::Stream(3, "base");
  const auto base =
      ProposeBasePose(made.robot, support, target, {.distance = 0.45, .height = -0.25},
                      {.base_facing_noise = 0.1}, rng);
  ASSERT_TRUE(base);
  const Eigen::Vector3d displacement = target.translation() - base->translation();
  EXPECT_NEAR(displacement.head<2>().norm(), 0.45, 1e-9);
  EXPECT_NEAR(displacement.z(), 0.25, 1e-9);
  const Eigen::Vector3d ahead = base->rotation() * Eigen::Vector3d::UnitX();
  EXPECT_GT(ahead.head<2>().dot(displacement.head<2>().normalized()), std::cos(0.1) - 1e-9);
}

TEST(BasePlacement, CoversEveryQuarterOfTheRangesEvenly) {
  std::vector<int> distances(4), heights(4);
  for (uint64_t turn = 0; turn < 40; ++turn) {
    const BasePlacement place = Place(turn, 0);
    ++distances.at(static_cast<size_t>((place.distance - 0.3) / 0.1));
    ++heights.at(static_cast<size_t>((place.height + 0.3) / 0.05));
  }
  for (int quarter = 0; quarter < 4; ++quarter) {
    EXPECT_NEAR(distances[quarter], 10, 2) << quarter;
    EXPECT_NEAR(heights[quarter], 10, 2) << quarter;
  }
}

TEST(BasePlacement, FurtherTrialsSpreadWithinTheRanges) {
  double near = 0, far = 0;
  for (uint64_t turn = 0; turn < 50; ++turn) {
    const double first = Place(turn, 0).distance;
    near = std::max(near, std::abs(Place(turn, 1).distance - first));
    for (int attempt = 1; attempt < 20; ++attempt) {
      const BasePlacement place = Place(turn, attempt);
      EXPECT_GE(place.distance, 0.3);
      EXPECT_LE(place.distance, 0.7);
      EXPECT_GE(place.height, -0.3);
      EXPECT_LE(place.height, -0.1);
      far = std::max(far, std::abs(place.distance - first));
    }
  }
  EXPECT_LE(near, 0.15 * 0.4 + 1e-9);
  EXPECT_GE(far, 0.5 * 0.4);
}

// Returns the problem reported for a range, for the robot of the demo, whose reach is about 0.8 m.
std::string RangeProblem(const BaseRange& range) {
  static const PickScene kScene = MakePickScene(ObjectOnTheTable("box"));
  Problems problems;
  ValidateBaseRange(range, kScene.robot, problems);
  if (problems.empty()) return "";
  EXPECT_EQ(problems.list().size(), 1u);
  return problems.list()[0].path + ": " + problems.list()[0].message;
}

TEST(BasePlacement, RangesWithinTheReachPass) {
  EXPECT_EQ(RangeProblem({.distance = {0.3, 0.5}, .height_offset = -0.25}), "");
}

TEST(BasePlacement, ReportsTheMaximumForADistanceBeyondTheReach) {
  const std::string problem = RangeProblem({.distance = {0.3, 5}});
  const std::string begin = "start.base_distance: [0.3, 5] m goes beyond ";
  ASSERT_EQ(problem.substr(0, begin.size()), begin);
  const double most = std::stod(problem.substr(begin.size()));
  EXPECT_EQ(RangeProblem({.distance = {0.3, most}}), "") << "the printed value is accepted";
  EXPECT_NE(RangeProblem({.distance = {0.3, most + 0.002}}), "");
  // From there a target is refused, the second way to find it out.
  const PickScene scene = MakePickScene(ObjectOnTheTable("box"));
  const Pose base = scene.robot.base_in_world();
  const auto refused = [&](double distance) {
    const Pose target(base.translation() + Eigen::Vector3d(distance, 0, 0));
    return ValidateBaseReach(scene.robot, target).has_value();
  };
  EXPECT_FALSE(refused(kReachShare * scene.robot.reach() - 1e-6));
  EXPECT_TRUE(refused(kReachShare * scene.robot.reach() + 1e-6));
}

TEST(BasePlacement, ReportsAHeightBeyondTheReach) {
  const std::string problem = RangeProblem({.height_offset = 7});
  EXPECT_TRUE(problem.starts_with("start.base_height_offset: 7 m puts the base frame ")) << problem;
  // The noise may bring the height back into reach.
  EXPECT_EQ(RangeProblem({.distance = {0.1, 0.2}, .height_offset = 2, .height_noise = {-2, 0}}),
            "");
}

// The bound is that of the stretched arm: what it reaches at all is within it.
TEST(BasePlacement, OutOfReachMeansBeyondTheLengthOfTheArm) {
  SceneSpec spec{.name = "room", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.robots.push_back({.name = "arm", .config = Rc7(), .prefix = "arm_", .base = BaseConfig{}});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  const Robot arm = Robot::Of(scene, "arm");
  const double anywhere = -HUGE_VAL;
  const Eigen::Vector3d base = arm.base_in_world().translation();
  EXPECT_EQ(WhyOutOfReach({arm}, arm.tcp_in_world().translation(), anywhere, 0), "");
  EXPECT_EQ(WhyOutOfReach({arm}, base + Eigen::Vector3d(0.4, 0, 0.3), anywhere, 0), "");
  const Eigen::Vector3d far = base + Eigen::Vector3d(2 * arm.reach() + 1, 0, 0);
  EXPECT_NE(WhyOutOfReach({arm}, far, anywhere, 0), "");
  EXPECT_EQ(WhyOutOfReach({arm}, far, anywhere, 2 * arm.reach() + 2), "") << "within the slack";
}

}  // namespace
}  // namespace robocell
