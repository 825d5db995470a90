// Tests controls that hold a pose: simulated with them, joints stay where they are.
#include "robocell/scene/hold_ctrl.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "robocell/mujoco/compile.h"

namespace robocell::internal {
namespace {

// A hinge without gravity, driven by an actuator.
class Hinge {
 public:
  explicit Hinge(const std::string& actuator, double angle = 0.7)
      : model_(Compile(
            ParseXmlString("<mujoco><compiler angle='radian' autolimits='true'/><option "
                           "gravity='0 0 0'/><worldbody><body><joint name='hinge' damping='1'/>"
                           "<geom size='.1' pos='0 0 .3'/></body></worldbody><actuator>" +
                           actuator + "</actuator></mujoco>")
                .get())),
        data_(MakeData(model_.get())) {
    data_->qpos[0] = angle;
    mj_forward(model_.get(), data_.get());
  }
  const mjModel* model() const { return model_.get(); }
  mjData* data() const { return data_.get(); }
  // The angle after `seconds` more.
  double After(double seconds) const {
    for (int i = 0; i < seconds / model_->opt.timestep; ++i) mj_step(model_.get(), data_.get());
    return data_->qpos[0];
  }

 private:
  ModelPtr model_;
  DataPtr data_;
};

class HoldingActuators : public ::testing::TestWithParam<const char*> {};

TEST_P(HoldingActuators, KeepTheJointWhereItIs) {
  const Hinge hinge(GetParam());
  Hold(hinge.model(), hinge.data(), 0);
  EXPECT_NEAR(hinge.After(1), 0.7, 1e-9);
}

TEST_P(HoldingActuators, RestAtTheLengthOfTheirInputs) {
  const Hinge hinge(GetParam());
  const auto inputs = FindHoldingInputs(hinge.model(), hinge.data(), 0);
  ASSERT_TRUE(inputs.has_value());
  EXPECT_NEAR(RestingLength(hinge.model(), 0, *inputs), hinge.data()->actuator_length[0], 1e-12);
}

INSTANTIATE_TEST_SUITE_P(
    All, HoldingActuators,
    ::testing::Values(
        "<position joint='hinge' kp='20'/>", "<position joint='hinge' kp='20' gear='-3'/>",
        "<position joint='hinge' kp='20' timeconst='.2'/>",
        "<intvelocity joint='hinge' kp='20' actrange='-3 3'/>",
        "<general joint='hinge' gainprm='.5' biastype='affine' biasprm='3 -40 -1'/>"));

TEST(HoldCtrl, APlainServoIsSentTheLengthToTheBit) {
  const Hinge hinge("<position joint='hinge' kp='20'/>", 0.1 + 0.2);
  EXPECT_EQ(HoldingCtrl(hinge.model(), hinge.data(), 0), 0.1 + 0.2);
  EXPECT_FALSE(std::signbit(*RestingCtrl(hinge.model(), 0, -0.0))) << "no negative zero";
}

TEST(HoldCtrl, IsClampedToTheRangeUnlessRequestedFree) {
  const Hinge hinge("<position joint='hinge' kp='20' ctrlrange='-.5 .5'/>");
  EXPECT_EQ(RestingCtrl(hinge.model(), 0, 0.7), 0.5);
  EXPECT_EQ(FreeRestingCtrl(hinge.model(), 0, 0.7), 0.7);
}

TEST(HoldCtrl, OtherActuatorsHoldNothing) {
  for (const char* actuator : {"<motor joint='hinge'/>", "<velocity joint='hinge' kv='1'/>",
                               "<damper joint='hinge' "
                               "kv='1' ctrlrange='0 1'/>"}) {
    const Hinge hinge(actuator);
    EXPECT_EQ(HoldingCtrl(hinge.model(), hinge.data(), 0), std::nullopt) << actuator;
    EXPECT_FALSE(FindHoldingInputs(hinge.model(), hinge.data(), 0).has_value()) << actuator;
    hinge.data()->ctrl[0] = 0.25;
    Hold(hinge.model(), hinge.data(), 0);
    EXPECT_EQ(hinge.data()->ctrl[0], 0.25) << actuator;
  }
}

TEST(HoldCtrl, AFilterIsSettledAtItsControl) {
  const Hinge hinge("<position joint='hinge' kp='20' timeconst='.2'/>");
  EXPECT_TRUE(IsFiltered(hinge.model(), 0));
  SettleLag(hinge.model(), hinge.data(), 0, 0.4);
  EXPECT_EQ(hinge.data()->act[0], 0.4);
  EXPECT_FALSE(IsFiltered(Hinge("<position joint='hinge' kp='20'/>").model(), 0));
}

TEST(HoldCtrl, OnlyWhatPullsAtMovedJointsIsSet) {
  const Hinge hinge("<position joint='hinge' kp='20'/>");
  EXPECT_TRUE(ActsOn(hinge.model(), hinge.data(), 0, {true}));
  EXPECT_FALSE(ActsOn(hinge.model(), hinge.data(), 0, {false}));
  HoldMoved(hinge.model(), hinge.data(), {false}, "test");
  EXPECT_EQ(hinge.data()->ctrl[0], 0);
  HoldMoved(hinge.model(), hinge.data(), {true}, "test");
  EXPECT_EQ(hinge.data()->ctrl[0], 0.7);
}

}  // namespace
}  // namespace robocell::internal
