#include "robocell/mujoco/step.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <limits>

#include "robocell/base/error.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/guard.h"
#include "robocell/testing/count_allocations.h"

namespace robocell {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class Stepping : public testing::Test {
 protected:
  Stepping() {
    model_ = Compile(ParseXmlString(R"(<mujoco><option timestep="0.002"/>
      <worldbody>
        <geom type="plane" size="1 1 .1"/>
        <body name="ball" pos="0 0 .2"><freejoint name="free"/><geom size=".1"/></body>
        <body name="arm" pos="2 0 1"><joint name="elbow" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".02"/>
          <body pos=".3 0 0"><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".02"/></body></body>
      </worldbody>
      <actuator><motor name="m" joint="elbow"/></actuator>
    </mujoco>)")
                         .get());
    data_ = MakeData(model_.get());
  }

  ModelPtr model_;
  DataPtr data_;
  internal::WarningCapture quiet_;
};

TEST_F(Stepping, ReportsSuccessAndTheTime) {
  const StepResult result = Step(model_.get(), data_.get(), 100);
  EXPECT_TRUE(result.ok());
  EXPECT_EQ(result.steps, 100);
  EXPECT_EQ(result.time, data_->time);
  EXPECT_NEAR(result.time, 0.2, 1e-12);
  EXPECT_EQ(result.message, "");
}

TEST_F(Stepping, MatchesTheStepsOfTheEngine) {
  DataPtr plain = MakeData(model_.get());
  for (int i = 0; i < 200; ++i) mj_step(model_.get(), plain.get());
  EXPECT_TRUE(Step(model_.get(), data_.get(), 200).ok());
  for (int i = 0; i < model_->nq; ++i) EXPECT_EQ(data_->qpos[i], plain->qpos[i]);
}

TEST_F(Stepping, ANanVelocityIsReportedWithJointAndTimeAndStopsTheSteps) {
  EXPECT_TRUE(Step(model_.get(), data_.get(), 5).ok());
  data_->qvel[6] = kNan;
  const StepResult result = Step(model_.get(), data_.get(), 10);
  EXPECT_EQ(result.status, StepResult::kDiverged);
  EXPECT_EQ(result.steps, 1);
  EXPECT_NEAR(result.time, 0.01, 1e-12);
  EXPECT_EQ(result.joint_name, "elbow");
  EXPECT_THAT(result.message,
              AllOf(HasSubstr("diverged at t=0.01 s: velocity of joint 'elbow' is nan"),
                    HasSubstr("bad number in qvel")));
}

TEST_F(Stepping, AHugeForceDivergesWithinTheRequestedSteps) {
  data_->qfrc_applied[0] = 1e15;
  const StepResult result = Step(model_.get(), data_.get(), 1000);
  EXPECT_EQ(result.status, StepResult::kDiverged);
  EXPECT_LT(result.steps, 1000);
  EXPECT_EQ(result.joint_name, "free");
}

TEST_F(Stepping, AnUnnamedJointIsDescribedByItsBody) {
  data_->qpos[8] = kNan;
  EXPECT_THAT(Step(model_.get(), data_.get()).message,
              HasSubstr("joint 2 (unnamed, of body 3 (unnamed))"));
}

TEST_F(Stepping, TimeIsNeverSetBackByTheEngine) {
  EXPECT_TRUE(Step(model_.get(), data_.get(), 50).ok());
  data_->qvel[0] = 1e12;
  EXPECT_FALSE(Step(model_.get(), data_.get(), 3).ok());
  EXPECT_GT(data_->time, 0.1);
}

TEST_F(Stepping, DetectsAnAutomaticResetByTheClock) {
  model_->opt.disableflags &= ~mjDSBL_AUTORESET;
  EXPECT_TRUE(Step(model_.get(), data_.get(), 50).ok());
  data_->qvel[0] = 1e12;
  const StepResult result = Step(model_.get(), data_.get(), 3);
  EXPECT_EQ(result.status, StepResult::kDiverged);
  EXPECT_THAT(result.message,
              HasSubstr("diverged at t=0.1 s: velocity of joint 'free' was a bad number, "
                        "time went to 0.002 s in one step of 0.002 s"));
}

TEST_F(Stepping, GoodStepsAllocateNothing) {
  EXPECT_TRUE(Step(model_.get(), data_.get(), 10, "warm").ok());
  const AllocationCount count;
  for (int i = 0; i < 100; ++i) {
    if (!Step(model_.get(), data_.get(), 3, "scene 'pick'").ok()) FAIL();
  }
  EXPECT_EQ(count.allocations(), 0);
}

TEST_F(Stepping, TheAllocationCounterCountsAllocations) {
  const AllocationCount count;
  std::string text(100, 'x');
  EXPECT_GE(count.allocations(), 1);
}

TEST_F(Stepping, AFatalErrorInAStepIsAnExceptionAndTheNextStepWorks) {
  DataPtr fresh = MakeData(model_.get());
  mjcb_control = [](const mjModel*, mjData*) { mju_error("callback failed"); };
  try {
    EXPECT_TRUE(Step(model_.get(), data_.get(), 1, "scene 'pick'").ok());
    ADD_FAILURE() << "no error";
  } catch (const EngineError& error) {
    EXPECT_STREQ(error.what(), "scene 'pick': callback failed");
  }
  mjcb_control = nullptr;
  mj_resetData(model_.get(), data_.get());
  EXPECT_TRUE(Step(model_.get(), data_.get(), 100).ok());
  EXPECT_TRUE(Step(model_.get(), fresh.get(), 100).ok());
  EXPECT_EQ(data_->qpos[2], fresh->qpos[2]);
}

}  // namespace
}  // namespace robocell
