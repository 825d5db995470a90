#include "robocell/mujoco/couplings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <string>

#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"

namespace robocell {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// Five hinges with reference positions, coupled as `equalities` say.
ModelPtr CoupledModel(const std::string& equalities) {
  std::string bodies, ends;
  for (const char* name : {"a", "b", "c", "d", "e"}) {
    bodies += std::string("<body><joint name='") + name + "' ref='" +
              std::to_string(0.1 * (name[0] - 'a')) + "'/><geom size='.1'/>";
    ends += "</body>";
  }
  return Compile(ParseXmlString("<mujoco><compiler angle='radian'/><worldbody>" + bodies + ends +
                                    "</worldbody><equality>" + equalities + "</equality></mujoco>",
                                "couplings")
                     .get(),
                 nullptr, "couplings");
}

int CoupledId(const ModelPtr& m, const char* joint) { return FindId(m.get(), mjOBJ_JOINT, joint); }

TEST(Couplings, AreRelativeToReferencePositionsLikeInTheEngine) {
  const ModelPtr m = CoupledModel("<joint joint1='c' joint2='b' polycoef='.5 2 -1 .25 .125'/>");
  const ModelCouplings found = FindCouplings(m.get());
  ASSERT_THAT(found.followers, SizeIs(1));
  const CoupledJoint& c = found.followers[0];
  EXPECT_EQ(c.joint, CoupledId(m, "c"));
  EXPECT_EQ(c.leader, CoupledId(m, "b"));
  const double x = 0.7, dx = x - 0.1;
  EXPECT_NEAR(c.of_leader.at(x),
              0.2 + 0.5 + 2 * dx - dx * dx + 0.25 * std::pow(dx, 3) + 0.125 * std::pow(dx, 4),
              1e-15);
  const double h = 1e-5;
  EXPECT_NEAR(c.of_leader.slope(x), (c.of_leader.at(x + h) - c.of_leader.at(x - h)) / (2 * h),
              1e-9);
  EXPECT_NEAR(c.of_leader.curvature(x),
              (c.of_leader.slope(x + h) - c.of_leader.slope(x - h)) / (2 * h), 1e-9);
}

TEST(Couplings, OfFollowersOfFollowersAreComposed) {
  const ModelPtr m = CoupledModel(
      "<joint joint1='c' joint2='b' polycoef='.1 2 0 0 0'/>"
      "<joint joint1='d' joint2='c' polycoef='0 1 .3 .2 .1'/>"
      "<joint joint1='b' joint2='a' polycoef='0 -.5 0 0 0'/>"
      "<joint joint1='e' joint2='d' polycoef='0 3 0 0 0'/>");
  const ModelCouplings found = FindCouplings(m.get());
  ASSERT_THAT(found.followers, SizeIs(4));
  EXPECT_THAT(found.problems, IsEmpty());
  const auto bend = [](double d) {
    return d + 0.3 * d * d + 0.2 * d * d * d + 0.1 * d * d * d * d;
  };
  for (const double a : {-0.8, 0.0, 0.3}) {
    const double b = 0.1 - 0.5 * a, c = 0.2 + 0.1 + 2 * (b - 0.1), d = 0.3 + bend(c - 0.2);
    const double e = 0.4 + 3 * (d - 0.3);
    const std::array<double, 4> expected = {b, c, d, e};
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(found.followers[i].leader, CoupledId(m, "a"));
      EXPECT_NEAR(found.followers[i].of_leader.at(a), expected[i], 1e-14) << i;
    }
  }
  EXPECT_EQ(found.LeaderOf(CoupledId(m, "e")), CoupledId(m, "a"));
  EXPECT_EQ(found.LeaderOf(CoupledId(m, "a")), CoupledId(m, "a"));
}

TEST(Couplings, WithoutALeaderHoldAJointAndItsFollowers) {
  const ModelPtr m = CoupledModel(
      "<joint joint1='b' polycoef='.3 0 0 0 0'/><joint joint1='c' joint2='b' polycoef='0 1 0 0 "
      "0'/>");
  const ModelCouplings found = FindCouplings(m.get());
  ASSERT_THAT(found.followers, SizeIs(2));
  EXPECT_EQ(found.LeaderOf(CoupledId(m, "c")), -1);
  EXPECT_NEAR(found.Of(CoupledId(m, "b"))->of_leader.at(9), 0.4, 1e-15);
  EXPECT_NEAR(found.Of(CoupledId(m, "c"))->of_leader.at(9), 0.5, 1e-15);
}

TEST(Couplings, CountOnlyIfTheyAreActive) {
  EXPECT_THAT(
      FindCouplings(CoupledModel("<joint joint1='b' joint2='a' active='false'/>").get()).followers,
      IsEmpty());
  const ModelPtr m = CoupledModel("<joint joint1='b' joint2='a'/>");
  m->opt.disableflags |= mjDSBL_EQUALITY;
  EXPECT_THAT(FindCouplings(m.get()).followers, IsEmpty());
}

TEST(Couplings, ThatCannotBeComposedAreProblemsOfTheirJointsAlone) {
  const struct {
    const char* equalities;
    const char* why;
  } cases[] = {
      {"<joint joint1='b' joint2='a'/><joint joint1='a' joint2='b'/><joint joint1='e' joint2='d'/>",
       "joints 'b', 'a' follow each other in a circle"},
      {"<joint joint1='b' joint2='a'/><joint joint1='b' joint2='c'/><joint joint1='e' joint2='d'/>",
       "joint 'b' follows both 'a' and 'c'"},
      {"<joint joint1='b' joint2='a' polycoef='0 1 .1 0 0'/><joint joint1='c' joint2='b' "
       "polycoef='0 1 .1 0 0'/>"
       "<joint joint1='e' joint2='d'/>",
       "more than one bends"}};
  for (const auto& [equalities, why] : cases) {
    const ModelPtr m = CoupledModel(equalities);
    const ModelCouplings found = FindCouplings(m.get());
    ASSERT_NE(found.ProblemOf(CoupledId(m, "b")), nullptr) << why;
    EXPECT_THAT(found.ProblemOf(CoupledId(m, "b"))->why, HasSubstr(why));
    EXPECT_EQ(found.ProblemOf(CoupledId(m, "e")), nullptr);
    EXPECT_NE(found.Of(CoupledId(m, "e")), nullptr);
  }
}

TEST(Couplings, TheInverseOfAnAffineOneUndoesIt) {
  const JointPolynomial p{0.3, {0.7, -2.5, 0, 0, 0}};
  for (const double x : {-2.0, 0.0, 1.3}) EXPECT_NEAR(Inverse(p).at(p.at(x)), x, 1e-14);
}

}  // namespace
}  // namespace robocell
