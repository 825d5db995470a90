// Tests the leaf's inverse inertia and damping against Eigen's factorisations, on every instruction
// set; also without springs and with a stretched arm.
#include "robocell/control/operational_space.h"
#include "robocell/kinematics/link_kernel.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "robocell/base/rng.h"
#include "robocell/control/inverse_root.h"
#include "robocell/kinematics/pose_error.h"
#include "robocell/testing/decompositions.h"
#include "robocell/testing/instruction_sets.h"
#include "robocell/testing/random_values.h"

namespace robocell {
namespace {

// The size is dynamic, so that Eigen's factorisations are compiled once.
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd RandomMatrix(Rng* rng, int rows, int cols) {
  MatrixXd m(rows, cols);
  for (int k = 0; k < m.size(); ++k) m.data()[k] = rng->Normal();
  return m;
}

// Returns a symmetric matrix with eigenvalues from 1 to 1 / condition.
MatrixXd RandomPositive(Rng* rng, int n, double condition) {
  const MatrixXd q = OrthogonalPartOf(RandomMatrix(rng, n, n));
  VectorXd values(n);
  for (int k = 0; k < n; ++k) values[k] = std::pow(condition, -double(k) / std::max(n - 1, 1));
  return q * values.asDiagonal() * q.transpose();
}

std::array<double, 21> Triangle(const MatrixXd& m) {
  std::array<double, 21> entries;
  int k = 0;
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c <= r; ++c) entries[k++] = m(r, c);
  }
  return entries;
}

VectorXd ByEigenvectors(const VectorXd& stiffness, const MatrixXd& inverse_inertia,
                        const VectorXd& velocity) {
  const VectorXd root = stiffness.cwiseSqrt();
  const Eigenpairs modes = EigenpairsOf(root.asDiagonal() * inverse_inertia * root.asDiagonal());
  const VectorXd along = modes.vectors.transpose() * root.cwiseProduct(velocity);
  VectorXd scaled(6);
  for (int k = 0; k < 6; ++k) {
    const double value = modes.values[k];
    scaled[k] = value > 0 ? along[k] / std::sqrt(value) : 0;
  }
  return 2 * root.cwiseProduct(modes.vectors * scaled);
}

VectorXd Damping(const VectorXd& stiffness, const MatrixXd& inverse_inertia,
                 const VectorXd& velocity) {
  VectorXd force(6);
  CriticalDamping(stiffness.data(), Triangle(inverse_inertia).data(), velocity.data(),
                  force.data());
  return force;
}

// Returns the error in coordinates in which all springs are equal, in which the bound holds.
double Off(const VectorXd& stiffness, const VectorXd& got, const VectorXd& expected) {
  VectorXd scale(6);
  for (int k = 0; k < 6; ++k) scale[k] = stiffness[k] > 0 ? 1 / std::sqrt(stiffness[k]) : 0;
  const double length = expected.cwiseProduct(scale).norm();
  return length > 0 ? (got - expected).cwiseProduct(scale).norm() / length : got.norm();
}

TEST(OperationalSpace, DampingMatchesEigenvectorsUpToNearlySingularMasses) {
  OnEveryInstructionSet([](const std::string&) {
    Rng rng = Rng::Stream(1, "damping");
    for (int k = 0; k < 300; ++k) {
      // Eigen's own error grows with the condition.
      const MatrixXd inverse_inertia =
          RandomPositive(&rng, 6, std::pow(10, k % 6)) * rng.Uniform(0.1, 30);
      VectorXd stiffness(6);
      for (double& value : stiffness) value = std::pow(10, rng.Uniform(0, 4));
      const VectorXd velocity = RandomMatrix(&rng, 6, 1);
      const VectorXd expected = ByEigenvectors(stiffness, inverse_inertia, velocity);
      EXPECT_LT(Off(stiffness, Damping(stiffness, inverse_inertia, velocity), expected), 1e-4);
    }
  });
}

// Stretched out: a direction without motion has the smallest inverse_inertia.
TEST(OperationalSpace, DampsSingularPosesWithinItsTolerance) {
  OnEveryInstructionSet([](const std::string&) {
    Rng rng = Rng::Stream(2, "damping");
    for (int k = 0; k < 100; ++k) {
      const MatrixXd some = RandomMatrix(&rng, 6, 1 + k % 5);
      MatrixXd inverse_inertia = some * some.transpose();
      inverse_inertia.diagonal().array() += kLeastInverseInertia;
      const VectorXd stiffness{{400, 400, 400, 30, 30, 30}};
      const VectorXd velocity = some * RandomMatrix(&rng, some.cols(), 1);  // possible
      const VectorXd expected = ByEigenvectors(stiffness, inverse_inertia, velocity);
      EXPECT_LT(Off(stiffness, Damping(stiffness, inverse_inertia, velocity), expected), 1e-4);
    }
  });
}

TEST(OperationalSpace, DampsOnlyAxesWithSprings) {
  OnEveryInstructionSet([](const std::string&) {
    Rng rng = Rng::Stream(3, "damping");
    for (int k = 0; k < 50; ++k) {
      const MatrixXd inverse_inertia = RandomPositive(&rng, 6, 100);
      const VectorXd velocity = RandomMatrix(&rng, 6, 1);
      VectorXd stiffness{{400, 300, 200, 30, 20, 10}};
      for (int axis = 0; axis < 6; ++axis) {
        if (rng.Uniform() < 0.4) stiffness[axis] = 0;
      }
      const VectorXd force = Damping(stiffness, inverse_inertia, velocity);
      const VectorXd expected = ByEigenvectors(stiffness, inverse_inertia, velocity);
      EXPECT_LT(Off(stiffness, force, expected), 1e-4);
      for (int axis = 0; axis < 6; ++axis) {
        if (stiffness[axis] > 0) continue;
        EXPECT_EQ(force[axis], 0);
      }
    }
    EXPECT_EQ(Damping(VectorXd::Zero(6), MatrixXd::Identity(6, 6), VectorXd::Ones(6)),
              VectorXd::Zero(6));
  });
}

// Springs as different as possible: the damping still brakes, and never too much.
TEST(OperationalSpace, DampingRemovesEnergyForAnySprings) {
  OnEveryInstructionSet([](const std::string&) {
    Rng rng = Rng::Stream(4, "damping");
    for (int k = 0; k < 200; ++k) {
      VectorXd stiffness(6);
      for (double& value : stiffness) value = std::pow(10, rng.Uniform(-12, 6));
      MatrixXd inverse_inertia = RandomPositive(&rng, 6, std::pow(10, k % 12));
      inverse_inertia.diagonal().array() += kLeastInverseInertia;
      const VectorXd velocity = RandomMatrix(&rng, 6, 1);
      const double power = velocity.dot(Damping(stiffness, inverse_inertia, velocity));
      EXPECT_GT(power, 0);
      const double most = 2 * std::sqrt(stiffness.maxCoeff() / kLeastInverseInertia);
      EXPECT_LT(power, most * velocity.squaredNorm());
    }
  });
}

TEST(OperationalSpace, IsCriticallyDampedForOneMassOnOneSpring) {
  MatrixXd inverse_inertia = MatrixXd::Identity(6, 6) / 2.0;  // 2 kg
  const VectorXd stiffness{{800, 200, 50, 8, 2, 0.5}};
  const VectorXd force = Damping(stiffness, inverse_inertia, VectorXd::Ones(6));
  for (int k = 0; k < 6; ++k)
    EXPECT_NEAR(force[k], 2 * std::sqrt(stiffness[k] * 2), 1e-4 * force[k]);
}

// The result of the kernel of a chain's links for some arm. Entries without a joint are NaN.
struct LeafCase {
  int n;
  Transform leaf;
  MatrixXd j, m;
  VectorXd bias;
  internal::LinkAnswer arm = {};

  LeafCase(Rng* rng, int size)
      : n(size),
        leaf(ToTransform(RandomPose(*rng))),
        j(RandomMatrix(rng, 6, n)),
        m(RandomPositive(rng, n, 1e3)),
        bias(RandomMatrix(rng, n, 1)) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) arm.tip[c][r] = leaf.rotation(r, c);
      arm.tip[3][r] = leaf.translation[r];
    }
    for (int c = 0; c < kMaxChainJoints; ++c) {
      arm.torques[c] = c < n ? bias[c] : NAN;
      for (int r = 0; r < 6; ++r) arm.jacobian[r][c] = c < n ? j(r, c) : NAN;
      for (int r = 0; r < kMaxChainJoints; ++r) arm.mass[r][c] = r < n && c < n ? m(r, c) : NAN;
    }
  }
  MatrixXd InverseInertia() const {
    return j * SolvePositive(m, j.transpose()) + kLeastInverseInertia * MatrixXd::Identity(6, 6);
  }
};

TcpTarget GoalAt(const Transform& place) {
  return {place.translation.data(), place.rotation.data()};
}

VectorXd Numbers(const internal::PoseError& error) {
  VectorXd numbers(6);
  numbers << error.linear, error.angular;
  return numbers;
}

// From a tiny rotation to half a turn, where the axis has no direction.
TEST(OperationalSpace, ComputesThePoseError) {
  OnEveryInstructionSet([](const std::string&) {
    Rng rng = Rng::Stream(5, "goal");
    for (int k = 0; k < 400; ++k) {
      const LeafCase leaf(&rng, 6);
      const double angle = k % 4 == 0   ? M_PI - std::pow(10, rng.Uniform(-9, -1))
                           : k % 4 == 1 ? std::pow(10, rng.Uniform(-12, 0))
                                        : rng.Uniform(0, M_PI);
      const Eigen::Vector3d axis = RandomMatrix(&rng, 3, 1).normalized();
      Transform goal = leaf.leaf;
      goal.rotation = Eigen::AngleAxisd(angle, axis) * goal.rotation;
      goal.translation += RandomMatrix(&rng, 3, 1);
      VectorXd deviation(6);
      ComputeDeviation(leaf.arm, GoalAt(goal), deviation.data());
      const VectorXd expected = Numbers(internal::ErrorTo(goal, leaf.leaf));
      // Near half a turn rounding moves the axis.
      EXPECT_LT((deviation - expected).norm(), M_PI - angle < 0.1 ? 1e-7 : 1e-14) << angle;
      EXPECT_NEAR(deviation.tail(3).norm(), angle, M_PI - angle < 0.1 ? 1e-7 : 1e-14);
    }
  });
}

TEST(OperationalSpace, ComputesTheInverseInertiaForAnyNumberOfJoints) {
  OnEveryInstructionSet([](const std::string&) {
    for (int n = 1; n <= kMaxChainJoints; ++n) {
      Rng rng = Rng::Stream(n, "leaf");
      const LeafCase leaf(&rng, n);
      std::array<double, 21> inverse_inertia;
      ComputeInverseInertia(n, leaf.arm, inverse_inertia.data());
      const auto expected = Triangle(leaf.InverseInertia());
      for (int k = 0; k < 21; ++k)
        EXPECT_NEAR(inverse_inertia[k], expected[k], 1e-11 * leaf.InverseInertia().norm()) << n;
    }
  });
}

TEST(OperationalSpace, DampsAndCompensatesJointVelocities) {
  OnEveryInstructionSet([](const std::string&) {
    for (const int n : {2, 5, 6, 7, 8, 9, 12, 16}) {
      Rng rng = Rng::Stream(n, "inertial_force");
      const LeafCase leaf(&rng, n);
      const VectorXd velocity = RandomMatrix(&rng, n, 1), wanted = RandomMatrix(&rng, n, 1);
      VectorXd stiffness{{400, 400, 400, 30, 30, 30}};
      if (n % 2 == 0) stiffness[n / 2 % 6] = 0;
      const Transform goal = ToTransform(RandomPose(rng));
      const VectorXd deviation = Numbers(internal::ErrorTo(goal, leaf.leaf));
      const VectorXd push = RandomMatrix(&rng, 6, 1);
      const TcpSprings springs = MakeTcpSprings(stiffness.data());
      OperationalSpaceResult answer;
      ComputeOperationalSpace({.n = n,
                               .arm = &leaf.arm,
                               .wanted = wanted.data(),
                               .velocity = velocity.data(),
                               .springs = &springs,
                               .goal = GoalAt(goal),
                               .feedforward = push.data(),
                               .damping_ratio = 0.7},
                              &answer);
      const Eigen::Map<VectorXd> inertial_force(answer.inertial_force, 6);
      const VectorXd moved = leaf.j * wanted;
      // The residual of a solution that is exact for an inverse_inertia with rounding errors.
      EXPECT_LT((leaf.InverseInertia() * inertial_force - moved).norm(),
                1e-14 * leaf.InverseInertia().norm() * inertial_force.norm())
          << n;
      // With fewer than six joints some directions hardly yield, and the forward error is larger
      // there.
      const VectorXd expected = SolvePositive(leaf.InverseInertia(), moved);
      EXPECT_LT((inertial_force - expected).norm(), (n < 6 ? 1e-6 : 1e-8) * expected.norm()) << n;
      const VectorXd damping = Damping(stiffness, leaf.InverseInertia(), leaf.j * velocity);
      EXPECT_LT((Eigen::Map<VectorXd>(answer.damping, 6) - damping).norm(), 1e-9 * damping.norm());
      const VectorXd force =
          stiffness.cwiseProduct(deviation) - 0.7 * damping + push - inertial_force;
      const VectorXd needed = leaf.bias + leaf.m * wanted + leaf.j.transpose() * force;
      EXPECT_LT((Eigen::Map<VectorXd>(answer.torques, n) - needed).norm(), 1e-7 * needed.norm());
    }
  });
}

// Covers its whole range.
TEST(InverseRoot, IsWithinATenThousandth) {
  for (int k = 0; k < internal::kInverseRoots; ++k) {
    const internal::InverseRoot& root = internal::InverseRoots()[k];
    EXPECT_EQ(root.n_poles % 8, k == 0 ? 7 : 0);
    EXPECT_EQ(root.shift[7] == 0, k == 0);
    for (int i = 0; i <= 1000; ++i) {
      const double value = std::pow(root.range, -i / 1000.0);
      double sum = 0;
      for (int p = 0; p < root.n_poles; ++p) sum += root.weight[p] / (value + root.shift[p]);
      EXPECT_NEAR(sum * std::sqrt(value), 1, 1e-4) << root.range << " at " << value;
    }
  }
}

}  // namespace
}  // namespace robocell
