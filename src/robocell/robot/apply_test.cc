// Tests commands: their effect on targets, and rejected ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"
#include "robocell/kinematics/ik_step.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/random_values.h"

namespace robocell {
namespace {

class Apply : public ::testing::Test {
 protected:
  std::vector<double> Target() {
    const auto target = robot.controller("arm").commanded_joint_pos();
    return {target.begin(), target.end()};
  }
  double Opening() { return robot.controller("gripper").target()[0]; }
  void Refuses(const RobotAction& action, const std::string& text) {
    const std::vector<double> before = Target();
    const double opening = Opening();
    ExpectThrow<ArgumentError>([&] { robot.Apply(action); }, text);
    EXPECT_EQ(Target(), before);
    EXPECT_EQ(Opening(), opening);
  }

  Robot robot = RobotAlone(Rc7());
  const std::vector<double> home = Rc7().home.at("arm");
};

TEST_F(Apply, SetsAbsoluteJointsOfOneGroupOnly) {
  const std::vector<double> q{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7};
  EXPECT_TRUE(robot.Apply({{"arm", GroupCommand::Joints(q)}}).ok);
  EXPECT_EQ(Target(), q);
  EXPECT_DOUBLE_EQ(Opening(), 1);
  EXPECT_TRUE(robot.Apply({{"gripper", GroupCommand::Opening(0.25)}}).ok);
  EXPECT_EQ(Target(), q);
  EXPECT_EQ(Opening(), 0.25);
  EXPECT_TRUE(robot.Apply({}).ok);
}

TEST_F(Apply, AddsRelativeJointsToTheTargetWithinLimits) {
  const GroupCommand turn = GroupCommand::RelativeJoints({0.25, 0, 0, 0, 0, 0, 0});
  for (int i = 0; i < 4; ++i) robot.Apply({{"arm", turn}});
  EXPECT_EQ(Target()[0], home[0] + 1) << "on the target, wherever the arm is";
  for (int i = 0; i < 20; ++i) robot.Apply({{"arm", turn}});
  EXPECT_EQ(Target()[0], 2.9);
}

TEST_F(Apply, WorksAlikeWithARelativeController) {
  robot.SetController("arm", "relative_joint_position");
  const std::vector<double> q{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7};
  robot.Apply({{"arm", GroupCommand::Joints(q)}});
  for (int i = 0; i < 7; ++i) EXPECT_NEAR(Target()[i], q[i], 1e-15);
  robot.Apply({{"arm", GroupCommand::RelativeJoints({0.25, 0, 0, 0, 0, 0, 0})}});
  EXPECT_NEAR(Target()[0], 0.35, 1e-15);
  const Pose pose = robot.FkFrame(home);
  robot.Apply({{"arm", GroupCommand::LeafPose(pose)}});
  EXPECT_TRUE(robot.FkFrame(Target()).is_close(pose, 1e-5, 1e-5));
}

TEST_F(Apply, ReachesPosesThroughIk) {
  const Pose up(Eigen::Vector3d(0, 0, 0.05));
  const Pose pose = up * robot.FkFrame();
  const Robot::ApplyResult result = robot.Apply({{"arm", GroupCommand::LeafPose(pose)}});
  EXPECT_TRUE(result.ok);
  EXPECT_TRUE(robot.FkFrame(Target()).is_close(pose, 1e-5, 1e-5));
  for (int i = 0; i < 1000; ++i) {
    robot.Update();
    EXPECT_TRUE(robot.Step().ok());
  }
  EXPECT_TRUE(robot.arm().leaf_frame_to_robot().is_close(pose, 1e-4, 1e-4));
}

double LargestDifference(std::span<const double> a, std::span<const double> b) {
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

// Moves by centimetres at a time, wherever that leads.
TEST_F(Apply, SmallPoseStepsAreSmallJointSteps) {
  constexpr int kSteps = 4000;
  Rng rng = Rng::Stream(1, "random walk");
  Eigen::Vector3d displacement;
  const auto step = [&](int i, const Pose& from) {
    if (i % 5 == 0) displacement = 0.02 * RandomVector(rng).normalized();
    return Pose(from.translation() + displacement, from.quaternion());
  };
  // The first solution may have the elbow or the wrist on the other side.
  JointVector any(home);
  double swing = 0;
  int unsolved = 0;
  for (int i = 0; i < kSteps; ++i) {
    const IkResult found = robot.Ik(step(i, robot.FkFrame(any)), {.seed = any});
    if (!found.success) {
      ++unsolved;
      continue;
    }
    swing = std::max(swing, LargestDifference(found.q, any));
    any = found.q;
  }
  EXPECT_GT(swing, 2) << "the walk comes to no place where the bound matters";

  int failed = 0;
  double largest = 0;
  for (int i = 0; i < kSteps; ++i) {
    const std::vector<double> before = Target();
    const Pose next = step(i, robot.FkFrame(before));
    if (!robot.Apply({{"arm", GroupCommand::LeafPose(next)}}).ok) {
      ++failed;
      EXPECT_EQ(Target(), before);
      continue;
    }
    largest = std::max(largest, LargestDifference(Target(), before));
    EXPECT_TRUE(robot.FkFrame(Target()).is_close(next, 1e-5, 1e-5));
  }
  EXPECT_LE(largest, internal::kLeastJointStep +
                         0.02 / robot.chain().model().length * internal::kJointStepGain + 1e-9);
  EXPECT_LT(failed, 1.5 * unsolved) << "few poses that the arm reaches are out of its reach now";
  RecordProperty("failed", failed);
  RecordProperty("unsolved", unsolved);
}

TEST_F(Apply, ReportsAPoseOutOfReachAndKeepsThatTarget) {
  const GroupCommand far = GroupCommand::LeafPose(Pose(Eigen::Vector3d(5, 0, 0)));
  const Robot::ApplyResult result =
      robot.Apply({{"arm", far}, {"gripper", GroupCommand::Opening(0)}});
  EXPECT_FALSE(result.ok);
  EXPECT_EQ(result.failed_group, "arm");
  EXPECT_FALSE(result.ik.success);
  EXPECT_GT(result.ik.position_error, 3);
  EXPECT_EQ(Target(), home);
  EXPECT_EQ(Opening(), 0) << "the other groups are commanded";
}

TEST_F(Apply, RejectsInvalidCommandsWithoutAChange) {
  const std::string arm = "scene 'test' / robot 'rc7' / group 'arm'";
  const std::string gripper = "scene 'test' / robot 'rc7' / group 'gripper'";
  Refuses({{"arm", GroupCommand::Joints({1, 2, 3})}}, arm + ": expected 7 joint values, got 3");
  std::vector<double> q = home;
  q[4] = std::nan("");
  Refuses({{"arm", GroupCommand::Joints(q)}},
          arm + ": the target of 'joint5' is nan; targets must be finite");
  Refuses({{"arm", GroupCommand::RelativeJoints(q)}}, "the target of 'joint5' is nan");
  Refuses({{"arm", GroupCommand::Opening(1)}},
          arm + " is not a gripper: command it with joints or a pose");
  Refuses({{"gripper", GroupCommand::Joints({0, 0})}},
          gripper + " is a gripper: command it with an opening");
  Refuses({{"arm", GroupCommand::Joints(std::vector<double>(7, 0.1))},
           {"gripper", GroupCommand::Opening(std::nan(""))}},
          gripper + ": the target of 'opening' is nan");
  GroupCommand two = GroupCommand::Opening(1);
  two.values.push_back(1);
  Refuses({{"gripper", two}}, gripper + ": expected 1 opening value, got 2");
}

TEST_F(Apply, NamesTheGroupsWhenOneIsUnknown) {
  ExpectThrow<NotFoundError>(
      [&] {
        robot.Apply({{"am", GroupCommand::Joints(home)}});
      },
      "scene 'test' / robot 'rc7': no group 'am'. Its groups: arm, gripper, base. Did you mean "
      "'arm'?");
  ExpectThrow<NotFoundError>(
      [&] {
        robot.Apply({{"base", GroupCommand::Joints({})}});
      },
      "group 'base' has no controller: it has no actuators. With `base: {kind: driven}` it moves "
      "to "
      "the poses that are commanded");
}

// Two arms of one robot, each with its own leaf.
TEST(ApplyToTwoArms, SolvesEachPoseWithItsOwnChain) {
  ModelFolder folder;
  const std::string arm = R"(<body name="N_upper" pos="0 Y 0.1"><joint name="N_1"/><geom/>
    <body pos="0 0 0.3"><joint name="N_2"/><geom/><site name="N_tip" pos="0 0 0.2"/></body></body>)";
  std::string bodies, actuators;
  RobotConfig config{.name = "twin"};
  for (const char* side : {"l", "r"}) {
    std::string one = arm;
    for (size_t at; (at = one.find("N_")) != std::string::npos;) one.replace(at, 1, side);
    one.replace(one.find("Y"), 1, side[0] == 'l' ? "0.2" : "-0.2");
    bodies += one;
    const std::string name = side;
    for (const char* n : {"_1", "_2"}) {
      actuators += "<position name='" + name + n + "' joint='" + name + n + "' kp='100' kv='10'/>";
    }
    config.move_groups[name] = {.kind = MoveGroupKind::kArm,
                                .joints = {name + "_1", name + "_2"},
                                .leaf = ElementRef{.name = name + "_tip"}};
  }
  config.model = folder.Write("twin", R"(<compiler autolimits="true"/><default>
      <joint axis="0 1 0" range="-100 100"/><geom size="0.02" mass="1" contype="0" conaffinity="0"/>
      </default><worldbody><body name="trunk"><geom size="0.1"/>)" +
                                          bodies + "</body></worldbody><actuator>" + actuators +
                                          "</actuator>");
  Robot robot = RobotAlone(config);
  for (const char* side : {"l", "r"}) {
    const Pose pose = robot.chain(side).Fk(std::vector<double>{0.4, 0.6});
    EXPECT_TRUE(robot.Apply({{side, GroupCommand::LeafPose(pose)}}).ok) << side;
    const auto q = robot.controller(side).commanded_joint_pos();
    EXPECT_TRUE(robot.chain(side).Fk(q).is_close(pose, 1e-5, 1e-5)) << side;
  }
}

}  // namespace
}  // namespace robocell
