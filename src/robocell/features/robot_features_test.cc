#include "robocell/features/robot_features.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/robot/joint_group.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

// A custom group with a coordinate that is not a joint of the model.
class Belt : public JointGroup {
 public:
  explicit Belt(const Scene& scene)
      : JointGroup(scene,
                   {.robot = "rc7",
                    .group = "belt",
                    .joints = {"joint1"},
                    .root = {false, "link1"},
                    .leaf = {false, "link1"},
                    .robot_base = {false, "base_link"}},
                   MoveGroupKind::kGeneric) {}
  const std::vector<std::string>& joint_names() const override { return names_; }

 private:
  std::vector<std::string> names_ = {"travel"};
};

const Feature& Named(const std::vector<Feature>& features, const std::string& name) {
  for (const Feature& feature : features) {
    if (feature.column.name == name) return feature;
  }
  throw Error("no feature " + name);
}

FeatureSchema SchemaOf(const RobotFeatures& features) {
  FeatureSchema schema;
  for (const Feature& feature : features.features()) schema.Add(feature);
  return schema;
}

TEST(RobotFeatures, UnitsAreThoseOfTheJoints) {
  const RobotFeatures features(RobotAlone(Rc7()));
  const auto unit = [&](const std::string& name) {
    return Named(features.features(), "robots/rc7/" + name).column.units;
  };
  EXPECT_EQ(unit("arm/qpos"), "rad");
  EXPECT_EQ(unit("arm/qvel"), "rad/s");
  EXPECT_EQ(unit("gripper/qpos"), "m");
  EXPECT_EQ(unit("gripper/qvel"), "m/s");
}

TEST(RobotFeatures, NamesAreThoseOfTheRobotsOwnModelInEveryScene) {
  const RobotFeatures alone(RobotAlone(Rc7()));
  const Scene scene = Scene::Build(SceneWith({.name = "rc7", .config = Rc7(), .prefix = "left/"}));
  const Robot robot = Robot::Of(scene, "rc7");
  ASSERT_EQ(robot.arm().joint_names().front(), "left/joint1");
  const RobotFeatures prefixed(robot);
  EXPECT_EQ(SchemaOf(prefixed).DifferenceFrom(SchemaOf(alone)), "");
  EXPECT_EQ(Named(prefixed.features(), "robots/rc7/arm/qpos").column.names.front(), "joint1");
  RobotActions actions(robot);
  EXPECT_EQ(Named(actions.features(), "robots/rc7/action/arm").column.names.front(), "joint1");
}

TEST(RobotFeatures, RangesAreATenthWiderThanThoseOfTheJoints) {
  const Robot robot = RobotAlone(Rc7());
  const RobotFeatures features(robot);
  const Feature& qpos = Named(features.features(), "robots/rc7/arm/qpos");
  const std::vector<Interval> limits = robot.arm().joint_pos_limits();
  ASSERT_EQ(qpos.lower.size(), limits.size());
  for (size_t i = 0; i < limits.size(); ++i) {
    const double slack = 0.1 * (limits[i].upper - limits[i].lower);
    EXPECT_DOUBLE_EQ(qpos.lower[i], limits[i].lower - slack);
    EXPECT_DOUBLE_EQ(qpos.upper[i], limits[i].upper + slack);
  }
  EXPECT_EQ(Named(features.features(), "robots/rc7/opening").upper, std::vector<double>{1.1});
  EXPECT_TRUE(Named(features.features(), "robots/rc7/arm/qvel").lower.empty());
}

TEST(RobotFeatures, OtherCoordinatesHaveNoUnits) {
  Robot robot = RobotAlone(Rc7());
  robot.SetGroup(std::make_shared<Belt>(robot.scene()));
  const RobotFeatures features(robot);
  EXPECT_EQ(Named(features.features(), "robots/rc7/belt/qpos").column.units, "");
  EXPECT_EQ(Named(features.features(), "robots/rc7/belt/qvel").column.units, "");
}

TEST(RobotFeatures, ReadTheStateOfTheRobot) {
  Robot robot = RobotAlone(Rc7());
  robot.SetJointPos(std::vector<double>{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7});
  RobotFeatures features(robot);
  std::vector<double> numbers(static_cast<size_t>(features.size()));
  features.Read(numbers);
  size_t at = 0;
  std::map<std::string, std::vector<double>> read;
  for (const Feature& feature : features.features()) {
    const auto size = static_cast<size_t>(feature.size());
    read[feature.column.name] = {numbers.begin() + static_cast<std::ptrdiff_t>(at),
                                 numbers.begin() + static_cast<std::ptrdiff_t>(at + size)};
    at += size;
  }
  EXPECT_EQ(at, numbers.size());
  EXPECT_EQ(read["robots/rc7/arm/qpos"], robot.arm().joint_pos());
  EXPECT_EQ(read["robots/rc7/opening"][0], robot.gripper().opening());
  std::vector<double> pose(kPoseNumbers);
  PutPose(robot.tcp_in_world(), pose);
  EXPECT_EQ(read["robots/rc7/tcp_pose"], pose);
  PutPose(robot.FkFrame(robot.arm().joint_pos()), pose);
  for (int i = 0; i < kPoseNumbers; ++i)
    EXPECT_NEAR(read["robots/rc7/tcp_pose_in_base"][i], pose[i], 1e-12);
}

TEST(RobotFeatures, RejectAGroupThatChangesDuringTheEpisode) {
  Robot robot = RobotAlone(Rc7());
  robot.SetGroup(std::make_shared<Belt>(robot.scene()));
  RobotFeatures features(robot);
  std::vector<double> numbers(static_cast<size_t>(features.size()));
  features.Read(numbers);
  robot.SetGroup(std::make_shared<Belt>(robot.scene()));
  ExpectThrow<Error>([&] { features.Read(numbers); },
                     "robot 'rc7' / group 'belt' was replaced during the episode, whose columns "
                     "were laid out at its start; change groups before, in the sampler or in the "
                     "begin() of the expert");
}

TEST(RobotFeatures, RejectAGroupAddedDuringTheEpisode) {
  Robot robot = RobotAlone(Rc7());
  RobotFeatures features(robot);
  std::vector<double> numbers(static_cast<size_t>(features.size()));
  robot.SetGroup(std::make_shared<Belt>(robot.scene()));
  ExpectThrow<Error>([&] { features.Read(numbers); }, "group 'belt' was added during the episode");
}

// An action is stored in every form. Each form moves the robot to the same targets.
TEST(RobotActions, EveryFormOfAnActionGivesTheSameTargets) {
  Robot robot = RobotAlone(Rc7());
  const std::vector<double> home = robot.arm().joint_pos();
  std::vector<double> goal = home;
  for (size_t i = 0; i < goal.size(); ++i) goal[i] += 0.02 * (i % 2 ? 1 : -1);
  RobotActions actions(robot);
  actions.Begin();
  ASSERT_TRUE(
      robot.Apply({{"arm", GroupCommand::Joints(goal)}, {"gripper", GroupCommand::Opening(0.4)}})
          .ok);
  size_t size = 0;
  for (const Feature& feature : actions.features()) size += static_cast<size_t>(feature.size());
  std::vector<double> numbers(size);
  actions.Read(numbers);
  std::map<std::string, std::vector<double>> stored;
  std::span<const double> rest = numbers;
  for (const Feature& feature : actions.features()) {
    const auto part = rest.first(static_cast<size_t>(feature.size()));
    stored[feature.column.name] = {part.begin(), part.end()};
    rest = rest.subspan(part.size());
  }
  EXPECT_EQ(stored["robots/rc7/action/arm"], goal);
  EXPECT_EQ(stored["robots/rc7/action/gripper"], std::vector<double>{0.4});
  for (const char* form : {"arm", "arm_relative", "tcp_pose", "tcp_displacement"}) {
    ASSERT_TRUE(robot.Apply({{"arm", GroupCommand::Joints(home)}}).ok);
    const std::string name = std::string("robots/rc7/action/") + form;
    ASSERT_TRUE(actions.Has(name));
    const auto [group, command] = actions.Command(name, stored[name]);
    EXPECT_EQ(group, "arm");
    ASSERT_TRUE(robot.Apply({{group, command}}).ok) << form;
    const std::span<const double> target = robot.controller("arm").commanded_joint_pos();
    const Pose wanted = robot.FkFrame(goal), there = robot.FkFrame(target);
    EXPECT_TRUE(there.is_close(wanted, 2e-3, 1e-3)) << form;
    if (std::string(form).starts_with("arm")) {
      for (size_t i = 0; i < goal.size(); ++i) EXPECT_NEAR(target[i], goal[i], 1e-12) << form;
    }
  }
}

TEST(RobotActions, RejectInvalidActions) {
  const RobotActions actions(RobotAlone(Rc7()));
  const std::vector<double> few = {1, 2}, bad = {std::nan("")};
  ExpectThrow<NotFoundError>([&] { actions.Command("robots/rc7/action/amr", few); },
                             "Did you mean 'robots/rc7/action/arm'?");
  ExpectThrow<ArgumentError>([&] { actions.Command("robots/rc7/action/arm", few); },
                             "action 'robots/rc7/action/arm' has 7 numbers, got 2");
  ExpectThrow<ArgumentError>([&] { actions.Command("robots/rc7/action/gripper", bad); },
                             "is not finite");
  const std::vector<double> no_turn(7, 0);
  ExpectThrow<ArgumentError>([&] { actions.Command("robots/rc7/action/tcp_pose", no_turn); },
                             "action 'robots/rc7/action/tcp_pose': quaternion");
}

}  // namespace
}  // namespace robocell
