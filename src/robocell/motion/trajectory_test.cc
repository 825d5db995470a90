#include "robocell/motion/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using Path = std::vector<std::vector<double>>;

Path RandomPath(Rng& rng, int points, int joints) {
  Path path;
  for (int k = 0; k < points; ++k) {
    path.emplace_back();
    for (int i = 0; i < joints; ++i) path.back().push_back(rng.Uniform(-2, 2));
  }
  return path;
}

TEST(Trajectory, KeepsAllLimitsAndItsOwnDerivatives) {
  Rng rng = Rng::Stream(1, "paths");
  for (int run = 0; run < 30; ++run) {
    const MotionLimits limits{.velocity = {rng.Uniform(0.2, 3), 2},
                              .acceleration = {rng.Uniform(0.5, 10)},
                              .jerk = {rng.Uniform(2, 100), 50}};
    const Trajectory motion = TimePath(RandomPath(rng, 4, 2), limits);
    const double h = 1e-4;
    TrajectoryPoint last = motion.At(0);
    for (double t = h; t < motion.duration(); t += 0.01) {
      const TrajectoryPoint before = motion.At(t - h), now = motion.At(t);
      for (int i = 0; i < 2; ++i) {
        const double v = limits.velocity[i], a = limits.acceleration[0], j = limits.jerk[i];
        EXPECT_LE(std::abs(now.velocity[i]), v * (1 + 1e-6));
        EXPECT_LE(std::abs(now.acceleration[i]), a * (1 + 1e-6));
        EXPECT_LE(std::abs(now.acceleration[i] - before.acceleration[i]), j * h * (1 + 1e-4));
        EXPECT_NEAR(now.position[i] - before.position[i],
                    h * (now.velocity[i] + before.velocity[i]) / 2, j * h * h * h + 1e-9);
        EXPECT_NEAR(now.velocity[i] - before.velocity[i],
                    h * (now.acceleration[i] + before.acceleration[i]) / 2, j * h * h + 1e-9);
      }
    }
  }
}

TEST(Trajectory, StaysOnThePathAndRestsAtItsWaypoints) {
  Rng rng = Rng::Stream(2, "paths");
  const Path path = RandomPath(rng, 5, 3);
  const Trajectory motion = TimePath(path);
  EXPECT_EQ(motion.At(0).position, path.front());
  EXPECT_EQ(motion.At(motion.duration()).position, path.back());
  EXPECT_EQ(motion.At(1e9).position, path.back());
  EXPECT_EQ(motion.n_joints(), 3);
  const Path rows = motion.Sample(0.01);
  EXPECT_EQ(rows.front(), path.front());
  EXPECT_EQ(rows.back(), path.back());
  for (const std::vector<double>& q : rows) {  // on one of the lines
    double nearest = 1e9;
    for (size_t k = 1; k < path.size(); ++k) {
      double along = 0, length = 0, off = 0;
      for (int i = 0; i < 3; ++i) {
        const double d = path[k][i] - path[k - 1][i];
        along += d * (q[i] - path[k - 1][i]);
        length += d * d;
      }
      along = std::min(1.0, std::max(0.0, along / length));
      for (int i = 0; i < 3; ++i)
        off += std::pow(path[k - 1][i] + along * (path[k][i] - path[k - 1][i]) - q[i], 2);
      nearest = std::min(nearest, off);
    }
    EXPECT_LT(nearest, 1e-18);
  }
}

TEST(Trajectory, TakesTheLeastTime) {
  // Half a metre at 1 m/s with 4 m/s^2 and hardly any limit of jerk: 0.5 s and one ramp more.
  const MotionLimits limits{.velocity = {1}, .acceleration = {4}, .jerk = {1e5}};
  EXPECT_NEAR(TimePath(Path{{0}, {0.5}}, limits).duration(), 0.75, 1e-3);
  EXPECT_NEAR(TimePath(Path{{0}, {0.5}, {0.5}, {0}}, limits).duration(), 1.5, 2e-3);
  EXPECT_EQ(TimePath(Path{{0}, {0}}, limits).duration(), 0);
  EXPECT_EQ(TimePath(Path{{0}}, limits).duration(), 0);
}

TEST(Trajectory, VerySmallAndVeryLargeMotionsWork) {
  for (const double length : {1e-9, 1e-4, 1.0, 1e3}) {
    const Trajectory motion = TimePath(Path{{0, 0}, {length, -length}});
    EXPECT_GT(motion.duration(), 0) << length;
    EXPECT_NEAR(motion.At(motion.duration() / 2).position[0], length / 2, 1e-6 * length);
  }
}

TEST(Trajectory, RejectsLimitsAndPathsThatMakeNoSense) {
  const Path path = {{0, 0}, {1, 1}};
  ExpectThrow<ArgumentError>(
      [&] {
        TimePath(path, {.velocity = {1, 2, 3}});
      },
      "velocity has 3 values, expected 1 or 2");
  ExpectThrow<ArgumentError>([&] { TimePath(path, {.acceleration = {0}}); }, "above 0");
  ExpectThrow<ArgumentError>(
      [&] { TimePath(path, {.jerk = {std::numeric_limits<double>::quiet_NaN()}}); }, "jerk");
  ExpectThrow<ArgumentError>([&] { TimePath(Path{}); }, "no waypoints");
  ExpectThrow<ArgumentError>([&] { TimePath(Path{{0, 0}, {1}}); }, "waypoint 1 has 1 values");
  ExpectThrow<ArgumentError>([&] { TimePath(path).Sample(0); }, "tick");
}

TEST(WhyTooSlow, NamesTheJointWhoseLimitsCount) {
  const Path path = {{0, 0}, {1, 1}};
  const std::vector<std::string> names = {"shoulder", "elbow"};
  const MotionLimits limits{.velocity = {1, 0.1}};
  EXPECT_EQ(WhyTooSlow(path, limits, 100, names), "");
  const std::string why = WhyTooSlow(path, limits, 2, names);
  EXPECT_NE(why.find("joint 'elbow' alone takes"), std::string::npos) << why;
}

}  // namespace
}  // namespace robocell
