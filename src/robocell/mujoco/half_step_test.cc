#include "robocell/mujoco/half_step.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/step.h"
#include "robocell/testing/count_allocations.h"

namespace robocell {
namespace {

// An arm that falls on a ball, a body that follows a mocap body, and a weld that can be let go.
constexpr const char* kHalfStepModel = R"(<mujoco><option timestep="0.002"/>
  <worldbody>
    <geom type="plane" size="3 3 .1"/>
    <body name="ball" pos="0 0 .1"><freejoint/><geom size=".1"/></body>
    <body name="guide" mocap="true" pos="1 0 1"/>
    <body name="follower" pos="1 0 1"><freejoint/><geom size=".05"/></body>
    <body name="arm" pos="-.3 0 .4"><joint name="elbow" axis="0 1 0" damping=".1"/>
      <geom type="capsule" fromto="0 0 0 .3 0 0" size=".02"/>
      <body pos=".3 0 0"><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".02"/>
      </body></body>
  </worldbody>
  <equality><weld body1="guide" body2="follower"/></equality>
  <actuator><motor joint="elbow"/></actuator>
</mujoco>)";

class HalfSteps : public testing::Test {
 protected:
  HalfSteps()
      : model_(Compile(ParseXmlString(kHalfStepModel).get())),
        data_(MakeData(model_.get())),
        plain_(MakeData(model_.get())) {
    for (mjData* data : {data_.get(), plain_.get()}) {
      for (int k = 0; k < 100; ++k) mj_step(model_.get(), data);
    }
  }

  void ExpectTheSame() const {
    const int size = mj_stateSize(model_.get(), mjSTATE_INTEGRATION);
    std::vector<double> a(size), b(size);
    mj_getState(model_.get(), data_.get(), a.data(), mjSTATE_INTEGRATION);
    mj_getState(model_.get(), plain_.get(), b.data(), mjSTATE_INTEGRATION);
    EXPECT_EQ(a, b);
  }
  // A step in two halves and the engine's own, each with `between` before its controls.
  void StepBoth(const std::function<void(mjData*)>& between) {
    half_.Begin(model_.get(), data_.get(), "test");
    for (mjData* data : {data_.get(), plain_.get()}) {
      between(data);
      data->ctrl[0] = std::sin(100 * data->time);
    }
    ASSERT_TRUE(Step(model_.get(), data_.get(), 1, "test", &half_).ok());
    mj_step(model_.get(), plain_.get());
  }
  bool CanGoOn() {
    StepStart start;
    half_.Begin(model_.get(), data_.get(), "test");
    return half_.Take(model_.get(), data_.get(), &start);
  }

  ModelPtr model_;
  DataPtr data_, plain_;
  HalfStep half_;
};

TEST_F(HalfSteps, EndAtTheBitsOfAWholeStepWithEveryIntegrator) {
  for (const int integrator : {mjINT_EULER, mjINT_IMPLICIT, mjINT_IMPLICITFAST, mjINT_RK4}) {
    model_->opt.integrator = integrator;
    EXPECT_EQ(CanGoOn(), integrator != mjINT_RK4);
    for (int k = 0; k < 50; ++k) StepBoth([](mjData*) {});
    ExpectTheSame();
    for (int k = 0; k < 3; ++k) EXPECT_FALSE(std::signbit(data_->xpos[k])) << "the world's";
  }
}

TEST_F(HalfSteps, MakeWhatFollowsFromTheStateCurrent) {
  half_.Begin(model_.get(), data_.get(), "test");
  mj_forward(model_.get(), plain_.get());
  for (int k = 0; k < 3 * model_->nbody; ++k) EXPECT_EQ(data_->xpos[k], plain_->xpos[k]);
  for (int k = 0; k < model_->nv; ++k) EXPECT_EQ(data_->qfrc_bias[k], plain_->qfrc_bias[k]);
  EXPECT_GT(data_->ncon, 0);
  EXPECT_EQ(data_->ncon, plain_->ncon);
}

TEST_F(HalfSteps, NoticeWhatIsChangedInBetween) {
  const std::vector<std::function<void(mjData*)>> changes = {
      [](mjData* d) { d->qpos[2] += 1e-3; }, [](mjData* d) { d->qvel[12] -= 0.1; },
      [](mjData* d) { d->mocap_pos[0] += 0.01; }, [](mjData* d) { d->mocap_quat[1] += 0.01; },
      [](mjData* d) { d->eq_active[0] = !d->eq_active[0]; },
      [this](mjData*) { model_->opt.gravity[0] = 1; },
      // Somebody tried something, and put the state back but not what follows from it.
      [this](mjData* d) {
        const double was = d->qpos[14];
        d->qpos[14] += 0.3;
        mj_forward(model_.get(), d);
        d->qpos[14] = was;
      },
      // The last joint of all, and its poses alone.
      [this](mjData* d) {
        const double was = d->qpos[15];
        d->qpos[15] += 0.3;
        mj_kinematics(model_.get(), d);
        d->qpos[15] = was;
      }};
  for (const auto& change : changes) {
    StepBoth(change);
    ExpectTheSame();
  }
}

TEST_F(HalfSteps, GoOnUnderForcesThatWereAppliedInBetween) {
  StepBoth([](mjData* d) {
    d->qfrc_applied[12] = 0.3;
    d->xfrc_applied[6 + 2] = 5;
  });
  ExpectTheSame();
}

TEST_F(HalfSteps, AreMadeOnceForAState) {
  const auto mark = [&]() -> double& { return data_->xipos[3]; };  // not looked at
  half_.Begin(model_.get(), data_.get(), "test");
  mark() = 123;
  half_.Begin(model_.get(), data_.get(), "test");
  EXPECT_EQ(mark(), 123);
  half_.Discard();
  half_.Begin(model_.get(), data_.get(), "test");
  EXPECT_NE(mark(), 123);
  StepStart start;
  EXPECT_TRUE(half_.Take(model_.get(), data_.get(), &start));
  EXPECT_FALSE(half_.Take(model_.get(), data_.get(), &start));
}

TEST_F(HalfSteps, SolveContactsWithoutAnyConsequence) {
  half_.Begin(model_.get(), data_.get(), "test");
  for (int i = 0; i < data_->nefc; ++i) EXPECT_EQ(data_->efc_force[i], 0);
  half_.SolveContacts(model_.get(), data_.get(), "test");
  mj_forward(model_.get(), plain_.get());
  double total = 0;
  for (int i = 0; i < data_->nefc; ++i) {
    EXPECT_EQ(data_->efc_force[i], plain_->efc_force[i]);
    total += std::abs(data_->efc_force[i]);
  }
  EXPECT_GT(total, 1);
}

// A velocity was written after the half, or the half was dropped.
TEST_F(HalfSteps, SolveContactsOfThePresentState) {
  for (const bool drop : {false, true}) {
    half_.Begin(model_.get(), data_.get(), "test");
    if (drop) half_.Discard();
    for (mjData* data : {data_.get(), plain_.get()}) data->qvel[2] = -0.3;
    half_.SolveContacts(model_.get(), data_.get(), "test");
    mj_forward(model_.get(), plain_.get());
    ASSERT_GT(plain_->nefc, 0);
    ASSERT_EQ(data_->nefc, plain_->nefc);
    for (int i = 0; i < data_->nefc; ++i) EXPECT_EQ(data_->efc_force[i], plain_->efc_force[i]);
    for (const double push : {0.0, -20.0}) {  // pressed down: other forces
      data_->qfrc_applied[2] = plain_->qfrc_applied[2] = push;
      half_.SolveContacts(model_.get(), data_.get(), "test");
      mj_forward(model_.get(), plain_.get());
      for (int i = 0; i < data_->nefc; ++i)
        EXPECT_NEAR(data_->efc_force[i], plain_->efc_force[i], 1e-6 * (1 + std::abs(push)));
    }
  }
}

// Who steps the engine by hand has contacts of the last step, as ever.
TEST_F(HalfSteps, LeaveContactsOfOthersStepsAlone) {
  half_.Begin(model_.get(), data_.get(), "test");
  for (mjData* data : {data_.get(), plain_.get()}) mj_step(model_.get(), data);
  half_.SolveContacts(model_.get(), data_.get(), "test");
  ASSERT_EQ(data_->nefc, plain_->nefc);
  for (int i = 0; i < data_->nefc; ++i) EXPECT_EQ(data_->efc_force[i], plain_->efc_force[i]);
  for (int k = 0; k < 3 * model_->nbody; ++k) EXPECT_EQ(data_->xpos[k], plain_->xpos[k]);
}

TEST_F(HalfSteps, LeaveWhatTheLastStepSaysOfForcesWhenTheySolveContacts) {
  const auto said = [&] {
    const mjData& d = *data_;
    std::vector<double> all(d.qacc, d.qacc + model_->nv);
    all.insert(all.end(), d.qfrc_actuator, d.qfrc_actuator + model_->nv);
    all.insert(all.end(), d.qacc_warmstart, d.qacc_warmstart + model_->nv);
    all.push_back(d.actuator_force[0]);
    return all;
  };
  const std::vector<double> before = said();
  half_.Begin(model_.get(), data_.get(), "test");
  data_->ctrl[0] = 3;
  half_.SolveContacts(model_.get(), data_.get(), "test");
  EXPECT_EQ(said(), before);
}

TEST_F(HalfSteps, ThatSolvedTheirContactsEndAtTheSameBitsToo) {
  half_.Begin(model_.get(), data_.get(), "test");
  half_.SolveContacts(model_.get(), data_.get(), "test");
  ASSERT_TRUE(Step(model_.get(), data_.get(), 3, "test", &half_).ok());
  for (int k = 0; k < 3; ++k) mj_step(model_.get(), plain_.get());
  ExpectTheSame();
}

TEST_F(HalfSteps, ReportDivergenceAsWholeStepsDo) {
  WarningCapture quiet;
  data_->qvel[12] = plain_->qvel[12] = std::numeric_limits<double>::quiet_NaN();
  half_.Begin(model_.get(), data_.get(), "test");
  const StepResult result = Step(model_.get(), data_.get(), 1, "test", &half_);
  EXPECT_EQ(result.status, StepResult::kDiverged);
  EXPECT_EQ(result.message, Step(model_.get(), plain_.get()).message);
  EXPECT_NE(result.message.find("velocity of joint 'elbow' is nan"), std::string::npos);
}

// It may be the callback that asks.
TEST_F(HalfSteps, LeaveTheEnginesCallbackToTheStep) {
  static int calls;
  calls = 0;
  mjcb_control = [](const mjModel*, mjData* d) { d->ctrl[0] = ++calls; };
  half_.Begin(model_.get(), data_.get(), "test");
  EXPECT_EQ(calls, 0);
  EXPECT_TRUE(Step(model_.get(), data_.get(), 1, "test", &half_).ok());
  EXPECT_EQ(calls, 1);
  mjcb_control = nullptr;
  plain_->ctrl[0] = 1;
  mj_step(model_.get(), plain_.get());
  ExpectTheSame();
}

// As when a scene is compiled anew: the model is at the same address, and larger.
TEST_F(HalfSteps, KnowAnotherModelAtTheSameAddress) {
  const auto bodies = [](int n) {
    std::string xml = "<mujoco><worldbody>";
    for (int k = 0; k < n; ++k) xml += "<body><freejoint/><geom size='.1' contype='0'/></body>";
    return Compile(ParseXmlString(xml + "</worldbody></mujoco>").get());
  };
  const ModelPtr small = bodies(1), large = bodies(50);
  const DataPtr before = MakeData(small.get()), after = MakeData(large.get());
  half_.Begin(small.get(), before.get(), "test");
  std::swap(*small, *large);
  StepStart start;
  EXPECT_FALSE(half_.Take(small.get(), after.get(), &start));
  std::swap(*small, *large);
}

TEST_F(HalfSteps, AllocateNothing) {
  half_.Begin(model_.get(), data_.get(), "test");
  const AllocationCount count;
  for (int k = 0; k < 100; ++k) {
    half_.Begin(model_.get(), data_.get(), "test");
    if (!Step(model_.get(), data_.get(), 1, "test", &half_).ok()) FAIL();
  }
  EXPECT_EQ(count.allocations(), 0);
}

}  // namespace
}  // namespace robocell
