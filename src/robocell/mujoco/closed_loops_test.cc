#include "robocell/mujoco/closed_loops.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/coupled_positions.h"
#include "robocell/mujoco/names.h"

namespace robocell::internal {
namespace {

// A crank with a rod that ends on the upper arm's side: shoulder, elbow, crank and rod form a loop.
ModelPtr Parallelogram(const std::string& rod_range = "-3 3", const std::string& more = "") {
  const std::string xml = R"(
    <mujoco><compiler angle="radian"/><default><joint axis="0 1 0" range="-2 2"/>
      <geom size=".02" contype="0" conaffinity="0"/></default>
    <worldbody>
      <body name="upper"><joint name="shoulder"/><geom/>
        <body name="fore" pos="0 0 .4"><joint name="elbow"/><geom/>
          <body pos="0 0 .4"><joint name="wrist"/><geom/></body></body></body>
      <body name="crank"><joint name="crank"/><geom/>
        <body name="rod" pos="-.1 0 0"><joint name="rod" range=")" +
                          rod_range + R"("/><geom/></body></body>
      <body name="thing" pos="1 0 0"><freejoint/><geom/></body>
    </worldbody>
    <equality><connect name="close" body1="rod" body2="fore" anchor="0 0 .4"/>)" +
                          more + "</equality></mujoco>";
  return Compile(ParseXmlString(xml, "loop").get(), nullptr, "loop");
}

int Joint(const mjModel* m, const std::string& name) { return FindId(m, mjOBJ_JOINT, name); }

// Returns the distance between the ends of the loop, as the engine has it.
double GapOf(const mjModel* m, const std::vector<double>& q) {
  const DataPtr d = MakeData(m);
  std::copy(q.begin(), q.end(), d->qpos);
  mj_fwdPosition(m, d.get());
  double worst = 0;
  for (int r = 0; r < d->nefc; ++r) {
    if (d->efc_type[r] == mjCNSTR_EQUALITY) worst = std::max(worst, std::abs(d->efc_pos[r]));
  }
  return worst;
}

std::vector<double> Reference(const mjModel* m) { return {m->qpos0, m->qpos0 + m->nq}; }

TEST(ClosedLoops, CloseForRandomPositionsOfTheirDrivenJoints) {
  const ModelPtr m = Parallelogram();
  const std::array<int, 2> driven = {Joint(m.get(), "shoulder"), Joint(m.get(), "crank")};
  Rng rng = Rng::Stream(3, "loops");
  for (int round = 0; round < 50; ++round) {
    std::vector<double> q = Reference(m.get());
    // At a right angle crank and rod are in line: a dead point.
    const double shoulder = rng.Uniform(-0.6, 0.6), crank = shoulder + rng.Uniform(-0.8, 0.8);
    q[driven[0]] = shoulder;
    q[driven[1]] = crank;
    ASSERT_TRUE(CloseLoops(m.get(), driven, q.data()));
    EXPECT_LT(GapOf(m.get(), q), 1e-9);
    // It is a parallelogram: the forearm is parallel to the crank.
    EXPECT_NEAR(q[Joint(m.get(), "elbow")], crank - shoulder, 1e-8);
    EXPECT_NEAR(q[Joint(m.get(), "rod")], shoulder - crank, 1e-8);
    EXPECT_EQ(q[driven[0]], shoulder);
    EXPECT_EQ(q[Joint(m.get(), "wrist")], 0);
  }
}

TEST(ClosedLoops, StayClosedUnderOffsetsOfAnArm) {
  const ModelPtr m = Parallelogram();
  const std::array<int, 3> arm = {Joint(m.get(), "shoulder"), Joint(m.get(), "elbow"),
                                  Joint(m.get(), "wrist")};
  Rng rng = Rng::Stream(4, "loops");
  for (int round = 0; round < 50; ++round) {
    std::vector<double> q = Reference(m.get()), offsets;
    for (int i = 0; i < 3; ++i) offsets.push_back(rng.Uniform(-0.3, 0.3));
    MoveCoupled(m.get(), arm, offsets, q.data());
    EXPECT_LT(GapOf(m.get(), q), 1e-9);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(q[arm[i]], offsets[i], 1e-12);
  }
}

TEST(ClosedLoops, MoveAnArmOnlyAsFarAsTheyFollow) {
  const ModelPtr m = Parallelogram("-.1 .1");
  const std::array<int, 1> elbow = {Joint(m.get(), "elbow")};
  std::vector<double> q = Reference(m.get());
  const std::array<double, 1> offset = {0.35};  // the rod would turn by as much
  MoveCoupled(m.get(), elbow, offset, q.data());
  EXPECT_LT(GapOf(m.get(), q), 1e-5);
  EXPECT_NEAR(q[elbow[0]], 0.35 / 4, 1e-12);

  std::vector<double> fixed = Reference(m.get());
  fixed[elbow[0]] = 1;
  const std::vector<double> before = fixed;
  EXPECT_FALSE(CloseLoops(m.get(), elbow, fixed.data()));
  EXPECT_EQ(fixed, before);
}

TEST(ClosedLoops, OfTendonsAndJointsThatFollowClose) {
  // wrist = -(shoulder + elbow): a flange that stays level, and a joint that follows it.
  const std::string xml = R"(
    <mujoco><compiler angle="radian"/><default><joint axis="0 1 0" range="-2 2"/></default>
    <worldbody><body><joint name="a"/><geom size=".1"/><body><joint name="b"/><geom size=".1"/>
      <body><joint name="c"/><geom size=".1"/><body><joint name="d"/><geom size=".1"/></body></body>
      </body></body></worldbody>
    <tendon><fixed name="level"><joint joint="a" coef="1"/><joint joint="b" coef="1"/>
      <joint joint="c" coef="1"/></fixed></tendon>
    <equality><tendon name="hold" tendon1="level"/>
      <joint joint1="d" joint2="c" polycoef="0 .5 0 0 0"/></equality></mujoco>)";
  const ModelPtr m = Compile(ParseXmlString(xml, "level").get(), nullptr, "level");
  const std::array<int, 2> driven = {0, 1};
  std::vector<double> q = {0.4, 0.3, 0, 0};
  ASSERT_TRUE(CloseLoops(m.get(), driven, q.data()));
  EXPECT_NEAR(q[2], -0.7, 1e-9);
  EXPECT_NEAR(q[3], -0.35, 1e-9);
  EXPECT_EQ(DescribeLoopOf(m.get(), 2),
            "one of the joints that equality 'hold' of tendon 'level' holds together");
  EXPECT_EQ(DescribeLoopOf(m.get(), 3), "");
}

TEST(ClosedLoops, LeaveObjectsThatAreTiedToARobotAlone) {
  const ModelPtr m = Parallelogram("-3 3", R"(<weld body1="fore" body2="thing"/>
      <connect body1="fore" body2="crank" anchor="0 0 0" active="false"/>)");
  ASSERT_EQ(FindClosedLoops(m.get()).size(), 1U);
  std::vector<double> q = Reference(m.get());
  const std::vector<double> thing(q.end() - 7, q.end());
  q[Joint(m.get(), "shoulder")] = 0.3;
  const std::array<int, 1> shoulder = {Joint(m.get(), "shoulder")};
  EXPECT_TRUE(CloseLoops(m.get(), shoulder, q.data()));
  EXPECT_EQ(std::vector<double>(q.end() - 7, q.end()), thing);
  EXPECT_EQ(DescribeLoopOf(m.get(), Joint(m.get(), "elbow")),
            "part of the loop that 'close' closes, a connect of 'rod' and 'fore'");
}

}  // namespace
}  // namespace robocell::internal
