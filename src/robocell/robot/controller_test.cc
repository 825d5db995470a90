#include "robocell/robot/controller.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "robocell/base/error.h"
#include "robocell/robot/joint_group.h"
#include "robocell/robot/joint_position_controller.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/robot/testing/wrist.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

// Records the order in which it and its group are destroyed.
struct Diary {
  std::vector<std::string> entries;
};

class DiaryGroup : public JointGroup {
 public:
  DiaryGroup(const Scene& scene, Diary* diary)
      : JointGroup(scene, WristNames(), MoveGroupKind::kGeneric), diary_(diary) {}
  ~DiaryGroup() override { diary_->entries.push_back("group"); }

 private:
  Diary* diary_;
};

class DiaryController : public JointPositionController {
 public:
  DiaryController(MoveGroup& group, Diary* diary)
      : JointPositionController(group), group_(group), diary_(diary) {}
  ~DiaryController() override { diary_->entries.push_back("controller of " + group_.name()); }

 private:
  MoveGroup& group_;
  Diary* diary_;
};

TEST(OwnController, IsFreedWhenReplacedAndBeforeItsGroup) {
  Diary diary;
  Robot robot = RobotAlone(Rc7());
  robot.SetGroup(std::make_unique<DiaryGroup>(robot.scene(), &diary));
  for (int k = 0; k < 2; ++k) {
    robot.SetController("wrist", std::make_unique<DiaryController>(robot.group("wrist"), &diary));
  }
  EXPECT_THAT(diary.entries, ::testing::ElementsAre("controller of wrist"));
  robot.SetGroup(std::make_unique<DiaryGroup>(robot.scene(), &diary));
  EXPECT_THAT(diary.entries,
              ::testing::ElementsAre("controller of wrist", "controller of wrist", "group"));
  EXPECT_EQ(GroupsKeptBy(robot.scene()).size(), 4u);
}

// Replaces the controller and the group while it computes.
class FickleController : public DiaryController {
 public:
  FickleController(Robot& robot, Diary* diary)
      : DiaryController(robot.group("wrist"), diary), robot_(robot), diary_(diary) {}
  void Compute(std::span<double> ctrl) override {
    robot_.SetController("wrist", "joint_position");
    robot_.SetGroup(std::make_unique<DiaryGroup>(robot_.scene(), diary_));
    DiaryController::Compute(ctrl);
    diary_->entries.push_back("computed");
  }

 private:
  Robot& robot_;
  Diary* diary_;
};

TEST(OwnController, ThatReplacesItselfIsFreedAfterTheUpdate) {
  Diary diary;
  Robot robot = RobotAlone(Rc7());
  robot.SetGroup(std::make_unique<DiaryGroup>(robot.scene(), &diary));
  robot.SetController("wrist", std::make_unique<FickleController>(robot, &diary));
  robot.Update();
  EXPECT_THAT(diary.entries, ::testing::ElementsAre("computed", "controller of wrist", "group"));
  EXPECT_EQ(robot.controller("wrist").kind(), "joint_position");
  robot.Update();
  EXPECT_EQ(diary.entries.size(), 3u);
}

TEST(OwnController, KeepsItsGroupIfKeptAfterReplacement) {
  Diary diary;
  std::shared_ptr<Controller> kept;
  {
    Robot robot = RobotAlone(Rc7());
    robot.SetGroup(std::make_unique<DiaryGroup>(robot.scene(), &diary));
    kept = robot.shared_controller("wrist");
    robot.SetGroup(std::make_unique<DiaryGroup>(robot.scene(), &diary));
    EXPECT_TRUE(diary.entries.empty());
  }
  EXPECT_EQ(kept->target_size(), 2);
  kept.reset();
  EXPECT_THAT(diary.entries, ::testing::ElementsAre("group", "group"));
}

// Moves every joint along a sine, whatever the target is.
class Waving : public JointPositionController {
 public:
  using JointPositionController::JointPositionController;
  std::string_view kind() const override { return "waving"; }
  void Compute(std::span<double> ctrl) override {
    for (double& c : ctrl) c = std::sin(0.1 * ticks_);
    ++ticks_;
  }

 private:
  int ticks_ = 0;
};

TEST(OwnController, IsRegisteredAndSelectedByName) {
  RegisterController("waving", [](MoveGroup& g) { return std::make_unique<Waving>(g); });
  ExpectThrow<ArgumentError>(
      [] {
        RegisterController("waving", [](MoveGroup& g) { return std::make_unique<Waving>(g); });
      },
      "controller 'waving' is registered already; choose another name");
  ExpectThrow<ArgumentError>([] { RegisterController("nothing", {}); }, "needs a function");
  Robot robot = RobotAlone(Rc7());
  robot.SetController("arm", "waving");
  EXPECT_EQ(robot.controller("arm").kind(), "waving");
  for (int i = 0; i < 3; ++i) robot.Update();
  EXPECT_EQ(robot.scene().actuator_ctrl("servo1"), std::sin(0.2));
  ExpectThrow<NotFoundError>(
      [&] { robot.SetController("arm", "wavin"); },
      "group 'arm': no controller 'wavin'. Its controllers: "
      "base_pose, cartesian_impedance, cartesian_pose, differential_ik, joint_impedance, "
      "joint_position, joint_torque, joint_velocity, "
      "relative_joint_position, unicycle, waving. Did you mean 'waving'?");
  ExpectThrow<ArgumentError>([&] { robot.SetController("arm", std::unique_ptr<Controller>()); },
                             "a controller cannot be null");
}

}  // namespace
}  // namespace robocell
