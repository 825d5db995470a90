// Tests joint velocities against finite differences, the engine and the conditions of optimality.
#include "robocell/kinematics/differential_ik.h"

#include <gtest/gtest.h>

#include <cmath>

#include "robocell/kinematics/pose_error.h"
#include "robocell/kinematics/testing/ik_judge.h"
#include "robocell/testing/decompositions.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using Eigen::Vector3d;

class DifferentialIkTest : public testing::TestWithParam<int> {
 protected:
  DifferentialIkTest()
      : rng_(Rng::Stream(GetParam(), "differential ik")),
        model_(TestModel::FromXml(
            RandomChainXml(&rng_, {.joints = GetParam(), .slide_share = 0.15, .limited_share = 1})
                .Write())),
        chain_(model_.model(), "base", ChainTip::Site("tip")) {}

  Vector3d RandomVector() { return {rng_.Normal(), rng_.Normal(), rng_.Normal()}; }
  Twist RandomTwist() { return {0.3 * RandomVector(), RandomVector()}; }
  JointVector Inside() {
    JointVector q(chain_.n_joints());
    for (int i = 0; i < q.size(); ++i) {
      const ChainJoint& joint = chain_.joints()[i];
      q[i] = joint.lower + rng_.Uniform(0.2, 0.8) * (joint.upper - joint.lower);
    }
    return q;
  }
  // Returns the true motion of the tip, by differences of forward kinematics.
  Twist Measured(const JointVector& q, const JointVector& velocity) {
    constexpr double kStep = 1e-6;
    JointVector before = q, after = q;
    for (int i = 0; i < q.size(); ++i) {
      before[i] -= kStep * velocity[i];
      after[i] += kStep * velocity[i];
    }
    const internal::PoseError error =
        internal::ErrorTo(ToTransform(chain_.Fk(after)), ToTransform(chain_.Fk(before)));
    return {error.linear / (2 * kStep), error.angular / (2 * kStep)};
  }

  Rng rng_;
  TestModel model_;
  Chain chain_;
};
INSTANTIATE_TEST_SUITE_P(Joints, DifferentialIkTest, testing::Values(6, 7, 9));

TEST_P(DifferentialIkTest, MovesTheTipByTheTwistInEveryFrame) {
  int exact = 0;
  for (int k = 0; k < 60; ++k) {
    const JointVector q = Inside();
    const Twist target = RandomTwist();
    const Pose base = Pose::FromRpy(Vector3d::Zero(), {0.4, -1.1, 2});
    for (const TwistFrame frame : {TwistFrame::kBase, TwistFrame::kTip, TwistFrame::kWorld}) {
      const DifferentialIkResult found =
          DifferentialIk(chain_, q, target, {.frame = frame, .base_in_world = base.rotation()});
      Twist really = Measured(q, found.velocity);
      if (frame == TwistFrame::kTip) really = Rotated(chain_.Fk(q).inverse().quaternion(), really);
      if (frame == TwistFrame::kWorld) really = Rotated(base.quaternion(), really);
      EXPECT_NEAR((really.vector() - found.twist.vector()).norm(), 0,
                  1e-5 * (1 + found.velocity.size()));
      if (found.slower) continue;
      ++exact;
      EXPECT_LT((really.vector() - target.vector()).norm(), 0.02 * target.vector().norm());
    }
  }
  EXPECT_GT(exact, 30);
}

// The engine's Jacobian times the velocities is the twist in the world.
TEST_P(DifferentialIkTest, AgreesWithTheEnginesJacobian) {
  const mjModel* m = model_.model();
  mjData* d = model_.data();
  const JointVector q = Inside();
  for (int i = 0; i < q.size(); ++i) d->qpos[chain_.joints()[i].qpos_address] = q[i];
  mj_kinematics(m, d);
  mj_comPos(m, d);
  using Rows = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;
  Rows linear(3, m->nv), angular(3, m->nv);
  mj_jacSite(m, d, linear.data(), angular.data(), mj_name2id(m, mjOBJ_SITE, "tip"));
  const DifferentialIkResult found = DifferentialIk(chain_, q, RandomTwist());
  Vector3d moves = Vector3d::Zero(), turns = Vector3d::Zero();
  for (int i = 0; i < q.size(); ++i) {
    const int dof = chain_.joints()[i].dof_address;
    moves += linear.col(dof) * found.velocity[i];
    turns += angular.col(dof) * found.velocity[i];
  }
  const int base = mj_name2id(m, mjOBJ_BODY, "base");
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> axes(d->xmat + 9 * base);
  EXPECT_NEAR((axes.transpose() * moves - found.twist.linear).norm(), 0, 1e-9);
  EXPECT_NEAR((axes.transpose() * turns - found.twist.angular).norm(), 0, 1e-9);
}

// Checks optimality of bounded least squares (W. Karush 1939): the residual pulls at no free joint,
// and at the others only towards their bounds. This is exact where the damping is negligible.
TEST_P(DifferentialIkTest, IsOptimalWithinItsBounds) {
  const int n = chain_.n_joints();
  int bounded = 0, judged = 0, exact = 0;
  for (int k = 0; k < 60; ++k) {
    JointVector q = Inside();
    q[k % n] = k % 2 ? chain_.joints()[k % n].lower : chain_.joints()[k % n].upper;
    DifferentialIkOptions options{.seconds = 0.1, .max_speed = JointVector(n)};
    for (double& most : options.max_speed) most = rng_.Uniform(0.05, 1);
    if (k % 3 == 0) options.posture = Inside();
    const Twist target = RandomTwist();
    const DifferentialIkResult found = DifferentialIk(chain_, q, target, options);
    Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, n);
    chain_.Jacobian(q, jacobian);
    jacobian.topRows(3) /= chain_.model().length;
    Eigen::Matrix<double, 6, 1> task = target.vector();
    task.head(3) /= chain_.model().length;
    const Eigen::VectorXd pull =
        jacobian.transpose() *
        (task - jacobian * Eigen::Map<const Eigen::VectorXd>(found.velocity.data(), n));
    const auto low = [&](int i) {
      return std::max(-options.max_speed[i], (chain_.joints()[i].lower - q[i]) / options.seconds);
    };
    const auto high = [&](int i) {
      return std::min(options.max_speed[i], (chain_.joints()[i].upper - q[i]) / options.seconds);
    };
    Eigen::MatrixXd free(6, 0);
    for (int i = 0; i < n; ++i) {
      EXPECT_GE(found.velocity[i], low(i) - 1e-12);
      EXPECT_LE(found.velocity[i], high(i) + 1e-12);
      if (found.velocity[i] == low(i) || found.velocity[i] == high(i)) {
        ++bounded;
        continue;
      }
      free.conservativeResize(6, free.cols() + 1);
      free.rightCols(1) = jacobian.col(i);
    }
    if (free.cols() > 0) {
      const Eigen::VectorXd singular = SvdOf(free).values;
      if ((singular.array() < 0.02 && singular.array() > 1e-9).any()) continue;
    }
    ++judged;
    double worst = 0;
    for (int i = 0; i < n; ++i) {
      if (found.velocity[i] < high(i)) worst = std::max(worst, pull[i]);
      if (found.velocity[i] > low(i)) worst = std::max(worst, -pull[i]);
    }
    // Directions that joints at bounds remove are damped; the others are then slightly less than
    // optimal.
    EXPECT_LT(worst, 3e-3);
    exact += worst < 1e-6;
  }
  EXPECT_GT(bounded, 60);
  EXPECT_GT(judged, 30);
  EXPECT_GT(exact, 0.9 * judged);
}

// Covers all twists, chains and configurations.
TEST(DifferentialIk, ObeysItsBoundsOnEveryChain) {
  for (int joints = 1; joints <= 12; ++joints) {
    Rng rng = Rng::Stream(joints, "any differential ik");
    const TestModel t = TestModel::FromXml(
        RandomChainXml(&rng, {.joints = joints, .slide_share = 0.3, .tiny_share = 0.2}).Write());
    const Chain chain(t.model(), "base", ChainTip::Site("tip"));
    for (int k = 0; k < 60; ++k) {
      JointVector q = RandomJoints(chain, &rng);
      DifferentialIkOptions options{.seconds = 0.02, .max_speed = JointVector(joints)};
      for (int i = 0; i < joints; ++i) {
        options.max_speed[i] = rng.Uniform(0.1, 2);
        options.locked[i] = rng.Uniform() < 0.1;
        if (k % 3 == 0) q[i] += rng.Uniform(-0.1, 0.1);  // some beyond their limits
      }
      if (k % 2) options.posture = RandomJoints(chain, &rng);
      const Vector3d linear(rng.Normal(), rng.Normal(), rng.Normal());
      const Twist target{linear, Vector3d(rng.Normal(), rng.Normal(), rng.Normal())};
      const DifferentialIkResult found = DifferentialIk(chain, q, target, options);
      Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, joints);
      chain.Jacobian(q, jacobian);
      Eigen::Matrix<double, 6, 1> moved = -found.twist.vector();
      for (int i = 0; i < joints; ++i) {
        const double v = found.velocity[i], most = options.max_speed[i];
        const ChainJoint& joint = chain.joints()[i];
        EXPECT_TRUE(std::abs(v) <= most) << joint.name;
        moved += jacobian.col(i) * v;
        if (options.locked[i]) {
          EXPECT_EQ(v, 0) << joint.name;
          continue;
        }
        // After the time it is within the limits, or coming back as fast as allowed.
        const double after = q[i] + v * options.seconds;
        EXPECT_TRUE(after >= joint.lower - 1e-12 || v == most) << joint.name;
        EXPECT_TRUE(after <= joint.upper + 1e-12 || v == -most) << joint.name;
      }
      EXPECT_LT(moved.norm(), 1e-9);
    }
  }
}

TEST_P(DifferentialIkTest, AMotionStaysWithinTheLimits) {
  constexpr double kSeconds = 0.01;
  JointVector q = Inside();
  const Twist away{.linear = {1, 0.4, 0.2}};
  for (int k = 0; k < 500; ++k) {
    const DifferentialIkResult now = DifferentialIk(
        chain_, q, away, {.seconds = kSeconds, .max_speed = JointVector(q.size(), 2)});
    for (int i = 0; i < q.size(); ++i) {
      EXPECT_LE(std::abs(now.velocity[i]), 2);
      q[i] += kSeconds * now.velocity[i];
      EXPECT_GE(q[i], chain_.joints()[i].lower - 1e-9);
      EXPECT_LE(q[i], chain_.joints()[i].upper + 1e-9);
    }
  }
}

TEST_P(DifferentialIkTest, APostureMovesRedundantJointsAndNotTheTip) {
  const int n = chain_.n_joints();
  int judged = 0;
  for (int k = 0; k < 30; ++k) {
    const JointVector q = Inside();
    const JointVector posture = Inside();
    const Twist target = k % 3 == 0 ? Twist{} : RandomTwist();
    const DifferentialIkResult plain = DifferentialIk(chain_, q, target);
    const DifferentialIkResult drawn = DifferentialIk(chain_, q, target, {.posture = posture});
    if (plain.slower || drawn.slower) continue;  // near a singularity
    ++judged;
    EXPECT_LT((drawn.twist.vector() - plain.twist.vector()).norm(), 1e-3);
    double towards = 0, moved = 0;
    for (int i = 0; i < n; ++i) {
      towards += (drawn.velocity[i] - plain.velocity[i]) * (posture[i] - q[i]);
      moved += std::abs(drawn.velocity[i] - plain.velocity[i]);
    }
    if (n > 6) {
      EXPECT_GT(towards, 0);
    } else {
      EXPECT_LT(moved, 1e-2) << "nothing to spare";
    }
  }
  EXPECT_GE(judged, 20);
}

// Damping with a joint that cannot move: locked, or pressed against its limit.
TEST_P(DifferentialIkTest, IsDampedIfTheMovingJointsAreNearASingularity) {
  const int n = chain_.n_joints();
  int near = 0, held = 0;
  for (int k = 0; k < 60; ++k) {
    DifferentialIkOptions options;
    const int stuck = k % n;
    options.locked[stuck] = k % 2;
    options.seconds = k % 2 ? 0 : 0.002;
    // Takes the worst of many.
    JointVector q;
    Svd svd;
    for (int other = 0; other < 60; ++other) {
      JointVector there = Inside();
      if (!options.locked[stuck]) there[stuck] = chain_.joints()[stuck].upper;
      Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, n);
      chain_.Jacobian(there, jacobian);
      jacobian.topRows(3) /= chain_.model().length;
      jacobian.col(stuck).setZero();
      const Svd of_these = SvdOf(jacobian);
      if (other > 0 && of_these.values[5] > svd.values[5]) continue;
      svd = of_these;
      q = there;
    }
    near += svd.values[5] < 0.02;
    // A twist that the other joints can hardly produce, and a little of everything.
    Eigen::Matrix<double, 6, 1> hard = svd.left.col(5) + 0.1 * RandomTwist().vector();
    hard.head(3) *= chain_.model().length;
    const Twist target = Twist::FromVector(0.2 * hard);
    const DifferentialIkResult found = DifferentialIk(chain_, q, target, options);
    if (found.velocity[stuck] != 0) continue;
    ++held;
    // A singular value s requires 1 / s, damped to s / (s^2 + d): at most 40, and at 0.02 for 50.
    double fastest = 0;
    for (const double v : found.velocity) fastest = std::max(fastest, std::abs(v));
    Eigen::Matrix<double, 6, 1> task = target.vector();
    task.head(3) /= chain_.model().length;
    EXPECT_LT(fastest, 60 * task.norm());
  }
  EXPECT_GT(near, 10);
  EXPECT_GT(held, 30);
}

// Only nearly lost directions are damped: along all others the tip follows the twist.
TEST(DifferentialIk, OfADeficientChainIsExactInReachableDirections) {
  for (const int n : {3, 5, 7}) {
    std::string xml =
        "<mujoco><compiler angle='radian'/><worldbody><body name='base'>"
        "<geom size='.1'/>";
    for (int i = 0; i < n; ++i) xml += "<body pos='.3 0 0'><joint axis='0 1 0'/><geom size='.1'/>";
    xml += "<site name='tip' pos='.3 0 0'/>";
    for (int i = 0; i < n; ++i) xml += "</body>";
    const TestModel t = TestModel::FromXml(xml + "</body></worldbody></mujoco>");
    const Chain chain(t.model(), "base", ChainTip::Site("tip"));
    Rng rng = Rng::Stream(n, "planar");
    int slower = 0;
    for (int k = 0; k < 50; ++k) {
      JointVector q(n);
      for (int i = 0; i < n; ++i) q[i] = (i % 2 ? -1 : 1) * rng.Uniform(0.5, 1.2);
      const Twist target{.linear = {rng.Normal(), 0, rng.Normal()},
                         .angular = {0, rng.Normal(), 0}};
      slower += DifferentialIk(chain, q, target).slower;
      EXPECT_TRUE(DifferentialIk(chain, q, {.linear = {0, 0.1, 0}}).slower) << "out of the plane";
    }
    EXPECT_EQ(slower, 0);
  }
}

TEST_P(DifferentialIkTest, AZeroTwistIsNeverSlowed) {
  for (int k = 0; k < 50; ++k) {
    const JointVector q = Inside();
    const DifferentialIkResult still = DifferentialIk(chain_, q, {});
    EXPECT_EQ(still.velocity, JointVector(q.size()));
    EXPECT_FALSE(still.slower);
    EXPECT_FALSE(DifferentialIk(chain_, q, {}, {.seconds = 0.002}).slower);
  }
}

// In the stretched arm the inverse of the Jacobian is infinite, the speeds are not.
TEST(DifferentialIk, IsDampedNearSingularities) {
  const TestModel t = TestModel::FromXml(
      "<mujoco><compiler angle='radian'/><worldbody><body name='base'><geom size='.1'/>"
      "<body><joint axis='0 1 0'/><geom size='.1'/><body pos='1 0 0'><joint axis='0 1 0'/>"
      "<geom size='.1'/><body pos='1 0 0'><joint axis='0 1 0'/><geom size='.1'/>"
      "<site name='tip'/></body></body></body></body></worldbody></mujoco>");
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  double fastest = 0;
  for (const double elbow : {0.0, 1e-9, 1e-6, 1e-4, 1e-3, 1e-2, 0.03, 0.1, 0.3, 1.0}) {
    const DifferentialIkResult found =
        DifferentialIk(chain, JointVector{0.2, elbow, 0.1}, {.linear = {-0.2, 0, 0}});
    for (const double v : found.velocity) fastest = std::max(fastest, std::abs(v));
    if (elbow >= 1 || elbow <= 1e-4) {
      EXPECT_EQ(found.slower, elbow < 1) << elbow;
    }
  }
  EXPECT_LT(fastest, 4);
}

TEST(DifferentialIk, ReturnsJointsToTheirLimitsAndKeepsLockedOnes) {
  Rng rng = Rng::Stream(3, "differential ik");
  const TestModel t = TestModel::FromXml(
      RandomChainXml(&rng, {.joints = 7, .slide_share = 0, .limited_share = 1}).Write());
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  JointVector q = RandomJoints(chain, &rng);
  LockedJoints locked{};
  locked[2] = true;
  const DifferentialIkOptions options{.frame = TwistFrame::kTip,
                                      .seconds = 0.01,
                                      .max_speed = JointVector(7, 1),
                                      .posture = q,
                                      .locked = locked};
  q[0] = chain.joints()[0].upper + 0.5;
  const DifferentialIkResult found = DifferentialIk(chain, q, {.linear = {0.1, 0, 0}}, options);
  EXPECT_EQ(found.velocity[0], -1) << "as fast as it may";
  EXPECT_EQ(found.velocity[2], 0);
  EXPECT_EQ(DifferentialIk(chain, q, {}).velocity, JointVector(7));
}

TEST(DifferentialIk, ScalesDownAnOverflowingTwist) {
  Rng rng = Rng::Stream(5, "differential ik");
  const TestModel t = TestModel::FromXml(RandomChainXml(&rng, {.joints = 7}).Write());
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const JointVector speed(std::vector<double>(7, 1.0));
  const DifferentialIkResult now =
      DifferentialIk(chain, JointVector(7), {.linear = {1e155, 0, 0}, .angular = {0, 1e155, 0}},
                     {.max_speed = speed});
  EXPECT_TRUE(now.slower);
  for (const double v : now.velocity) EXPECT_LE(std::abs(v), 1);
}

TEST(DifferentialIk, RejectsInvalidArguments) {
  Rng rng = Rng::Stream(4, "differential ik");
  const TestModel t = TestModel::FromXml(RandomChainXml(&rng, {.joints = 3}).Write());
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const JointVector q(3);
  const auto refused = [&](const DifferentialIkOptions& options, const std::string& text) {
    ExpectThrow<ArgumentError>([&] { DifferentialIk(chain, q, {}, options); }, text);
  };
  refused({.seconds = -1}, "differential inverse kinematics: seconds is -1; it must be 0 or more");
  refused({.max_speed = {1, 1}}, "max_speed");
  refused({.max_speed = {1, 0, 1}}, "is 0; it must be more than 0");
  refused({.posture = {1}}, "posture");
  refused({.posture_rate = NAN}, "posture_rate is nan");
  refused({.frame = TwistFrame::kWorld, .base_in_world = 2 * Eigen::Matrix3d::Identity()},
          "differential inverse kinematics: base_in_world: ");
  refused({.frame = TwistFrame::kWorld, .base_in_world = NAN * Eigen::Matrix3d::Identity()},
          "differential inverse kinematics: base_in_world: ");
  ExpectThrow<ArgumentError>(
      [&] {
        DifferentialIk(chain, q, {.linear = {NAN, 0, 0}});
      },
      "the twist has a number that is not finite");
}

}  // namespace
}  // namespace robocell
