#include "robocell/mujoco/coupled_positions.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/mujoco/compile.h"

namespace robocell::internal {
namespace {

constexpr int kJoints = 6;

// Joints j0 ... j5 with ranges, given as "range" attributes, and equality constraints.
ModelPtr WithCouplings(const std::array<std::string, kJoints>& ranges,
                       const std::string& equality) {
  std::string bodies;
  for (int i = 0; i < kJoints; ++i) {
    bodies += fmt::format(R"(<body><joint name="j{}" {}/><geom size=".1"/></body>)", i, ranges[i]);
  }
  const std::string xml =
      R"(<mujoco><compiler angle="radian"/><default><joint axis="0 0 1"/></default><worldbody>)" +
      bodies + "</worldbody><equality>" + equality + "</equality></mujoco>";
  return Compile(ParseXmlString(xml, "coupled").get(), nullptr, "coupled");
}

std::string Coupling(int follower, int leader, const std::string& coefficients) {
  return fmt::format(R"(<joint joint1="j{}" joint2="j{}" polycoef="{}"/>)", follower, leader,
                     coefficients);
}

// Returns the largest error of the model's constraints.
double ErrorOf(const mjModel* m, const std::vector<double>& q) {
  double worst = 0;
  for (int e = 0; e < m->neq; ++e) {
    if (!m->eq_active0[e]) continue;
    const mjtNum* c = m->eq_data + mjNEQDATA * e;
    const int a = m->eq_obj1id[e], b = m->eq_obj2id[e];
    const double x = b < 0 ? 0 : q[b] - m->qpos0[b];
    const double y = c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * c[4])));
    worst = std::max(worst, std::abs(q[a] - m->qpos0[a] - y));
  }
  return worst;
}

bool AreInside(const mjModel* m, const std::vector<double>& q) {
  for (int j = 0; j < m->njnt; ++j) {
    if (m->jnt_limited[j] && (q[j] < m->jnt_range[2 * j] || q[j] > m->jnt_range[2 * j + 1]))
      return false;
  }
  return true;
}

std::vector<double> Default(const mjModel* m) { return {m->qpos0, m->qpos0 + m->nq}; }

std::string RandomPolynomial(Rng& rng) {
  std::string out = "0";
  const bool bends = rng.UniformInt(3) == 0;
  for (int p = 1; p < 5; ++p)
    out += fmt::format(" {}", p == 1 || bends ? rng.Uniform(-1.5, 1.5) : 0.0);
  return out;
}

TEST(CoupledPositions, SatisfyAllConstraintsAndLimits) {
  Rng rng = Rng::Stream(7, "couplings");
  int moved = 0;
  for (int round = 0; round < 400; ++round) {
    std::array<std::string, kJoints> ranges;
    for (std::string& range : ranges) {
      if (rng.UniformInt(3) == 0) continue;
      range = fmt::format(R"(limited="true" range="{} {}")", rng.Uniform(-1.5, -0.02),
                          rng.Uniform(0.02, 1.5));
    }
    std::string equality;
    // Also chains, circles, two leaders, joints that are held and polynomials of polynomials.
    for (uint64_t count = rng.UniformInt(5); count > 0; --count) {
      const int follower = static_cast<int>(rng.UniformInt(kJoints));
      const int leader = static_cast<int>(rng.UniformInt(kJoints));
      equality += follower == leader
                      ? fmt::format(R"(<joint joint1="j{}" polycoef="0.01"/>)", leader)
                      : Coupling(follower, leader, RandomPolynomial(rng));
    }
    const ModelPtr m = WithCouplings(ranges, equality);
    std::vector<int> joints;
    std::vector<double> offsets;
    for (int j = 0; j < kJoints; ++j) {
      if (rng.UniformInt(3) == 0) continue;
      joints.push_back(j);
      offsets.push_back(rng.Uniform(-2, 2));
    }
    std::vector<double> q = Default(m.get());
    const double before = ErrorOf(m.get(), q);
    MoveCoupled(m.get(), joints, offsets, q.data());
    const std::string what = fmt::format("round {}: {}", round, equality);
    EXPECT_LE(ErrorOf(m.get(), q), std::max(before, 1e-9)) << what;
    EXPECT_TRUE(AreInside(m.get(), q)) << what;
    moved += q != Default(m.get());
  }
  EXPECT_GT(moved, 350);
}

TEST(CoupledPositions, OfJointsWithoutCouplingsAddTheOffsets) {
  const ModelPtr m = WithCouplings({"", R"(range="-1 0.2")"}, Coupling(4, 5, "0 1 0 0 0"));
  std::vector<double> q = Default(m.get());
  MoveCoupled(m.get(), std::vector<int>{0, -1, 1}, std::vector<double>{0.3, 9, 0.4}, q.data());
  EXPECT_EQ(q, (std::vector<double>{0.3, 0.2, 0, 0, 0, 0}));
}

TEST(CoupledPositions, KeepAListedFollowerWithItsLeader) {
  const ModelPtr m = WithCouplings({}, Coupling(1, 0, "0 -1 0 0 0"));
  std::vector<double> q = Default(m.get());
  MoveCoupled(m.get(), std::vector<int>{0, 1}, std::vector<double>{0.3, 0.1}, q.data());
  EXPECT_EQ(q[0], 0.3);
  EXPECT_EQ(q[1], -0.3);
}

TEST(CoupledPositions, StopALeaderAtTheLimitOfItsFollower) {
  const ModelPtr m = WithCouplings({"", R"(range="-4 4")"}, Coupling(1, 0, "0 -3 0 0 0"));
  std::vector<double> q = Default(m.get());
  MoveCoupled(m.get(), std::vector<int>{0}, std::vector<double>{1.9}, q.data());
  EXPECT_NEAR(q[0], 4. / 3, 1e-12);
  EXPECT_EQ(q[1], -4);
}

TEST(CoupledPositions, MoveTheLeaderOfAListedFollower) {
  const ModelPtr m = WithCouplings({}, Coupling(1, 0, "0 2 0 0 0") + Coupling(2, 0, "0 0 1 0 0"));
  std::vector<double> q = Default(m.get());
  MoveCoupled(m.get(), std::vector<int>{1}, std::vector<double>{0.4}, q.data());
  EXPECT_EQ(q, (std::vector<double>{0.2, 0.4, 0.04000000000000001, 0, 0, 0}));
}

TEST(CoupledPositions, DoNotMoveAJointWhoseLeaderCannotFollow) {
  const ModelPtr m = WithCouplings({}, Coupling(1, 0, "0 0 1 0 0"));
  std::vector<double> q = Default(m.get());
  MoveCoupled(m.get(), std::vector<int>{1}, std::vector<double>{0.4}, q.data());
  EXPECT_EQ(q, Default(m.get()));
}

TEST(CoupledPositions, StayWithoutAnOffset) {
  const ModelPtr m = WithCouplings({}, Coupling(1, 0, "0 -1 0 0 0"));
  std::vector<double> q = {0.4, 0.1, 0.2, 0, 0, 0};  // not on the constraint
  MoveCoupled(m.get(), std::vector<int>{0, 1, 2}, std::vector<double>{0, 0, 0.1}, q.data());
  EXPECT_EQ(q, (std::vector<double>{0.4, 0.1, 0.2 + 0.1, 0, 0, 0}));
}

TEST(CoupledPositions, PlaceFollowersWhereTheListedJointsHaveThem) {
  const ModelPtr m = WithCouplings({}, Coupling(1, 0, "0 -1 0 0 0"));
  std::vector<double> q = {0.4, 0, 0.2, 0, 0, 0};
  PlaceFollowers(m.get(), std::vector<int>{0, 2}, q.data());
  EXPECT_EQ(q, (std::vector<double>{0.4, -0.4, 0.2, 0, 0, 0}));
}

}  // namespace
}  // namespace robocell::internal
