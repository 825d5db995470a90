#include "robocell/motion/motion_planner.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "robocell/robot/collision_filter.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/instruction_sets.h"

namespace robocell {
namespace {

SceneObject Wall(const std::string& name, const Vec3& half, const Vec3& pos) {
  SceneObject wall = BoxObject(name, pos);
  wall.size = half;
  wall.fixed = true;
  return wall;
}

// The built-in robot beside a wall that separates its left from its right.
class MotionPlannerOfRc7 : public ::testing::Test {
 protected:
  static SceneSpec Spec() {
    SceneSpec spec = SceneWith({.name = "rc7", .config = Rc7()});
    spec.objects.push_back(Wall("wall", {0.2, 0.02, 0.35}, {0.4, 0, 0.35}));
    spec.objects.push_back(BoxObject("cube", {-0.5, 0.4, 0.021}));
    return spec;
  }

  void SetUp() override {
    scene_.Reset();
    start_ = robot_.arm().joint_pos();
    start_[0] += 0.7;
    robot_.SetJointPos(start_);
    goal_ = start_;
    goal_[0] -= 1.4;
  }
  // Expects every configuration of the path to keep the clearance, by the engine's contacts.
  void ExpectFree(const MotionResult& result, double clearance) {
    CollisionFilter filter(robot_, {.clearance = clearance});
    for (size_t k = 1; k < result.path.size(); ++k) {
      for (int i = 0; i <= 100; ++i) {
        std::vector<double> q;
        for (size_t j = 0; j < start_.size(); ++j) {
          q.push_back(result.path[k - 1][j] +
                      i / 100.0 * (result.path[k][j] - result.path[k - 1][j]));
        }
        EXPECT_TRUE(filter.IsFree(q)) << "waypoint " << k << ", " << i << " %";
      }
    }
  }

  Scene scene_ = Scene::Build(Spec());
  Robot robot_ = Robot::Of(scene_, "rc7");
  std::vector<double> start_, goal_;
};

TEST_F(MotionPlannerOfRc7, FindsAWayAroundAWall) {
  MotionPlanner planner(robot_, {.clearance = 0.005});
  for (uint64_t seed = 0; seed < 5; ++seed) {
    const MotionResult result = planner.Plan({MotionGoal::Joints(goal_)}, {.seed = seed});
    ASSERT_TRUE(result.success) << result.message;
    EXPECT_EQ(result.path.front(), start_);
    EXPECT_EQ(result.path.back(), goal_);
    EXPECT_EQ(result.goal, 0);
    EXPECT_GT(result.path.size(), 2u);
    EXPECT_GT(result.configurations, 100);
    ExpectFree(result, 0.0045);
  }
}

TEST_F(MotionPlannerOfRc7, SameSeedSamePath) {
  MotionPlanner planner(robot_);
  const MotionResult first = planner.Plan({MotionGoal::Joints(goal_)}, {.seed = 3});
  EXPECT_EQ(planner.Plan({MotionGoal::Joints(goal_)}, {.seed = 3}).path, first.path);
  const std::vector<MotionGoal> goals = {MotionGoal::Joints(goal_)};
  EXPECT_EQ(Plan(robot_, goals, {}, {.seed = 3}).path, first.path);
  EXPECT_NE(planner.Plan({MotionGoal::Joints(goal_)}, {.seed = 4}).path, first.path);
}

TEST_F(MotionPlannerOfRc7, SamePathOnEveryInstructionSet) {
  MotionPlanner planner(robot_);
  std::vector<std::vector<double>> expected;
  OnEveryInstructionSet([&](const std::string& name) {
    const MotionResult result = planner.Plan({MotionGoal::Joints(goal_)}, {.seed = 5});
    ASSERT_TRUE(result.success) << result.message;
    if (expected.empty()) expected = result.path;
    EXPECT_EQ(result.path, expected) << name;
  });
}

TEST_F(MotionPlannerOfRc7, ReachesThePoseOfTheTcp) {
  robot_.SetJointPos(goal_);
  const Pose there = robot_.tcp_in_world();
  robot_.SetJointPos(start_);
  MotionPlanner planner(robot_);
  const MotionResult result = planner.Plan({MotionGoal::Tcp(there)});
  ASSERT_TRUE(result.success) << result.message;
  robot_.SetJointPos(result.path.back());
  EXPECT_TRUE(robot_.tcp_in_world().is_close(there, 1e-4, 1e-4));
}

TEST_F(MotionPlannerOfRc7, ReachesARegionWithFreeAxes) {
  robot_.SetJointPos(goal_);
  const Pose there = robot_.tcp_in_world();
  robot_.SetJointPos(start_);
  MotionGoal goal = MotionGoal::Tcp(there);
  goal.position_box = {0.03, 0.03, 0};
  goal.free_rotation = {0, 0, std::numbers::pi};
  MotionPlanner planner(robot_);
  for (uint64_t seed = 0; seed < 5; ++seed) {
    const MotionResult result = planner.Plan({goal}, {.seed = seed});
    ASSERT_TRUE(result.success) << result.message;
    robot_.SetJointPos(result.path.back());
    const Pose error = there.inverse() * robot_.tcp_in_world();
    robot_.SetJointPos(start_);
    EXPECT_LT(error.translation().cwiseAbs().head<2>().maxCoeff(), 0.0301);
    EXPECT_NEAR(error.translation().z(), 0, 1e-4);
    EXPECT_NEAR(error.rotation()(2, 2), 1, 1e-6);
  }
}

TEST_F(MotionPlannerOfRc7, TakesAnyOfItsGoals) {
  std::vector<double> near = start_;
  near[0] += 0.2;
  MotionGoal out_of_reach = MotionGoal::Tcp(Pose(Eigen::Vector3d(5, 0, 0)));
  MotionPlanner planner(robot_);
  const MotionResult result =
      planner.Plan({out_of_reach, MotionGoal::Joints(goal_), MotionGoal::Joints(near)});
  ASSERT_TRUE(result.success) << result.message;
  EXPECT_EQ(result.goal, 2);
  EXPECT_EQ(result.path.size(), 2u);
}

TEST_F(MotionPlannerOfRc7, SaysWhatTheStartCollidesWith) {
  scene_.SetBodyPose("cube", robot_.tcp_in_world() * Pose(Eigen::Vector3d(0, 0, -0.08)));
  MotionPlanner planner(robot_);
  const MotionResult result = planner.Plan({MotionGoal::Joints(goal_)});
  EXPECT_FALSE(result.success);
  EXPECT_EQ(result.failure, MotionFailure::kStartInCollision);
  EXPECT_EQ(ToString(result.failure), "start_in_collision");
  EXPECT_NE(result.message.find("'cube'"), std::string::npos) << result.message;
  MotionPlanner allowing(robot_, {.allowed_contacts = {{"cube", ""}}});
  EXPECT_TRUE(allowing.Plan({MotionGoal::Joints(goal_)}).success);
}

TEST_F(MotionPlannerOfRc7, SaysWhichJointStartsBeyondItsLimits) {
  MotionPlanner planner(robot_);
  std::vector<double> start = start_;
  start[1] = planner.joint_limits()[1].upper + 0.1;
  const MotionGoal goals[] = {MotionGoal::Joints(goal_)};
  const MotionResult result = planner.PlanFrom(start, goals);
  EXPECT_EQ(result.failure, MotionFailure::kStartBeyondLimits);
  EXPECT_NE(result.message.find(planner.joint_names()[1]), std::string::npos) << result.message;
}

TEST_F(MotionPlannerOfRc7, SaysWhyNoGoalCanBeReached) {
  MotionPlanner planner(robot_);
  MotionResult result = planner.Plan({MotionGoal::Tcp(Pose(Eigen::Vector3d(5, 0, 0)))});
  EXPECT_EQ(result.failure, MotionFailure::kGoalUnreachable);
  EXPECT_NE(result.message.find("goal 0: arm 'arm' cannot reach its pose"), std::string::npos)
      << result.message;
  std::vector<double> beyond = goal_;
  beyond[1] = planner.joint_limits()[1].upper + 0.1;
  result = planner.Plan({MotionGoal::Joints(beyond)});
  EXPECT_EQ(result.failure, MotionFailure::kGoalUnreachable);
  EXPECT_NE(result.message.find("beyond its limits"), std::string::npos) << result.message;

  robot_.SetJointPos(goal_);
  scene_.SetBodyPose("cube", robot_.tcp_in_world() * Pose(Eigen::Vector3d(0, 0, -0.08)));
  robot_.SetJointPos(start_);
  result = planner.Plan({MotionGoal::Joints(goal_)});
  EXPECT_EQ(result.failure, MotionFailure::kGoalInCollision);
  EXPECT_NE(result.message.find("'cube'"), std::string::npos) << result.message;
}

TEST_F(MotionPlannerOfRc7, SaysWhetherMoreIterationsMayHelp) {
  MotionPlanner planner(robot_);
  const MotionResult result = planner.Plan({MotionGoal::Joints(goal_)}, {.iterations = 0});
  EXPECT_EQ(result.failure, MotionFailure::kNoPath);
  EXPECT_NE(result.message.find("no path to a goal found in 0 iterations"), std::string::npos);
  EXPECT_EQ(planner.Plan({MotionGoal::Joints(goal_)}, {.deadline = 0.0}).failure,
            MotionFailure::kNoPath);
}

TEST_F(MotionPlannerOfRc7, RethrowsTheExceptionOfAPoll) {
  MotionPlanner planner(robot_);
  const auto stop = [] { throw Error("stop"); };
  ExpectThrow<Error>([&] { planner.Plan({MotionGoal::Joints(goal_)}, {.poll = stop}); }, "stop");
}

TEST_F(MotionPlannerOfRc7, KeepsAnAxisUpright) {
  // Of the TCP's axes the one that points most upwards at the start.
  const Eigen::Matrix3d tcp = robot_.tcp_in_world().rotation();
  const Eigen::Vector3d up = tcp.transpose() * Eigen::Vector3d::UnitZ();
  MotionPlanner planner(robot_, {.keep_axis = AxisConstraint{.axis_in_tcp = up, .tolerance = 0.2}});
  const MotionResult result = planner.Plan({MotionGoal::Joints(goal_)}, {.seed = 1});
  ASSERT_TRUE(result.success) << result.message;
  for (size_t k = 1; k < result.path.size(); ++k) {
    for (int i = 0; i <= 20; ++i) {
      std::vector<double> q;
      for (size_t j = 0; j < start_.size(); ++j)
        q.push_back(result.path[k - 1][j] + i / 20.0 * (result.path[k][j] - result.path[k - 1][j]));
      const Eigen::Vector3d now = (robot_.base_in_world() * robot_.FkFrame(q)).rotation() * up;
      EXPECT_LT(std::acos(std::min(1.0, now.z())), 0.201);
    }
  }
  std::vector<double> tilted = goal_;
  tilted[5] -= 0.4;
  EXPECT_EQ(planner.Plan({MotionGoal::Joints(tilted)}).failure,
            MotionFailure::kGoalAgainstConstraint);
}

TEST_F(MotionPlannerOfRc7, FollowsAStraightLineOrSaysWhatIsInTheWay) {
  MotionPlanner planner(robot_);
  planner.Update();
  const Pose from = robot_.tcp_in_world();
  const Pose up(from.translation() + Eigen::Vector3d(0, 0, 0.1), from.quaternion());
  const MotionResult line = planner.PlanLine(start_, up);
  ASSERT_TRUE(line.success) << line.message;
  for (const std::vector<double>& q : line.path) {
    const Pose at = robot_.base_in_world() * robot_.FkFrame(q);
    EXPECT_NEAR(at.translation().x(), from.translation().x(), 1e-4);
    EXPECT_NEAR(at.translation().y(), from.translation().y(), 1e-4);
  }
  const Pose mirrored(Eigen::Vector3d(from.translation().x(), -from.translation().y(), 0.2),
                      from.quaternion());
  const MotionResult blocked = planner.PlanLine(start_, mirrored);
  EXPECT_FALSE(blocked.success);
  EXPECT_GT(blocked.path.size(), 1u);
  const MotionResult too_far =
      planner.PlanLine(start_, Pose(Eigen::Vector3d(0, 0, 5), from.quaternion()));
  EXPECT_EQ(too_far.failure, MotionFailure::kGoalUnreachable);
}

TEST_F(MotionPlannerOfRc7, RejectsWhatDoesNotFit) {
  MotionPlanner planner(robot_);
  ExpectThrow<ArgumentError>([&] { planner.Plan({}); }, "there is no goal");
  ExpectThrow<ArgumentError>(
      [&] {
        planner.Plan({MotionGoal::Joints({1, 2})});
      },
      "goal 0 has 2 joint values, expected 7");
  ExpectThrow<NotFoundError>([&] { MotionPlanner(robot_, {.groups = {"leg"}}); }, "leg");
  ExpectThrow<ArgumentError>([&] { MotionPlanner(robot_, {.clearance = -1}); }, "clearance");
  MotionGoal other = MotionGoal::Tcp(Pose());
  other.arm = "right";
  ExpectThrow<NotFoundError>([&] { planner.Plan({other}); }, "Planned arms: 'arm'");
}

TEST(MotionPlannerOfABase, MovesAPlanarBaseAndItsArmTogether) {
  RobotConfig config = Rc7();
  config.base.kind = BaseKind::kPlanar;
  SceneSpec spec = SceneWith({.name = "rc7", .config = config});
  spec.objects.push_back(Wall("pillar", {0.1, 0.4, 0.6}, {1, 0, 0.6}));
  Scene scene = Scene::Build(spec);
  scene.Reset();
  Robot robot = Robot::Of(scene, "rc7");
  const Pose start = robot.tcp_in_world();
  const Pose there(start.translation() + Eigen::Vector3d(2, 0, -0.1), start.quaternion());
  MotionPlanner arm_alone(robot);
  EXPECT_EQ(arm_alone.Plan({MotionGoal::Tcp(there)}).failure, MotionFailure::kGoalUnreachable);
  MotionPlanner planner(robot, {.groups = {"base", "arm"}, .clearance = 0.01});
  EXPECT_EQ(planner.joint_names().size(), 10u);
  const MotionResult result = planner.Plan({MotionGoal::Tcp(there)}, {.seed = 1});
  ASSERT_TRUE(result.success) << result.message;
  EXPECT_GT(result.path.size(), 2u);  // around the pillar
  for (const std::vector<double>& q : result.path) EXPECT_TRUE(planner.IsFree(q));
  const std::span<const double> reached(result.path.back());
  robot.base().SetJointPos(reached.first(3));
  robot.SetJointPos(reached.subspan(3));
  EXPECT_TRUE(robot.tcp_in_world().is_close(there, 1e-4, 1e-4));
}

// Two arms of three joints, whose hands are in each other's way.
constexpr const char* kTwoArms = R"(<compiler angle="radian"/>
  <default><joint axis="0 0 1" range="-2.9 2.9" damping="1"/>
    <geom type="capsule" size=".03" mass=".5"/></default>
  <worldbody><body name="base">
    <body name="la" pos="0 .2 .3"><joint name="l1"/><geom fromto="0 0 0 .25 0 0"/>
      <body name="lb" pos=".25 0 0"><joint name="l2"/><geom fromto="0 0 0 .25 0 0"/>
        <body name="lc" pos=".25 0 0"><joint name="l3"/><geom fromto="0 0 0 .1 0 0"/>
          <site name="lt" pos=".1 0 0"/></body></body></body>
    <body name="ra" pos="0 -.2 .3"><joint name="r1"/><geom fromto="0 0 0 .25 0 0"/>
      <body name="rb" pos=".25 0 0"><joint name="r2"/><geom fromto="0 0 0 .25 0 0"/>
        <body name="rc" pos=".25 0 0"><joint name="r3"/><geom fromto="0 0 0 .1 0 0"/>
          <site name="rt" pos=".1 0 0"/></body></body></body>
  </body></worldbody>)";

TEST(MotionPlannerOfTwoArms, MovesBothPastEachOther) {
  ModelFolder folder;
  const RobotConfig config = ParseYaml<RobotConfig>(
      "name: two\nmodel: " + folder.Write("two", kTwoArms) +
          "\nroot_body: base\nmove_groups:\n"
          "  left: {kind: arm, joints: l1..l3, leaf: {site: lt}}\n"
          "  right: {kind: arm, joints: r1..r3, leaf: {site: rt}}\ngravcomp: true\n",
      "two.yaml");
  const Robot robot = RobotAlone(config);
  MotionPlanner planner(robot, {.groups = {"left", "right"}});
  // Each hand is on the other's side afterwards, so that straight motions cross.
  const std::vector<double> start = {0.7, -0.5, 0, -0.7, 0.5, 0};
  const std::vector<double> goal = {-0.9, 0.3, 0, -1.6, -0.8, 0};
  ASSERT_TRUE(planner.IsFree(start));
  ASSERT_TRUE(planner.IsFree(goal));
  const MotionGoal goals[] = {MotionGoal::Joints(goal)};
  for (uint64_t seed = 0; seed < 3; ++seed) {
    const MotionResult result = planner.PlanFrom(start, goals, {.seed = seed});
    ASSERT_TRUE(result.success) << result.message;
    for (size_t k = 1; k < result.path.size(); ++k) {
      for (int i = 0; i <= 40; ++i) {
        std::vector<double> q = result.path[k];
        for (size_t j = 0; j < q.size(); ++j)
          q[j] = result.path[k - 1][j] + i / 40.0 * (q[j] - result.path[k - 1][j]);
        EXPECT_GT(planner.Clearance(q, 0.01), -1e-4);
      }
    }
  }
  // A pose for one arm leaves the other where it is.
  MotionGoal right = MotionGoal::Tcp(robot.group("right").leaf_frame_to_world());
  right.tcp = Pose(Eigen::Vector3d(0.3, -0.3, 0.3));
  right.free_rotation = {0, 0, std::numbers::pi};
  right.arm = "right";
  const MotionGoal rights[] = {right};
  const MotionResult result = planner.PlanFrom(start, rights);
  ASSERT_TRUE(result.success) << result.message;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(result.path.back()[i], start[i]);
}

}  // namespace
}  // namespace robocell
