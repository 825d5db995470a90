// Tests a user's own groups and controllers.
#include "robocell/robot/move_group.h"

#include <gtest/gtest.h>

#include <functional>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/robot/joint_group.h"
#include "robocell/robot/joint_position_controller.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/robot/testing/wrist.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

GroupNames ArmNames() {
  GroupNames names = WristNames();
  names.group = "arm";
  names.root = names.robot_base;
  names.joints.clear();
  names.actuators.clear();
  for (int i = 1; i <= 7; ++i) {
    names.joints.push_back("joint" + std::to_string(i));
    names.actuators.push_back("servo" + std::to_string(i));
  }
  return names;
}

// A group that counts its commands.
class CountingGroup : public JointGroup {
 public:
  CountingGroup(const Scene& scene, GroupNames names, int* commands)
      : JointGroup(scene, std::move(names), MoveGroupKind::kGeneric), commands_(commands) {}
  void SetCtrl(std::span<const double> ctrl) override {
    ++*commands_;
    JointGroup::SetCtrl(ctrl);
  }

 private:
  int* commands_;
};

TEST(OwnGroup, IsDrivenLikeConfiguredGroups) {
  Robot robot = RobotAlone(Rc7());
  int commands = 0;
  robot.SetGroup(std::make_unique<CountingGroup>(robot.scene(), WristNames(), &commands));
  EXPECT_EQ(robot.group_names().size(), 4u);
  EXPECT_EQ(robot.controller("wrist").kind(), "joint_position");
  const std::vector<double> q = robot.group("wrist").joint_pos();
  // The arm's controller would hold joint6 and joint7: it is replaced last.
  robot.Apply({{"wrist", GroupCommand::Joints({q[0] + 0.1, q[1]})},
               {"arm", GroupCommand::RelativeJoints({0, 0, 0, 0, 0, 0.1, 0})}});
  for (int i = 0; i < 500; ++i) {
    robot.Update();
    EXPECT_TRUE(robot.Step().ok());
  }
  EXPECT_EQ(commands, 500);
  EXPECT_NEAR(robot.group("wrist").joint_pos()[0], q[0] + 0.1, 1e-6);
  EXPECT_TRUE(robot.group("wrist").leaf_frame_to_root().is_close(
      robot.scene().body_pose("link5").inverse() * robot.tcp_in_world(), 1e-12, 1e-12));
}

TEST(OwnGroup, ReplacingTheArmKeepsItsKinematics) {
  Robot robot = RobotAlone(Rc7());
  const std::shared_ptr<MoveGroup> arm = robot.shared_group("arm");
  const FrameName base{false, "base_link"};
  GroupNames names{.robot = "rc7",
                   .group = "arm",
                   .joints = arm->joint_names(),
                   .actuators = arm->actuator_names(),
                   .root = base,
                   .leaf = {true, "tcp"},
                   .robot_base = base};
  robot.SetGroup(std::make_unique<JointGroup>(robot.scene(), names, MoveGroupKind::kArm));
  EXPECT_EQ(robot.group_names().size(), 3u);
  EXPECT_EQ(&robot.arm(), &robot.group("arm"));
  EXPECT_TRUE(robot.FkFrame().is_close(robot.arm().leaf_frame_to_robot(), 1e-12, 1e-12));
  EXPECT_TRUE(robot.Apply({{"arm", GroupCommand::LeafPose(robot.FkFrame())}}).ok);

  names.joints.pop_back();
  names.actuators.pop_back();
  robot.SetGroup(std::make_unique<JointGroup>(robot.scene(), names, MoveGroupKind::kArm));
  EXPECT_EQ(robot.n_joints(), 6);
  EXPECT_EQ(robot.jnt_pos_msr().size(), 6u);
  ExpectThrow<NotFoundError>([&] { robot.FkFrame(); }, "group 'arm' has no chain");
  EXPECT_EQ(arm->nq(), 7);  // a kept reference to a replaced group stays usable
}

TEST(OwnGroup, RejectsTheKindsGripperAndBaseForOtherClasses) {
  Robot robot = RobotAlone(Rc7());
  const auto set = [&](MoveGroupKind kind) {
    robot.SetGroup(std::make_unique<JointGroup>(robot.scene(), WristNames(), kind));
  };
  ExpectThrow<ArgumentError>([&] { set(MoveGroupKind::kGripper); },
                             "group 'wrist': a group of kind gripper derives from GripperGroup");
  ExpectThrow<ArgumentError>([&] { set(MoveGroupKind::kBase); },
                             "group 'wrist': a group of kind base derives from BaseGroup");
  ExpectThrow<ArgumentError>([&] { robot.SetGroup(nullptr); }, "cannot be null");
}

// A gripper of another kind: the wrist's last joint, 1 at 0.5 rad.
class WristGripper : public JointGroupOf<GripperGroup> {
 public:
  explicit WristGripper(const Scene& scene, GroupNames names)
      : JointGroupOf(scene, std::move(names), MoveGroupKind::kGripper) {}
  double opening() const override { return joint_pos()[1] / 0.5; }
  void SetOpening(double opening) override {
    JointGroupOf::SetCtrl(std::vector<double>(2, ctrl_for_opening(opening)));
  }
  double ctrl_for_opening(double opening) const override { return 0.5 * opening; }
  double inter_finger_dist() const override { return 0.1 * opening(); }
  Interval inter_finger_dist_range() const override { return {0, 0.1}; }
  bool is_open() const override { return opening() > 0.9; }
  bool is_grasping(const std::string&) const override { return false; }
};

TEST(OwnGroup, CanBeAGripperWithOpenings) {
  Robot robot = RobotAlone(Rc7());
  GroupNames names = WristNames();
  GroupNames arm{.robot = "rc7",  // without the wrist, which becomes the gripper
                 .group = "arm",
                 .joints = robot.joint_names(),
                 .actuators = robot.arm().actuator_names(),
                 .root = names.root,
                 .leaf = names.leaf,
                 .robot_base = names.robot_base};
  for (auto* list : {&arm.joints, &arm.actuators}) list->resize(5);
  robot.SetGroup(std::make_unique<JointGroup>(robot.scene(), arm, MoveGroupKind::kArm));
  names.group = "gripper";
  robot.SetGroup(std::make_unique<WristGripper>(robot.scene(), names));
  robot.Apply({{"gripper", GroupCommand::Opening(0.8)}});
  robot.Update();
  EXPECT_DOUBLE_EQ(robot.scene().actuator_ctrl("servo7"), 0.4);
  EXPECT_EQ(robot.controller("gripper").target()[0], 0.8);
}

TEST(OwnGroup, SharedOwnershipKeepsTheRobotAlive) {
  std::shared_ptr<MoveGroup> arm;
  {
    Robot robot = RobotAlone(Rc7());
    EXPECT_EQ(GroupsKeptBy(robot.scene()).size(), 3u);
    EXPECT_TRUE(robot.groups_of_sole_handle().empty()) << "the scene keeps them";
    const Scene::Weak scene(robot.scene());
    const size_t handles = scene.handles();
    arm = robot.shared_group("arm");
    EXPECT_EQ(scene.handles(), handles + 1) << "the arm counts as a handle";
  }
  EXPECT_EQ(arm->joint_pos(), Rc7().home.at("arm"));
}

// An arm that replaces itself while its position is read.
class FickleArm : public JointGroup {
 public:
  explicit FickleArm(const Robot& robot)
      : JointGroup(robot.scene(), ArmNames(), MoveGroupKind::kArm) {}
  void GetJointPos(std::span<double> out) const override {
    if (replace) std::exchange(replace, nullptr)();
    JointGroup::GetJointPos(out);
  }
  mutable std::function<void()> replace;
};

TEST(OwnGroup, CannotBeReplacedDuringARead) {
  Robot robot = RobotAlone(Rc7());
  auto fickle = std::make_unique<FickleArm>(robot);
  FickleArm& arm = *fickle;
  robot.SetGroup(std::move(fickle));
  arm.replace = [&] { robot.SetGroup(std::make_unique<FickleArm>(robot)); };
  ExpectThrow<Error>([&] { robot.Update(); },
                     "robot 'rc7': its groups cannot change while the arm's state is read; replace "
                     "'arm' outside of the arm's joint_pos");
  robot.Update();  // as before
  EXPECT_EQ(&robot.arm(), &arm);
}

// A group of two joints with these limits.
class OddlyLimited : public JointGroup {
 public:
  OddlyLimited(const Scene& scene, std::vector<Interval> limits)
      : JointGroup(scene, WristNames(), MoveGroupKind::kGeneric), limits_(std::move(limits)) {}
  std::vector<Interval> joint_pos_limits() const override { return limits_; }

 private:
  std::vector<Interval> limits_;
};

TEST(OwnGroup, RequiresIncreasingLimitsForEachJoint) {
  Robot robot = RobotAlone(Rc7());
  const auto make = [&](std::vector<Interval> limits) {
    OddlyLimited group(robot.scene(), std::move(limits));
    MakeJointPositionController(group);
  };
  make({{-1, 1}, {-HUGE_VAL, HUGE_VAL}});
  const std::string place = "robot 'rc7' / group 'wrist': ";
  ExpectThrow<ArgumentError>(
      [&] {
        make({{-1, 1}});
      },
      place +
          "joint_pos_limits has 1 interval(s), expected 2, one for each joint position "
          "(infinite where there is no limit)");
  ExpectThrow<ArgumentError>(
      [&] {
        make({{-1, 1}, {2, -2}});
      },
      place + "joint_pos_limits[1] is [2, -2], expected [smallest, largest]");
  ExpectThrow<ArgumentError>(
      [&] {
        make({{std::nan(""), 1}, {-1, 1}});
      },
      place + "joint_pos_limits[0] is [nan, 1]");
}

}  // namespace
}  // namespace robocell
