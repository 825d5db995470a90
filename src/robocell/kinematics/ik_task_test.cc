// Inverse kinematics of more and less than a pose: every answer judged by the engine's kinematics
// for exactly what was asked.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/ik_solutions.h"
#include "robocell/kinematics/ik_task.h"
#include "robocell/kinematics/manipulability.h"
#include "robocell/kinematics/testing/ik_judge.h"
#include "robocell/testing/decompositions.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using Eigen::Vector3d;

// Random chains; targets that each reaches, turned and moved so that only what is asked for can be
// met.
class IkMore : public testing::TestWithParam<int> {
 protected:
  explicit IkMore(double limited_share = 0.8)
      : rng_(Rng::Stream(GetParam(), "more ik")),
        model_(TestModel::FromXml(
            RandomChainXml(&rng_,
                           {.joints = GetParam(), .slide_share = 0, .limited_share = limited_share})
                .Write())),
        chain_(model_.model(), "base", ChainTip::Site("tip")) {}

  Vector3d RandomDirection() {
    return Vector3d(rng_.Normal(), rng_.Normal(), rng_.Normal()).normalized();
  }
  Pose Reached() { return chain_.Fk(RandomJoints(chain_, &rng_)); }
  // The tip by the engine, in the axes of the target.
  Transform TipSeenFrom(const Pose& target, std::span<const double> q) {
    for (int i = 0; i < chain_.n_joints(); ++i)
      model_.data()->qpos[chain_.joints()[i].qpos_address] = q[i];
    mj_kinematics(model_.model(), model_.data());
    return ToTransform(target).inverse() * model_.TipInBase(chain_);
  }
  // Single and batched; the share that was solved. Solutions must satisfy `judge(tip in target)`.
  template <class Judge>
  double Solved(const std::vector<Pose>& targets, const IkOptions& options, const Judge& judge) {
    const IkBatchResult batch = IkBatch(chain_, targets, {}, {.ik = options});
    int good = 0, singles = 0;
    const auto check = [&](const Pose& target, std::span<const double> q, bool success) {
      EXPECT_TRUE(InLimits(chain_, q));
      if (!success) return 0;
      EXPECT_TRUE(judge(TipSeenFrom(target, q)));
      return 1;
    };
    for (int b = 0; b < batch.size; ++b) good += check(targets[b], batch.row(b), batch.success[b]);
    for (std::size_t b = 0; b < targets.size(); b += 5) {
      const IkResult one = Ik(chain_, targets[b], options);
      singles += check(targets[b], one.q, one.success);
    }
    EXPECT_GE(singles, 0.97 * static_cast<double>(targets.size()) / 5);
    return good / static_cast<double>(targets.size());
  }

  Rng rng_;
  TestModel model_;
  Chain chain_;
};
INSTANTIATE_TEST_SUITE_P(Joints, IkMore, testing::Values(6, 7, 9));

class IkMoreToSpare : public IkMore {};
INSTANTIATE_TEST_SUITE_P(Joints, IkMoreToSpare, testing::Values(7, 9));

constexpr double kTolerance = 1e-5, kNear = 1.0001 * kTolerance;

double AngleBetween(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

TEST_P(IkMore, PointsAnAxisWhereverTheTipIsTurnedAboutIt) {
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
    // Half of them as far off as the cone allows, and turned about the axis.
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

TEST_P(IkMore, WhatAnAxisReachesEveryConeReaches) {
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

TEST_P(IkMore, AnAxisThatPointsTheOtherWayIsTurnedAround) {
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

TEST_P(IkMore, WeightsSayWhatAnErrorCounts) {
  std::vector<Pose> targets;
  for (int b = 0; b < 200; ++b)
    targets.push_back(Reached() * Pose(Vector3d(0, 0, rng_.Uniform(-50, 50))));
  // Anywhere along the target's z axis.
  const IkOptions along{.position_weights = {1, 1, 0}};
  EXPECT_GE(Solved(targets, along,
                   [](const Transform& tip) {
                     return tip.translation.head<2>().norm() <= kNear &&
                            AngleBetween(tip.rotation.col(0), Vector3d::UnitX()) <= kNear &&
                            AngleBetween(tip.rotation.col(1), Vector3d::UnitY()) <= kNear;
                   }),
            0.99);
  // The tolerance is one of weighted errors: ten times as wide along x.
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

TEST_P(IkMore, OnlyATurnAboutOneAxisMayBeAskedFor) {
  std::vector<Pose> targets;
  for (int b = 0; b < 100; ++b) targets.push_back(Reached());
  const double solved = Solved(targets, {.rotation_weights = {0, 0, 1}}, [](const Transform& tip) {
    const Eigen::AngleAxisd turn(tip.rotation);
    return tip.translation.norm() <= kNear && std::abs(turn.angle() * turn.axis().z()) <= kNear;
  });
  EXPECT_GE(solved, 0.99);
}

double SquaredDistance(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(a[i] - b[i], 2);
  return sum;
}

// Cost of the preference in the options; less is better.
double Badness(const Chain& chain, const IkOptions& options, std::span<const double> q) {
  if (options.prefer == IkPrefer::kManipulability) return -Manipulability(chain, q);
  if (options.prefer != IkPrefer::kAwayFromLimits) {
    JointVector near = options.prefer == IkPrefer::kSeed ? options.seed : options.posture;
    for (int i = 0; i < near.size(); ++i)
      near[i] = std::clamp(near[i], chain.joints()[i].lower, chain.joints()[i].upper);
    return SquaredDistance(q, near);
  }
  double sum = 0;
  for (int i = 0; i < chain.n_joints(); ++i) {
    const ChainJoint& joint = chain.joints()[i];
    if (!joint.limited) continue;
    const double half = 0.5 * (joint.upper - joint.lower);
    sum += std::pow((q[i] - joint.lower - half) / half, 2);
  }
  return sum;
}

class IkPrefers : public IkMore {
 protected:
  IkPrefers() : IkMore(1) {}
};
INSTANTIATE_TEST_SUITE_P(Joints, IkPrefers, testing::Values(6, 7, 9));

class IkPrefersToSpare : public IkPrefers {};
INSTANTIATE_TEST_SUITE_P(Joints, IkPrefersToSpare, testing::Values(7, 9));

TEST_P(IkPrefers, IsMetBetterThanByTheFirstSolution) {
  for (const IkPrefer prefer : {IkPrefer::kSeed, IkPrefer::kPosture, IkPrefer::kAwayFromLimits,
                                IkPrefer::kManipulability}) {
    double first = 0, chosen = 0;
    int solved = 0, worse = 0;
    for (int k = 0; k < 40; ++k) {
      const Pose target = Reached();
      IkOptions options{.seed = RandomJoints(chain_, &rng_), .prefer = prefer};
      if (prefer == IkPrefer::kPosture) options.posture = RandomJoints(chain_, &rng_);
      const IkResult plain = Ik(chain_, target, {.seed = options.seed});
      const IkResult best = Ik(chain_, target, options);
      EXPECT_TRUE(InLimits(chain_, best.q));
      if (!plain.success || !best.success) continue;
      EXPECT_TRUE(EngineAgrees(model_, chain_, target, best.q, kNear));
      ++solved;
      const double before = Badness(chain_, options, plain.q);
      const double after = Badness(chain_, options, best.q);
      worse += after > before + 1e-9;
      first += before;
      chosen += after;
    }
    EXPECT_GE(solved, 39);
    EXPECT_LE(worse, 4) << static_cast<int>(prefer);  // the first hit may be lucky
    // Six joints have a handful of solutions to choose from.
    const double better = chain_.n_joints() == 6 ? 0 : 0.1 * std::abs(first);
    EXPECT_LT(chosen, first - better) << static_cast<int>(prefer);
  }
}

// With redundant joints no better solution is near: a step along any direction that does not move
// the tip is no improvement.
TEST_P(IkPrefersToSpare, IsMetAsWellAsTheJointsToSpareAllow) {
  for (const IkPrefer prefer : {IkPrefer::kPosture, IkPrefer::kAwayFromLimits}) {
    int settled = 0, counted = 0;
    for (int k = 0; k < 60; ++k) {
      IkOptions options{.prefer = prefer};
      const JointVector truth = RandomJoints(chain_, &rng_);
      if (prefer == IkPrefer::kPosture) {
        options.posture = truth;
        for (double& v : options.posture) v += rng_.Uniform(-0.3, 0.3);
      }
      const IkResult best = Ik(chain_, chain_.Fk(truth), options);
      if (!best.success) continue;
      bool at_limit = false;
      for (int i = 0; i < best.q.size(); ++i) {
        const ChainJoint& joint = chain_.joints()[i];
        at_limit |= best.q[i] < joint.lower + 0.02 || best.q[i] > joint.upper - 0.02;
      }
      if (at_limit) continue;
      ++counted;
      Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, chain_.n_joints());
      chain_.Jacobian(best.q, jacobian);
      const Eigen::MatrixXd spare = NullSpaceOf(jacobian);
      bool best_here = true;
      for (Eigen::Index c = 0; c < spare.cols(); ++c) {
        for (const double step : {-0.02, 0.02}) {
          JointVector moved = best.q;
          for (int i = 0; i < moved.size(); ++i) moved[i] += step * spare(i, c);
          best_here &= Badness(chain_, options, moved) > Badness(chain_, options, best.q);
        }
      }
      settled += best_here;
    }
    EXPECT_GE(counted, 10);
    // With many redundant joints some are still moving after the allowed steps.
    const double share = prefer == IkPrefer::kPosture ? 0.95 : 0.9;
    EXPECT_GE(settled, share * counted) << static_cast<int>(prefer);
  }
}

// An unreachable target is approached by the residuals of the query: if any rotation is accepted,
// the target's rotation makes no difference.
TEST_P(IkPrefers, ApproachesWhatIsOutOfReachByWhatWasAskedFor) {
  const IkFilter all = [](std::span<const double>, int, std::span<uint8_t> keep) {
    std::fill(keep.begin(), keep.end(), uint8_t{1});
  };
  std::vector<Pose> targets, turned;
  for (int k = 0; k < 40; ++k) {
    const Vector3d there = 1.2 * chain_.model().reach_bound * RandomDirection();
    targets.emplace_back(there, Reached().quaternion());
    turned.emplace_back(there, Reached().quaternion());
  }
  for (const IkOptions& options :
       {IkOptions{.position_only = true},
        IkOptions{.position_only = true, .prefer = IkPrefer::kAwayFromLimits},
        IkOptions{.position_only = true, .filter = all}}) {
    const IkBatchResult found = IkBatch(chain_, targets, {}, {.ik = options}),
                        other = IkBatch(chain_, turned, {}, {.ik = options});
    for (int b = 0; b < found.size; ++b) {
      EXPECT_FALSE(found.success[b]);
      EXPECT_TRUE(InLimits(chain_, found.row(b)));
      EXPECT_NEAR(found.position_error[b],
                  (chain_.Fk(found.row(b)).translation() - targets[b].translation()).norm(), 1e-9);
      EXPECT_NEAR(found.position_error[b], other.position_error[b], 1e-9);
    }
  }
}

TEST_P(IkPrefers, TheSameAloneInABatchAndOnThreads) {
  std::vector<Pose> targets;
  for (int b = 0; b < 150; ++b)
    targets.push_back(b % 7 == 6 ? Pose(Vector3d(40, b, 0)) : Reached());
  const IkFilter right = [](std::span<const double> q, int count, std::span<uint8_t> keep) {
    for (int k = 0; k < count; ++k) keep[k] = q[k * (q.size() / count)] > 0;
  };
  JointVector seed(chain_.n_joints(), 0.1);
  for (const IkOptions& options :
       {IkOptions{.prefer = IkPrefer::kSeed},
        IkOptions{.axis = Vector3d::UnitX(), .cone = 0.1, .prefer = IkPrefer::kAwayFromLimits},
        IkOptions{.position_weights = {1, 0.5, 0}}, IkOptions{.filter = right},
        IkOptions{.prefer = IkPrefer::kManipulability, .max_restarts = 16}}) {
    const IkBatchResult all = IkBatch(chain_, targets, seed, {.ik = options});
    const IkBatchResult threaded = IkBatch(chain_, targets, seed, {.ik = options, .threads = 3});
    EXPECT_EQ(all.q, threaded.q);
    EXPECT_EQ(all.iterations, threaded.iterations);
    std::vector<Pose> backwards(targets.rbegin(), targets.rend());
    const IkBatchResult reversed = IkBatch(chain_, backwards, seed, {.ik = options});
    for (int b = 0; b < all.size; b += 13) {
      EXPECT_TRUE(std::ranges::equal(all.row(b), reversed.row(all.size - 1 - b)));
      const IkBatchResult alone = IkBatch(chain_, {&targets[b], 1}, seed, {.ik = options});
      EXPECT_EQ(alone.success[0], all.success[b]);
      EXPECT_TRUE(std::ranges::equal(alone.q, all.row(b)));
    }
  }
}

TEST_P(IkMore, AFilterKeepsWhatItSaysAndTheSearchGoesOn) {
  int asked = 0;
  const IkFilter positive = [&](std::span<const double> q, int count, std::span<uint8_t> keep) {
    const std::size_t n = q.size() / count;
    EXPECT_EQ(n, static_cast<std::size_t>(chain_.n_joints()));
    for (int k = 0; k < count; ++k) keep[k] = q[k * n] > 0;
    asked += count;
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
  EXPECT_GT(asked, 60);

  const IkFilter none = [](std::span<const double>, int, std::span<uint8_t>) {};
  const IkResult refused = Ik(chain_, targets[0], {.filter = none});
  EXPECT_FALSE(refused.success);
  EXPECT_LE(refused.position_error, kTolerance) << "it is reached, but not kept";
}

TEST_P(IkMoreToSpare, TheUnmovedSolutionServesWhenTheMovedOneIsRefused) {
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

TEST_P(IkMore, AllSolutionsAreApartAndTrueAndNearestFirst) {
  const JointVector seed = RandomJoints(chain_, &rng_);
  for (int k = 0; k < 5; ++k) {
    const JointVector truth = RandomJoints(chain_, &rng_);
    const Pose target = chain_.Fk(truth);
    const std::vector<IkResult> all =
        IkSolutions(chain_, target, {.seed = seed, .max_restarts = 400});
    ASSERT_FALSE(all.empty());
    for (std::size_t a = 0; a < all.size(); ++a) {
      EXPECT_TRUE(EngineAgrees(model_, chain_, target, all[a].q, kNear));
      EXPECT_TRUE(InLimits(chain_, all[a].q));
      if (a > 0) {
        EXPECT_GE(SquaredDistance(all[a].q, seed), SquaredDistance(all[a - 1].q, seed));
      }
      for (std::size_t b = 0; b < a; ++b) {
        double apart = 0;
        for (int i = 0; i < seed.size(); ++i)
          apart = std::max(apart, std::abs(all[a].q[i] - all[b].q[i]));
        EXPECT_GT(apart, 0.05);
      }
    }
  }
}

TEST_P(IkMore, AllSolutionsEndWithTheExceptionOfTheirPoll) {
  int polls = 0;
  const auto poll = [&] {
    if (++polls == 3) throw Error("interrupted");
  };
  const IkOptions many{.max_restarts = 999};
  ExpectThrow<Error>([&] { IkSolutions(chain_, Reached(), many, 0.05, poll); }, "interrupted");
  EXPECT_EQ(polls, 3);
}

// Elbow up and elbow down, and nothing else: known in closed form.
TEST(IkSolutionsOfTwoLinks, AreBothElbows) {
  const TestModel t = TestModel::FromXml(
      "<mujoco><compiler angle='radian'/><worldbody><body name='base'><geom size='.1'/>"
      "<body><joint axis='0 0 1' range='-3.1 3.1'/><geom size='.1'/>"
      "<body pos='1 0 0'><joint axis='0 0 1' range='-3.1 3.1'/><geom size='.1'/>"
      "<site name='tip' pos='1 0 0'/></body></body></body></worldbody></mujoco>");
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const double elbow = 1.2, shoulder = 0.4;
  const Pose target = chain.Fk(JointVector{shoulder, elbow});
  std::vector<IkResult> all = IkSolutions(chain, target, {.position_only = true});
  ASSERT_EQ(all.size(), 2u);
  std::sort(all.begin(), all.end(), [](auto& a, auto& b) { return a.q[1] > b.q[1]; });
  EXPECT_NEAR(all[0].q[0], shoulder, 1e-4);
  EXPECT_NEAR(all[0].q[1], elbow, 1e-4);
  EXPECT_NEAR(all[1].q[0], shoulder + elbow, 1e-4);
  EXPECT_NEAR(all[1].q[1], -elbow, 1e-4);
  EXPECT_EQ(IkSolutions(chain, Pose(Vector3d(3, 0, 0)), {.position_only = true}).size(), 0u);
  const IkFilter up = [](std::span<const double> q, int count, std::span<uint8_t> keep) {
    for (int k = 0; k < count; ++k) keep[k] = q[2 * k + 1] > 0;
  };
  EXPECT_EQ(IkSolutions(chain, target, {.position_only = true, .filter = up}).size(), 1u);
  // Yoshikawa's textbook case: l1 l2 |sin(elbow)|, for the position. With the turn it is a 3 x 2
  // task.
  Eigen::Matrix<double, 6, 2> j;
  chain.Jacobian(all[0].q, j);
  EXPECT_NEAR(Manipulability(chain, all[0].q), std::sqrt((j.transpose() * j).determinant()), 1e-12);
}

// One redundant joint: solutions all around the turn, which begins again half a turn from the seed.
TEST(IkSolutionsOfThreeLinks, AreNotTheSameOnesATurnOn) {
  const TestModel t = TestModel::FromXml(
      "<mujoco><compiler angle='radian'/><worldbody><body name='base'><geom size='.1'/>"
      "<body><joint axis='0 0 1'/><geom size='.1'/>"
      "<body pos='1 0 0'><joint axis='0 0 1'/><geom size='.1'/>"
      "<body pos='1 0 0'><joint axis='0 0 1' range='-9 9'/><geom size='.1'/>"
      "<site name='tip' pos='1 0 0'/></body></body></body></body></worldbody></mujoco>");
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const std::vector<IkResult> all =
      IkSolutions(chain, Pose(Vector3d(0.4, 0.3, 0)),
                  {.seed = JointVector(3), .position_only = true, .max_restarts = 400}, 0.3);
  EXPECT_GT(all.size(), 10u);
  for (std::size_t a = 0; a < all.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      double apart = 0;
      for (int i = 0; i < 3; ++i) {
        const double way = all[a].q[i] - all[b].q[i];
        apart = std::max(apart, std::abs(std::remainder(way, 2 * std::numbers::pi)));
      }
      EXPECT_GT(apart, 0.3);
    }
  }
}

TEST(IkMoreOptions, AnAxisMayHaveAnyLength) {
  for (const double length : {1e-8, 1.0, 1e155, 1e300})
    EXPECT_NEAR(IkTask({.axis = length * Vector3d::UnitY()}).axis.y(), 1, 1e-15) << length;
}

TEST(IkMoreOptions, MakeSense) {
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
          "axis and rotation_weights both say what of the rotation counts; leave one out");
  refused({.axis = Vector3d::Zero()},
          "axis is (0, 0, 0); it must be a direction in the tip's frame");
  refused({.axis = Vector3d::UnitX(), .cone = 4}, "cone is 4; it must be an angle from 0 to less");
  refused({.cone = 0.1}, "cone is 0.1 rad, but no axis is given that may be off by it. Give axis");
  refused({.prefer = IkPrefer::kPosture}, "inverse kinematics: posture");
  refused({.prefer = IkPrefer::kSeed},
          "the solution near the seed is preferred, but there is no seed. Give one, or a posture");
  refused({.posture = JointVector(7)}, "there is a posture, but prefer does not ask for it");
  ExpectThrow<ArgumentError>([&] { IkSolutions(chain, target, {}, 0); },
                             "separation is 0; it must be more than 0");
  ExpectThrow<ArgumentError>(
      [&] { IkSolutions(chain, target, {.max_restarts = std::numeric_limits<int>::max()}); },
      "2147483648 starts for all solutions; there may be up to 1000000");
  // The same without any targets.
  ExpectThrow<ArgumentError>([&] { IkBatch(chain, {}, {}, {.ik = {.tolerance = -1}}); },
                             "tolerance is -1; it must be more than 0");
  ExpectThrow<ArgumentError>([&] { IkBatch(chain, {}, {}, {.ik = {.axis = Vector3d::Zero()}}); },
                             "axis is (0, 0, 0)");
  EXPECT_EQ(IkBatch(chain, {}, {}, {.ik = {.locked = {true}, .prefer = IkPrefer::kSeed}}).size, 0);
}

}  // namespace
}  // namespace robocell
