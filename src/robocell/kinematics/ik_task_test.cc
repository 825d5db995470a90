// Tests inverse kinematics of more and less than a pose: the engine's kinematics judges every
// result for exactly the requested part.
#include "robocell/kinematics/ik_task.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/ik_solutions.h"
#include "robocell/kinematics/testing/ik_judge.h"
#include "robocell/kinematics/testing/random_chain_ik.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using Eigen::Vector3d;

class IkMore : public IkOfRandomChain {};
INSTANTIATE_TEST_SUITE_P(Joints, IkMore, testing::Values(6, 7, 9));

class IkMoreWithRedundancy : public IkMore {};
INSTANTIATE_TEST_SUITE_P(Joints, IkMoreWithRedundancy, testing::Values(7, 9));

double AngleBetween(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

TEST_P(IkMore, PointsAnAxisWithFreeRotationAboutIt) {
  const Vector3d axis = RandomDirection();
  std::vector<Pose> targets;
  for (int b = 0; b < 300; ++b)
    targets.push_back(
        Reached() *
        Pose(Vector3d::Zero(), Eigen::AngleAxisd(rng_.Uniform(-3, 3), axis).toRotationMatrix()));
  const double solved = Solved(targets, {.axis = 2.5 * axis}, [&](const Transform& tip) {
    return tip.translation.norm() <= kNear && AngleBetween(tip.rotation * axis, axis) <= kNear;
  });
  EXPECT_GE(solved, 0.99);
}

TEST_P(IkMore, OneRotationWeightOfZeroIsAnAxis) {
  std::vector<Pose> targets;
  for (int b = 0; b < 200; ++b)
    targets.push_back(Reached() * Pose::FromRpy(Vector3d::Zero(), {0, rng_.Uniform(-3, 3), 0}));
  const double solved = Solved(targets, {.rotation_weights = {1, 0, 1}}, [](const Transform& tip) {
    return tip.translation.norm() <= kNear &&
           AngleBetween(tip.rotation.col(1), Vector3d::UnitY()) <= kNear;
  });
  EXPECT_GE(solved, 0.99);
}

TEST_P(IkMore, AConeIsReachedWithinItsAngle) {
  const Vector3d axis = RandomDirection();
  const double cone = 0.3;
  std::vector<Pose> targets;
  for (int b = 0; b < 300; ++b) {
    // Half of them are as far off as the cone allows, and turned about the axis.
    const double tilt = b % 2 ? cone : rng_.Uniform(0, cone);
    const Pose off(
        Vector3d::Zero(),
        Eigen::AngleAxisd(tilt, axis.cross(RandomDirection()).normalized()).toRotationMatrix());
    const Pose turned(Vector3d::Zero(),
                      Eigen::AngleAxisd(rng_.Uniform(-3, 3), axis).toRotationMatrix());
    targets.push_back(Reached() * off * turned);
  }
  int away = 0;
  const double solved = Solved(targets, {.axis = axis, .cone = cone}, [&](const Transform& tip) {
    const double angle = AngleBetween(tip.rotation * axis, axis);
    away += angle > 0.5 * cone;
    return tip.translation.norm() <= kNear && angle <= cone + kNear;
  });
  EXPECT_GE(solved, 0.99);
  EXPECT_GT(away, 0) << "the whole cone is used";
}

TEST_P(IkMore, EveryConeReachesWhatItsAxisReaches) {
  const Vector3d axis = RandomDirection();
  std::vector<Pose> targets;
  for (int b = 0; b < 1500; ++b) targets.push_back(Reached());
  const auto solve = [&](double cone) {
    return IkBatch(chain_, targets, {}, {.ik = {.axis = axis, .cone = cone}});
  };
  const IkBatchResult exact = solve(0);
  const auto steps = [](const IkBatchResult& result) {
    return std::accumulate(result.iterations.begin(), result.iterations.end(), 0);
  };
  for (const double cone : {1e-9, 1e-7, 1e-5, 1e-3, 0.02, 0.05, 0.1, 0.3, 1.0}) {
    const IkBatchResult found = solve(cone);
    for (int b = 0; b < found.size; ++b) {
      EXPECT_GE(found.success[b], exact.success[b]) << cone << ", target " << b;
      if (!found.success[b]) continue;
      const Transform tip = TipSeenFrom(targets[b], found.row(b));
      EXPECT_LE(tip.translation.norm(), kNear);
      EXPECT_LE(AngleBetween(tip.rotation * axis, axis), cone + kNear);
    }
    EXPECT_LE(steps(found), 1.5 * steps(exact)) << cone;
  }
}

TEST_P(IkMore, NarrowConesAreReachedAtTheirBorder) {
  const Vector3d axis = RandomDirection(), across = axis.unitOrthogonal();
  for (const double cone : {1e-4, 1e-2, 0.04}) {
    std::vector<Pose> targets;
    for (int b = 0; b < 200; ++b)
      targets.push_back(Reached() *
                        Pose(Vector3d::Zero(), Eigen::AngleAxisd(cone, across).toRotationMatrix()));
    const double solved = Solved(targets, {.axis = axis, .cone = cone}, [&](const Transform& tip) {
      return tip.translation.norm() <= kNear &&
             AngleBetween(tip.rotation * axis, axis) <= cone + kNear;
    });
    EXPECT_GE(solved, 0.99) << cone;
  }
}

TEST_P(IkMore, AReversedAxisIsTurnedAround) {
  const auto angle_left = [&](const Pose& target, const IkResult& found) {
    const Vector3d axis = TipSeenFrom(target, found.q).rotation.col(2);
    return AngleBetween(axis, Vector3d::UnitZ());
  };
  int solved = 0;
  for (int k = 0; k < 40; ++k) {
    const JointVector q = RandomJoints(chain_, &rng_);
    const Pose target = chain_.Fk(q) * Pose::FromRpy(Vector3d::Zero(), {std::numbers::pi, 0, 0});
    const double cone = k % 2 ? 0.2 : 0;
    for (const int restarts : {0, 100}) {
      const IkResult found =
          Ik(chain_, target,
             {.seed = q, .axis = Vector3d::UnitZ(), .cone = cone, .max_restarts = restarts});
      EXPECT_GT(found.iterations, 0);
      EXPECT_LT(angle_left(target, found), 3.0) << "the one that points the other way is no answer";
      if (!found.success) continue;  // it may be out of reach
      EXPECT_LE(angle_left(target, found), cone + kNear);
      solved += restarts > 0;
    }
  }
  EXPECT_GE(solved, 20);
}

TEST_P(IkMore, WeightsScaleErrors) {
  std::vector<Pose> targets;
  for (int b = 0; b < 200; ++b)
    targets.push_back(Reached() * Pose(Vector3d(0, 0, rng_.Uniform(-50, 50))));
  // Accepts a position anywhere along the target's z axis.
  const IkOptions along{.position_weights = {1, 1, 0}};
  EXPECT_GE(Solved(targets, along,
                   [](const Transform& tip) {
                     return tip.translation.head<2>().norm() <= kNear &&
                            AngleBetween(tip.rotation.col(0), Vector3d::UnitX()) <= kNear &&
                            AngleBetween(tip.rotation.col(1), Vector3d::UnitY()) <= kNear;
                   }),
            0.99);
  // The tolerance applies to weighted errors: it is ten times as wide along x.
  targets.clear();
  for (int b = 0; b < 200; ++b) targets.push_back(Reached());
  const IkOptions coarse{.position_weights = {0.1, 1, 1}, .rotation_weights = {2, 1, 0.5}};
  EXPECT_GE(Solved(targets, coarse,
                   [](const Transform& tip) {
                     const Vector3d p = tip.translation;
                     const Eigen::AngleAxisd turn(tip.rotation);
                     const Vector3d r = turn.angle() * turn.axis();
                     return Vector3d(0.1 * p.x(), p.y(), p.z()).norm() <= kNear &&
                            Vector3d(2 * r.x(), r.y(), 0.5 * r.z()).norm() <= kNear;
                   }),
            0.99);
}

TEST_P(IkMore, ConstrainsTheRotationAboutOneAxisOnly) {
  std::vector<Pose> targets;
  for (int b = 0; b < 100; ++b) targets.push_back(Reached());
  const double solved = Solved(targets, {.rotation_weights = {0, 0, 1}}, [](const Transform& tip) {
    const Eigen::AngleAxisd turn(tip.rotation);
    return tip.translation.norm() <= kNear && std::abs(turn.angle() * turn.axis().z()) <= kNear;
  });
  EXPECT_GE(solved, 0.99);
}

TEST_P(IkMore, TheSearchContinuesAfterTheFilterRejectsASolution) {
  int total = 0;
  const IkFilter positive = [&](std::span<const double> q, int count, std::span<uint8_t> keep) {
    const std::size_t n = q.size() / count;
    EXPECT_EQ(n, static_cast<std::size_t>(chain_.n_joints()));
    for (int k = 0; k < count; ++k) keep[k] = q[k * n] > 0;
    total += count;
  };
  std::vector<Pose> targets;
  while (targets.size() < 60) {
    const JointVector q = RandomJoints(chain_, &rng_);
    if (q[0] > 0.2) targets.push_back(chain_.Fk(q));
  }
  const IkBatchResult plain = IkBatch(chain_, targets);
  const IkBatchResult found = IkBatch(chain_, targets, {}, {.ik = {.filter = positive}});
  int other = 0;
  for (int b = 0; b < found.size; ++b) {
    other += plain.row(b)[0] <= 0;
    if (!found.success[b]) continue;
    EXPECT_GT(found.row(b)[0], 0);
    EXPECT_TRUE(EngineAgrees(model_, chain_, targets[b], found.row(b), kNear));
  }
  EXPECT_GT(other, 0);
  EXPECT_GE(found.solved(), 57);
  EXPECT_GT(total, 60);

  const IkFilter none = [](std::span<const double>, int, std::span<uint8_t>) {};
  const IkResult refused = Ik(chain_, targets[0], {.filter = none});
  EXPECT_FALSE(refused.success);
  EXPECT_LE(refused.position_error, kTolerance) << "it is reached, but not kept";
}

TEST_P(IkMoreWithRedundancy, FallsBackToTheOriginalSolutionIfTheFilterRejects) {
  const JointVector posture = RandomJoints(chain_, &rng_);
  const Pose target = chain_.Fk(posture);
  const IkFilter not_there = [&](std::span<const double> q, int count, std::span<uint8_t> keep) {
    const std::size_t n = q.size() / count;
    for (int k = 0; k < count; ++k) keep[k] = SquaredDistance(q.subspan(k * n, n), posture) > 0.01;
  };
  const IkResult found =
      Ik(chain_, target, {.prefer = IkPrefer::kPosture, .posture = posture, .filter = not_there});
  ASSERT_TRUE(found.success);
  EXPECT_GT(SquaredDistance(found.q, posture), 0.01);
}

TEST(IkMoreOptions, AcceptAnAxisOfAnyLength) {
  for (const double length : {1e-8, 1.0, 1e155, 1e300})
    EXPECT_NEAR(IkTask({.axis = length * Vector3d::UnitY()}).axis.y(), 1, 1e-15) << length;
}

TEST(IkMoreOptions, AreValidated) {
  Rng rng = Rng::Stream(1, "options");
  const TestModel t = TestModel::FromXml(RandomChainXml(&rng, {.joints = 7}).Write());
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const Pose target = chain.Fk(RandomJoints(chain, &rng));
  const auto refused = [&](const IkOptions& options, const std::string& text) {
    ExpectThrow<ArgumentError>([&] { Ik(chain, target, options); }, text);
  };
  refused({.position_weights = {1, -1, 1}}, "position_weights holds -1; each must be 0 (any value");
  refused({.rotation_weights = {1, NAN, 1}}, "rotation_weights holds nan");
  refused({.position_weights = {0, 0, 0}, .rotation_weights = {0, 0, 0}},
          "all weights are 0, so that the target has no residual");
  refused({.position_only = true, .axis = Vector3d::UnitX()},
          "position_only and axis contradict each other; leave one out");
  refused({.rotation_weights = {1, 1, 0}, .axis = Vector3d::UnitX()},
          "axis and rotation_weights both constrain the rotation; leave one out");
  refused({.axis = Vector3d::Zero()},
          "axis is (0, 0, 0); it must be a direction in the tip's frame");
  refused({.axis = Vector3d::UnitX(), .cone = 4}, "cone is 4; it must be an angle from 0 to less");
  refused({.cone = 0.1}, "cone is 0.1 rad, but no axis is given that may be off by it. Give axis");
  refused({.prefer = IkPrefer::kPosture}, "inverse kinematics: posture");
  refused({.prefer = IkPrefer::kSeed},
          "the solution near the seed is preferred, but there is no seed. Give one, or a posture");
  refused({.posture = JointVector(7)}, "a posture is given, but prefer is not 'posture'");
  ExpectThrow<ArgumentError>([&] { IkSolutions(chain, target, {}, 0); },
                             "separation is 0; it must be more than 0");
  ExpectThrow<ArgumentError>(
      [&] { IkSolutions(chain, target, {.max_restarts = std::numeric_limits<int>::max()}); },
      "2147483648 starts for all solutions; there may be up to 1000000");
  // The same error without any targets.
  ExpectThrow<ArgumentError>([&] { IkBatch(chain, {}, {}, {.ik = {.tolerance = -1}}); },
                             "tolerance is -1; it must be more than 0");
  ExpectThrow<ArgumentError>([&] { IkBatch(chain, {}, {}, {.ik = {.axis = Vector3d::Zero()}}); },
                             "axis is (0, 0, 0)");
  EXPECT_EQ(IkBatch(chain, {}, {}, {.ik = {.locked = {true}, .prefer = IkPrefer::kSeed}}).size, 0);
}

}  // namespace
}  // namespace robocell::internal
