#include "robocell/scene/drive_matrix.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"

namespace robocell::internal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Three joints in a row; c follows b by half. `actuators` act on them and on two tendons.
ModelPtr DrivenModel(const std::string& actuators, const std::string& tendons = "") {
  return Compile(
      ParseXmlString(R"(<mujoco><compiler angle="radian"/><worldbody>
      <body><joint name="a"/><geom size=".1"/><body><joint name="b"/><geom size=".1"/>
      <body><joint name="c"/><geom size=".1"/></body></body></body></worldbody>
      <equality><joint joint1="c" joint2="b" polycoef=".2 .5 0 0 0"/></equality><tendon>
      <fixed name="sum"><joint joint="a" coef="1"/><joint joint="c" coef="4"/></fixed>)" +
                         tendons + "</tendon><actuator>" + actuators + "</actuator></mujoco>",
                     "drive")
          .get(),
      nullptr, "drive");
}

const std::vector<int> kTwoJoints = {0, 1};

TEST(DriveMatrix, IsTheSlopeOfTheLengthsThatTheEngineComputes) {
  const ModelPtr m = DrivenModel(
      "<position name='p' tendon='sum' gear='2'/><position name='q' joint='c' gear='-3'/>"
      "<position name='r' joint='b'/>");
  const DataPtr d = MakeData(m.get());
  const std::vector<JointFollower> followers = FollowersOf(m.get(), kTwoJoints);
  const std::vector<double> x = {0.3, -0.7};
  d->qpos[0] = x[0], d->qpos[1] = x[1], d->qpos[2] = followers[0].of_leader.at(x[1]);
  mj_forward(m.get(), d.get());
  std::vector<DriveLength> lengths;
  for (int a = 0; a < 3; ++a) {
    lengths.push_back(LengthOver(m.get(), a, kTwoJoints, followers).value());
    EXPECT_NEAR(LengthAt(lengths.back(), x), d->actuator_length[a], 1e-14) << a;
  }
  Eigen::MatrixXd expected(3, 2);
  expected << 2, 4, 0, -1.5, 0, 1;
  EXPECT_LT((DriveMatrix(lengths, x) - expected).norm(), 1e-14);
}

TEST(DriveMatrix, FindsServosThatMoveAllJointsTogether) {
  const auto found = [](const ModelPtr& m) {
    std::vector<std::string> names;
    for (const int a : FindMatrixDrive(m.get(), kTwoJoints))
      names.push_back(ElementName(m.get(), mjOBJ_ACTUATOR, a));
    return names;
  };
  EXPECT_THAT(found(DrivenModel("<position name='pb' joint='b'/><position name='pc' joint='c'/>"
                                "<position name='pa' joint='a'/>")),
              ElementsAre("pa", "pb", "pc"));
  EXPECT_THAT(found(DrivenModel("<position name='ps' tendon='sum'/><position name='pa' joint='a'/>"
                                "<motor name='a_torque' joint='a'/>")),
              ElementsAre("ps", "pa"));
  EXPECT_THAT(found(DrivenModel("<motor name='ms' tendon='sum'/><motor name='ma' joint='a'/>")),
              ElementsAre("ms", "ma"));
  EXPECT_THAT(found(DrivenModel("<position name='ps' tendon='sum'/>")), IsEmpty());
}

TEST(DriveMatrix, ExplainsWhyActuatorsMoveTooLittle) {
  const ModelPtr m =
      DrivenModel("<position name='ps' tendon='sum'/><position name='pt' tendon='sum'/>");
  EXPECT_THAT(WhyNoMatrixDrive(m.get(), kTwoJoints, std::vector<int>{0, 1}),
              HasSubstr("its actuators move 1 of 2 joints: the matrix of their lengths is [[1, 2], "
                        "[1, 2]]"));
  EXPECT_THAT(WhyNoMatrixDrive(m.get(), std::vector<int>{1}, std::vector<int>{0}),
              HasSubstr("actuator 'ps' acts on more than the arm's joints"));
}

}  // namespace
}  // namespace robocell::internal
