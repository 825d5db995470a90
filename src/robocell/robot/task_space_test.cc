// Tests the part of a pose that counts for an arm: laws of the nearest pose, and inverse kinematics.
#include "robocell/robot/task_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <Eigen/QR>

#include "robocell/base/rng.h"
#include "robocell/kinematics/testing/models.h"
#include "robocell/math/rotation.h"

namespace robocell::internal {
namespace {

Pose RandomPose(Rng& rng, double size) {
  return {
      Eigen::Vector3d(rng.Uniform(-size, size), rng.Uniform(-size, size), rng.Uniform(-size, size)),
      RandomQuaternion(rng)};
}

double AngleOfAxes(const Pose& a, const Pose& b, const Eigen::Vector3d& axis) {
  const Eigen::Vector3d u = Rotate(a.quaternion(), axis), v = Rotate(b.quaternion(), axis);
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

TEST(TaskSpace, TheNearestPoseAgreesWithTheTargetWhereItCounts) {
  Rng rng = Rng::Stream(1, "task space");
  for (int trial = 0; trial < 200; ++trial) {
    const Pose target = RandomPose(rng, 1), tip = RandomPose(rng, 1);
    const Pose any = TaskSpace({.kind = TaskSpaceKind::kPosition}).Nearest(target, tip);
    EXPECT_EQ(any.translation(), target.translation());
    EXPECT_LT(AngleBetween(any.quaternion(), tip.quaternion()), 1e-9);

    const Vec3 axis = {rng.Uniform(-1, 1), rng.Uniform(-1, 1), rng.Uniform(-1, 1)};
    const Eigen::Vector3d unit = ToEigen(axis).normalized();
    const double cone = trial % 2 ? rng.Uniform(0, 1) : 0;
    const TaskSpace swings({.kind = TaskSpaceKind::kAxis, .axis = axis, .cone = cone});
    const Pose near = swings.Nearest(target, tip);
    const double before = AngleOfAxes(target, tip, unit);
    EXPECT_EQ(near.translation(), target.translation());
    EXPECT_NEAR(AngleOfAxes(near, target, unit), std::min(cone, before), 1e-7);
    EXPECT_NEAR(AngleBetween(near.quaternion(), tip.quaternion()), std::max(before - cone, 0.0),
                1e-7)
        << "no rotation is smaller";
    EXPECT_LT(AngleBetween(swings.Nearest(target, near).quaternion(), near.quaternion()), 1e-6);

    const TaskSpace floats({.position_weights = Vec3{1, 0, 1}});
    const Eigen::Vector3d rest =
        Rotate(QuaternionInverse(target.quaternion()),
               floats.Nearest(target, tip).translation() - target.translation());
    EXPECT_NEAR(rest.x(), 0, 1e-9);
    EXPECT_NEAR(rest.z(), 0, 1e-9);
    EXPECT_EQ(TaskSpace().Nearest(target, tip).translation(), target.translation());
  }
}

// Draws weights of rotations and positions, often 0, with the rest of the configuration.
TaskSpaceConfig RandomConfig(Rng& rng) {
  const auto weights = [&rng] {
    Vec3 drawn;
    for (double& w : drawn) w = rng.Uniform(0, 1) < 0.5 ? 0 : rng.Uniform(0.1, 3);
    return drawn;
  };
  TaskSpaceConfig config;
  if (rng.Uniform(0, 1) < 0.5) {
    config.position_weights = weights();
    if (*config.position_weights == Vec3{0, 0, 0}) config.position_weights = Vec3{0, 1, 0};
  }
  const double kind = rng.Uniform(0, 1);
  if (kind < 0.2) {
    config.kind = TaskSpaceKind::kPosition;
  } else if (kind < 0.4) {
    config.kind = TaskSpaceKind::kAxis;
    config.axis = Vec3{rng.Uniform(-1, 1), rng.Uniform(-1, 1), rng.Uniform(-1, 1)};
    config.cone = rng.Uniform(0, 1) < 0.5 ? 0 : rng.Uniform(0, 0.5);
  } else {
    config.rotation_weights = weights();
  }
  return config;
}

// Returns the part of the error that counts, m and rad, from the definition: weights are along the
// axes of the target, and with one 0 among the rotations the direction of that axis counts.
std::pair<double, double> CountedError(const TaskSpaceConfig& config, const Pose& target,
                                       const Pose& tip) {
  const Pose off = target.inverse() * tip;
  const auto weighed = [](const Eigen::Vector3d& v, const std::optional<Vec3>& weights) {
    return weights ? ToEigen(*weights).cwiseProduct(v).norm() : v.norm();
  };
  const double position = weighed(off.translation(), config.position_weights);
  if (config.kind == TaskSpaceKind::kPosition) return {position, 0};
  if (config.kind == TaskSpaceKind::kAxis) {
    const double angle = AngleOfAxes(target, tip, ToEigen(*config.axis).normalized());
    return {position, std::max(0.0, angle - *config.cone)};
  }
  const Vec3& weights = *config.rotation_weights;
  if (std::ranges::count(weights, 0.0) == 1) {
    const auto free = std::ranges::find(weights, 0.0) - weights.begin();
    double least = 10;
    for (const double w : weights) least = w > 0 ? std::min(least, w) : least;
    return {position, least * AngleOfAxes(target, tip, Eigen::Vector3d::Unit(free))};
  }
  return {position, weighed(off.rotvec(), weights)};
}

// The oracle of the nearest rotation is a search over all that are accepted.
double LeastAngle(const TaskSpaceConfig& config, const Pose& target, const Pose& tip) {
  const Vec3 weights = *config.rotation_weights;
  const auto angle_at = [&](const Eigen::Vector3d& turn) {
    return AngleBetween(QuaternionProduct(target.quaternion(), QuaternionFromRotvec(turn)),
                        tip.quaternion());
  };
  Eigen::Vector3d free;
  for (int i = 0; i < 3; ++i) free[i] = weights[static_cast<size_t>(i)] == 0 ? 1 : 0;
  double least = 10;
  for (int start = 0; start < 27; ++start) {
    Eigen::Vector3d at =
        Eigen::Vector3d(start % 3 - 1, start / 3 % 3 - 1, start / 9 - 1).cwiseProduct(free) * 1.5;
    double best = angle_at(at);
    for (double step = 1; step > 1e-8;) {
      bool better = false;
      for (int k = 0; k < 6; ++k) {
        const Eigen::Vector3d next =
            at + (k % 2 ? step : -step) * free[k / 2] * Eigen::Vector3d::Unit(k / 2);
        if (const double angle = angle_at(next); angle < best)
          best = angle, at = next, better = true;
      }
      if (!better) step /= 2;
    }
    least = std::min(least, best);
  }
  return least;
}

TEST(TaskSpace, ZeroWeightsAcceptAnyValueAndTheNearestPoseHasTheLeastTurn) {
  Rng rng = Rng::Stream(4, "weights");
  for (int trial = 0; trial < 300; ++trial) {
    const TaskSpaceConfig config = RandomConfig(rng);
    const TaskSpace task(config);
    const Pose target = RandomPose(rng, 1), tip = RandomPose(rng, 1);
    const Pose near = task.Nearest(target, tip);
    const auto [position, rotation] = CountedError(config, target, near);
    EXPECT_NEAR(position, 0, 1e-9) << trial;
    EXPECT_NEAR(rotation, 0, 1e-6) << trial;
    const Pose again = task.Nearest(target, near);
    EXPECT_TRUE(again.is_close(near, 1e-9, 1e-6)) << trial;
    if (!config.rotation_weights || trial % 4 != 0) continue;
    const double angle = AngleBetween(near.quaternion(), tip.quaternion());
    EXPECT_NEAR(angle, LeastAngle(config, target, tip), 1e-5) << trial;
  }
}

// Half a turn about an axis whose weight alone is above 0: all accepted rotations are equally near.
TEST(TaskSpace, HalfATurnAboutTheOnlyAxisThatCountsLeadsToTheTarget) {
  const TaskSpace task({.rotation_weights = Vec3{0, 0, 1}});
  const Pose target = Pose::FromRpy(Eigen::Vector3d::Zero(), {0.3, 0.2, 0.1});
  const Pose tip = target * Pose::FromRpy(Eigen::Vector3d::Zero(), {0, 0, std::numbers::pi});
  EXPECT_LT(AngleBetween(task.Nearest(target, tip).quaternion(), target.quaternion()), 1e-6);
}

// Steps of random chains to targets whose part that counts is a small motion away, and the rest
// anywhere.
TEST(TaskSpace, StepsReachWhatCountsAlongTheAxesOfTheTarget) {
  Rng rng = Rng::Stream(5, "weighed steps");
  int reached = 0, tried = 0;
  for (int trial = 0; trial < 150; ++trial) {
    const TestModel model = TestModel::FromXml(
        RandomChainXml(&rng, {.joints = 6 + trial % 2, .slide_share = 0.1, .limited_share = 1})
            .Write());
    const Chain chain(model.model(), "base", ChainTip::Site("tip"));
    JointVector from(chain.n_joints());
    for (int i = 0; i < from.size(); ++i) {
      const ChainJoint& joint = chain.joints()[i];
      from[i] = joint.lower + rng.Uniform(0.3, 0.7) * (joint.upper - joint.lower);
    }
    const TaskSpaceConfig config = RandomConfig(rng);
    const TaskSpace task(config);
    const Pose tip = chain.Fk(from);
    const Pose any(tip.translation() + RandomPose(rng, 0.2).translation(), RandomQuaternion(rng));
    // `any` moved to where the tip agrees with it, and a little away.
    const Pose agreed = task.Nearest(any, tip);
    const Pose shift = tip * agreed.inverse();
    const Pose little =
        Pose::FromRpy(RandomPose(rng, 2e-3).translation(), RandomPose(rng, 2e-2).translation());
    const Pose target = Pose(tip.translation(), Quaternion{0, 0, 0, 1}) * little *
                        Pose(-tip.translation(), Quaternion{0, 0, 0, 1}) * shift * any;
    const IkResult found = task.Step(chain, target, from);
    ++tried;
    if (!found.success) continue;
    ++reached;
    const auto [position, rotation] = CountedError(config, target, chain.Fk(found.q));
    EXPECT_LE(position, 1.01e-5) << trial;
    EXPECT_LE(rotation, 1.01e-5) << trial;
  }
  EXPECT_GE(reached, tried * 85 / 100) << tried;
}

// The rows of the weighed Jacobian are the derivatives of the weighed error, and no error is left
// where the tip agrees with the reference in what counts.
TEST(TaskSpace, TheProjectedErrorIsWhatCounts) {
  Rng rng = Rng::Stream(6, "projected errors");
  for (int trial = 0; trial < 300; ++trial) {
    const TaskSpaceConfig config = RandomConfig(rng);
    const TaskSpace task(config);
    const Pose target = RandomPose(rng, 1);
    const Pose reference = task.Nearest(target, RandomPose(rng, 1));
    const Pose tip = trial % 2 ? task.Nearest(target, RandomPose(rng, 1))
                               : reference * Pose::FromRotvec(RandomPose(rng, 0.02).translation(),
                                                              RandomPose(rng, 0.05).translation());
    const auto error_at = [&](const Pose& at, Eigen::Matrix<double, 6, Eigen::Dynamic>* rows) {
      Eigen::Vector<double, 6> error;
      const Quaternion turn =
          QuaternionProduct(reference.quaternion(), QuaternionInverse(at.quaternion()));
      error << reference.translation() - at.translation(), RotvecFromQuaternion(turn);
      Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian =
          Eigen::Matrix<double, 6, Eigen::Dynamic>::Identity(6, 6);
      task.Project(target, reference, at, error, jacobian);
      if (rows) *rows = jacobian;
      return error;
    };
    Eigen::Matrix<double, 6, Eigen::Dynamic> rows;
    const Eigen::Vector<double, 6> error = error_at(tip, &rows);
    const bool is_same = CountedError(config, target, tip).first < 1e-9 &&
                         CountedError(config, target, tip).second < 1e-6;
    if (is_same && config.cone.value_or(0) == 0) {
      EXPECT_LT(error.norm(), 1e-6) << trial;
    } else if (trial % 2 == 0) {
      // A step along the rows removes the error to first order.
      const Eigen::Vector<double, 6> step = rows.completeOrthogonalDecomposition().solve(error);
      const Pose moved(tip.translation() + step.head<3>(),
                       QuaternionProduct(QuaternionFromRotvec(step.tail<3>()), tip.quaternion()));
      EXPECT_LE(error_at(moved, nullptr).norm(), 0.2 * error.norm() + 1e-6) << trial;
    }
  }
}

// The oracle is forward kinematics: what counts of the solution's pose is the target's.
TEST(TaskSpace, StepsReachWhatCountsAndStayNear) {
  Rng rng = Rng::Stream(2, "task space steps");
  for (const bool whole_axis : {false, true}) {
    const TaskSpace task = whole_axis ? TaskSpace({.kind = TaskSpaceKind::kAxis})
                                      : TaskSpace({.kind = TaskSpaceKind::kPosition});
    int reached = 0, tried = 0;
    for (int trial = 0; trial < 40; ++trial) {
      const TestModel model = TestModel::FromXml(
          RandomChainXml(&rng, {.joints = 5 + trial % 3, .slide_share = 0.1, .limited_share = 1})
              .Write());
      const Chain chain(model.model(), "base", ChainTip::Site("tip"));
      JointVector from(chain.n_joints());
      for (int i = 0; i < from.size(); ++i) {
        const ChainJoint& joint = chain.joints()[i];
        from[i] = joint.lower + rng.Uniform(0.3, 0.7) * (joint.upper - joint.lower);
      }
      const Pose tip = chain.Fk(from);
      const Pose target(tip.translation() + RandomPose(rng, 4e-3).translation(),
                        whole_axis ? tip.quaternion() : RandomQuaternion(rng));
      const IkResult found = task.Step(chain, target, from);
      ++tried;
      if (!found.success) continue;
      ++reached;
      const Pose got = chain.Fk(found.q);
      EXPECT_LE((got.translation() - target.translation()).norm(), 1e-5);
      if (whole_axis) {
        EXPECT_LE(AngleOfAxes(got, target, Eigen::Vector3d::UnitZ()), 1e-5);
      }
    }
    EXPECT_GE(reached, tried * 9 / 10);
  }
}

TEST(TaskSpace, FewJointsReachThePositionUnlessAPoseIsConfigured) {
  Rng rng = Rng::Stream(3, "few joints");
  const TestModel model = TestModel::FromXml(RandomChainXml(&rng, {.joints = 5}).Write());
  const Chain chain(model.model(), "base", ChainTip::Site("tip"));
  EXPECT_TRUE(TaskSpace().reaches_position_first(chain));
  EXPECT_FALSE(TaskSpace({.kind = TaskSpaceKind::kPose}).reaches_position_first(chain));
  EXPECT_EQ(TaskSpace().text(), "");
  EXPECT_EQ(TaskSpace({.kind = TaskSpaceKind::kPosition}).text(), "the position alone");
}

}  // namespace
}  // namespace robocell::internal
