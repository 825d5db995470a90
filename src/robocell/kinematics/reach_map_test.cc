// Tests the reach map against geometry known in closed form, and against existing configurations.
#include "robocell/kinematics/reach_map.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "robocell/kinematics/manipulability.h"
#include "robocell/kinematics/testing/arm_tables.h"
#include "robocell/kinematics/testing/models.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/long_form.h"

namespace robocell {
namespace {

using Eigen::Vector3d;

// Two links of 0.6 and 0.4 m on a ball of three hinges, and a wrist of three: the tip reaches every
// point between 0.2 and 1 m from the centre, in every rotation.
constexpr char kBallArm[] =
    "<mujoco><compiler angle='radian' autolimits='true'/>"
    "<default><joint range='-3.14159 3.14159'/><geom size='.01'/></default><worldbody>"
    "<body name='base'><geom/><body><joint axis='0 0 1'/><joint axis='0 1 0'/><geom/>"
    "<body pos='0.6 0 0'><joint axis='0 1 0'/><geom/>"
    "<body pos='0.4 0 0'><joint axis='1 0 0'/><joint axis='0 1 0'/><joint axis='1 0 0'/><geom/>"
    "<site name='tip'/></body></body></body></body></worldbody></mujoco>";

TEST(ReachMap, IsTheShellOfTwoLinks) {
  const TestModel t = TestModel::FromXml(kBallArm);
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const ReachGrid grid{.lower = {-1.1, -1.1, 0}, .upper = {1.1, 1.1, 0}, .cell = 0.1};
  const ReachMap map = MapReach(chain, grid, {.rotations = 24, .max_restarts = 20});
  EXPECT_EQ(map.cells, (std::array{22, 22, 1}));
  EXPECT_EQ(map.centre(0, 0, 0), Vector3d(-1.05, -1.05, 0));
  int inside = 0, outside = 0;
  for (int x = 0; x < map.cells[0]; ++x) {
    for (int y = 0; y < map.cells[1]; ++y) {
      const double r = map.centre(x, y, 0).norm();
      const float fraction = map.fraction[map.index(x, y, 0)];
      if (r > 1.01 || r < 0.19) {
        EXPECT_EQ(fraction, 0) << r;
        EXPECT_EQ(map.manipulability[map.index(x, y, 0)], 0);
        ++outside;
      } else if (r > 0.22 && r < 0.98) {
        EXPECT_GE(fraction, 0.95) << r;
        EXPECT_GT(map.manipulability[map.index(x, y, 0)], 0);
        ++inside;
      }
    }
  }
  EXPECT_GT(inside, 200);
  EXPECT_GT(outside, 100);
}

// The first joints of the ball arm, and a tip on the last of them.
std::string Shorter(const std::string& wrist) {
  std::string xml = kBallArm;
  const std::string whole = "<joint axis='1 0 0'/><joint axis='0 1 0'/><joint axis='1 0 0'/>";
  return xml.replace(xml.find(whole), whole.size(), wrist);
}

TEST(ReachMap, OfFiveJointsUsesAnAxisDirection) {
  const TestModel t = TestModel::FromXml(Shorter("<joint axis='1 0 0'/><joint axis='0 1 0'/>"));
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const ReachGrid grid{.lower = {0.3, 0.3, 0.1}, .upper = {0.5, 0.5, 0.3}, .cell = 0.1};
  const ReachMap whole = MapReach(chain, grid, {.max_restarts = 20});
  const ReachMap axis = MapReach(chain, grid, {.axis = Vector3d::UnitX(), .max_restarts = 20});
  EXPECT_EQ(axis.rotations, 64);
  for (std::size_t cell = 0; cell < axis.fraction.size(); ++cell) {
    EXPECT_LE(whole.fraction[cell], 0.1);
    EXPECT_GE(axis.fraction[cell], 0.95);
  }
}

TEST(ReachMap, OfThreeJointsUsesPositionsOnly) {
  const TestModel t = TestModel::FromXml(Shorter(""));
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const ReachGrid grid{.lower = {-1.1, -1.1, 0}, .upper = {1.1, 1.1, 0}, .cell = 0.1};
  const ReachMap map = MapReach(chain, grid, {.position_only = true});
  EXPECT_EQ(map.rotations, 1);
  int inside = 0;
  for (int x = 0; x < map.cells[0]; ++x) {
    for (int y = 0; y < map.cells[1]; ++y) {
      const double r = map.centre(x, y, 0).norm();
      if (r > 0.99 && r < 1.01) continue;
      EXPECT_EQ(map.fraction[map.index(x, y, 0)], r > 0.21 && r < 0.99 ? 1 : 0) << r;
      inside += r < 0.99;
    }
  }
  EXPECT_GT(inside, 200);
}

// A shoulder that does not turn all the way round leaves a wedge without starts: configurations
// that reach into it come from either side, and the few starts of a map have to find them from
// both.
TEST(ReachMap, CoversBothSidesOfAShouldersLimits) {
  for (const char* shoulder : {"-170 170", "-175 160"}) {
    if (!LongForm() && shoulder == std::string_view("-170 170")) continue;
    const TestModel t = TestModel::FromXml(fmt::format(
        "<mujoco><compiler autolimits='true'/><default><geom size='.01'/></default><worldbody>"
        "<body name='base'><geom/><body pos='0 0 .25'><joint axis='0 0 -1' range='{}'/><geom/>"
        "<body pos='.05 0 .2'><joint axis='0 -1 0' range='-120 80'/><geom/>"
        "<body pos='0 0 .46'><joint axis='0 -1 0' range='-160 10'/><geom/>"
        "<body pos='0 0 .36'><joint axis='0 0 -1' range='-180 180'/><geom/>"
        "<body pos='0 0 .12'><joint axis='0 -1 0' range='-125 125'/><geom/>"
        "<body pos='0 0 .07'><joint axis='0 0 -1'/><geom/><site name='tip' pos='0 0 .13'/>"
        "</body></body></body></body></body></body></body></worldbody></mujoco>",
        shoulder));
    const Chain chain(t.model(), "base", ChainTip::Site("tip"));
    const ReachGrid grid{.lower = {-1, -0.4, 0.4}, .upper = {-0.4, 0.4, 0.4}, .cell = 0.1};
    const ReachMap map = MapReach(chain, grid);
    const ReachMap all = MapReach(chain, grid, {.max_restarts = 100});
    double found = 0, there = 0;
    for (std::size_t cell = 0; cell < all.fraction.size(); ++cell) {
      EXPECT_GE(map.fraction[cell], all.fraction[cell] - 0.1F) << shoulder << ": cell " << cell;
      found += map.fraction[cell];
      there += all.fraction[cell];
    }
    EXPECT_GT(there, 0.2 * static_cast<double>(all.fraction.size()));
    EXPECT_GE(found, 0.99 * there) << shoulder;
  }
}

// Few starts miss whole regions inside the reach; solutions of adjacent cells lead inside.
TEST(ReachMap, HasNoHolesWithManyStarts) {
  for (const std::vector<TableRow>& rows : {Puma560(), OffsetSevenJoints()}) {
    const TestModel t = TestModel::FromXml(ArmXml(rows));
    const Chain chain(t.model(), "base", ChainTip::Site("tip"));
    const double upper = LongForm() ? 0.6 : 0;  // the short form tries a quarter of the plane
    const ReachGrid grid{.lower = {-0.6, -0.6, 0.3}, .upper = {upper, upper, 0.3}};
    const ReachMap map = MapReach(chain, grid);
    const ReachMap all = MapReach(chain, grid, {.max_restarts = 99});
    float most = 0;
    for (std::size_t cell = 0; cell < all.fraction.size(); ++cell) {
      EXPECT_GE(map.fraction[cell], all.fraction[cell] - 0.05F) << rows.size() << " " << cell;
      most = std::max(most, all.fraction[cell]);
    }
    EXPECT_GT(most, 0.5F);
  }
}

// The map must not show a place as unreachable if a configuration puts the tip there.
TEST(ReachMap, ContainsPositionsOfRandomConfigurations) {
  Rng rng = Rng::Stream(1, "reach map");
  const TestModel t = TestModel::FromXml(
      RandomChainXml(&rng, {.joints = 7, .slide_share = 0, .limited_share = 1}).Write());
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  int known = 0;
  for (int k = 0; k < 50; ++k) {
    JointVector q(7);
    for (int i = 0; i < 7; ++i)
      q[i] = rng.Uniform(chain.joints()[i].lower, chain.joints()[i].upper);
    const Vector3d there = chain.Fk(q).translation();
    const ReachMap map = MapReach(chain, {there, there, 0.01});
    ASSERT_EQ(map.fraction.size(), 1u);
    known += map.fraction[0] > 0;
  }
  EXPECT_GE(known, 45) << "64 rotations may miss a place that is reached in few";
}

TEST(ReachMap, IsTheSameOnThreadsAndContainsTheWholeChain) {
  const TestModel t = TestModel::FromXml(kBallArm);
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const ReachGrid grid = ReachGrid::Around(chain, 0.4);
  const ReachMap one = MapReach(chain, grid, {.rotations = 8}),
                 two = MapReach(chain, grid, {.rotations = 8, .threads = 2});
  EXPECT_EQ(one.fraction, two.fraction);
  EXPECT_EQ(one.manipulability, two.manipulability);
  for (std::size_t cell = 0; cell < one.fraction.size(); ++cell) {
    const auto [x, y, z] = one.cell_at(cell);
    EXPECT_EQ(one.index(x, y, z), cell);
  }
  EXPECT_EQ(one.fraction.front(), 0) << "corners are out of reach";
  EXPECT_EQ(one.fraction.back(), 0);
  EXPECT_GT(*std::max_element(one.fraction.begin(), one.fraction.end()), 0.5F);
}

TEST(SpreadRotation, CoversAllRotationsEvenly) {
  constexpr int kCount = 200;
  // Every rotation is within about the spacing of one of them.
  Rng rng = Rng::Stream(2, "rotations");
  double farthest = 0;
  for (int k = 0; k < 300; ++k) {
    const Eigen::Vector4d q =
        Eigen::Vector4d(rng.Normal(), rng.Normal(), rng.Normal(), rng.Normal()).normalized();
    double nearest = 4;
    for (int i = 0; i < kCount; ++i) {
      const Quaternion s = SpreadRotation(i, kCount);
      const double dot = std::abs(q[0] * s[0] + q[1] * s[1] + q[2] * s[2] + q[3] * s[3]);
      nearest = std::min(nearest, 2 * std::acos(std::min(1.0, dot)));
    }
    farthest = std::max(farthest, nearest);
  }
  EXPECT_LT(farthest, 0.75);  // 200 balls of 0.75 rad have eleven times the volume of all rotations
}

TEST(ReachMap, RejectsInvalidArguments) {
  const TestModel t = TestModel::FromXml(kBallArm);
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const ReachGrid box{.lower = {-1, -1, 0}, .upper = {1, 1, 0}};
  const auto refused = [&](const ReachGrid& grid, const ReachMapOptions& options,
                           const std::string& text) {
    ExpectThrow<ArgumentError>([&] { MapReach(chain, grid, options); }, text);
  };
  refused({.lower = {1, 0, 0}, .upper = {0, 0, 0}}, {},
          "reach map: the corners are (1, 0, 0) and (0, 0, 0); they must be finite, and the first");
  refused({.lower = box.lower, .upper = box.upper, .cell = 0}, {}, "cell is 0 m; it must be more");
  refused(box, {.rotations = 0}, "rotations is 0; it must be 1 to 100000");
  refused(box, {.rotations = std::numeric_limits<int>::max()}, "rotations is 2147483647; it must");
  // Out of reach, so that there are no queries.
  const ReachGrid far{.lower = {99, 0, 0}, .upper = {99, 0, 0}};
  refused(far, {.tolerance = -1}, "tolerance is -1; it must be more than 0");
  refused(far, {.threads = 0}, "threads is 0; it must be 1 or more");
  refused(box, {.tolerance = 0}, "tolerance is 0; it must be more than 0");
  refused({.lower = box.lower, .upper = box.upper, .cell = 1e-5}, {},
          "more than 2^31 poses with cells of 1e-05 m and 64 rotations; take larger cells");
  int polls = 0;
  ExpectThrow<Error>(
      [&] {
        MapReach(chain, box, {.poll = [&] {
                   if (++polls == 3) throw Error("interrupted");
                 }});
      },
      "interrupted");
}

}  // namespace
}  // namespace robocell
