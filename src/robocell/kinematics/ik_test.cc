// Tests inverse kinematics: solutions judged by the engine's kinematics, limits, and results
// without a solution.
#include "robocell/kinematics/ik.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <thread>

#include "robocell/kinematics/differential_ik.h"
#include "robocell/kinematics/ik_parts.h"
#include "robocell/kinematics/low_discrepancy.h"
#include "robocell/kinematics/start_range.h"
#include "robocell/kinematics/testing/ik_judge.h"
#include "robocell/kinematics/testing/models.h"
#include "robocell/testing/count_allocations.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {

namespace {

constexpr double kPi = std::numbers::pi;

// Returns how many of `count` reachable targets are solved; every claimed solution must convince
// the engine.
int CountSolved(const TestModel& t, const Chain& chain, int count, Rng* rng,
                const IkOptions& options = {}) {
  int solved = 0;
  for (int k = 0; k < count; ++k) {
    const Pose target = chain.Fk(RandomJoints(chain, rng));
    const IkResult result = Ik(chain, target, options);
    EXPECT_TRUE(InLimits(chain, result.q));
    if (!result.success) continue;
    ++solved;
    EXPECT_TRUE(EngineAgrees(t, chain, target, result.q, options.tolerance * 1.0001));
    EXPECT_LE(result.position_error, options.tolerance);
    EXPECT_LE(result.rotation_error, options.tolerance);
  }
  return solved;
}

// A chain without files: six or seven hinges and one or two slides, seeded.
struct AnyArm {
  explicit AnyArm(int seed, RandomChainOptions options = {}) {
    Rng rng = Rng::Stream(seed, "any arm");
    model = std::make_unique<TestModel>(TestModel::FromXml(RandomChainXml(&rng, options).Write()));
    chain = std::make_unique<Chain>(model->model(), "base", ChainTip::Site("tip"));
  }
  std::unique_ptr<TestModel> model;
  std::unique_ptr<Chain> chain;
};

// Shoulder and elbow in a plane, 1 m + 1 m, elbow 0 to 2.5; then a turning wrist.
constexpr char kPlanar[] =
    "<mujoco><compiler angle='radian'/><worldbody><body name='base'><geom size='.1'/>"
    "<body name='upper'><joint name='shoulder'/><geom size='.1'/>"
    "<body name='lower' pos='1 0 0'><joint name='elbow' range='0 2.5'/><geom size='.1'/>"
    "<body name='wrist' pos='1 0 0'><joint name='turn'/><geom size='.1'/><site "
    "name='tip'/></body></body></body>"
    "</body></worldbody></mujoco>";

class MenagerieIk : public testing::TestWithParam<MenagerieArm> {
 protected:
  void SetUp() override { REQUIRE_MENAGERIE(GetParam().folder); }
};
INSTANTIATE_TEST_SUITE_P(Arms, MenagerieIk, testing::ValuesIn(MenagerieArms()), ArmName);

TEST_P(MenagerieIk, SolvesAThousandReachableTargetsWithinTheLimits) {
  const Arm arm(GetParam());
  Rng rng = Rng::Stream(1, "ik targets", GetParam().folder);
  EXPECT_GE(CountSolved(arm.model, arm.chain, 1000, &rng), 1000);
}

TEST_P(MenagerieIk, SolvesToTighterTolerances) {
  const Arm arm(GetParam());
  Rng rng = Rng::Stream(2, "tight ik targets", GetParam().folder);
  EXPECT_GE(CountSolved(arm.model, arm.chain, 200, &rng, {.tolerance = 1e-9}), 200);
}

TEST_P(MenagerieIk, SolvesTargetsAtTheCornersOfTheLimits) {
  const Arm arm(GetParam());
  Rng rng = Rng::Stream(3, "corners", GetParam().folder);
  int solved = 0;
  for (int k = 0; k < 200; ++k) {
    JointVector q = RandomJoints(arm.chain, &rng);
    for (int i = 0; i < q.size(); ++i) {
      const ChainJoint& joint = arm.chain.joints()[i];
      if (joint.limited && rng.Uniform() < 0.5)
        q[i] = rng.Uniform() < 0.5 ? joint.lower : joint.upper;
    }
    const IkResult result = Ik(arm.chain, arm.chain.Fk(q));
    solved += result.success;
    EXPECT_TRUE(InLimits(arm.chain, result.q));
  }
  EXPECT_GE(solved, 200);
}

TEST_P(MenagerieIk, StaysOnTheSeedsBranchWhenTheTargetIsNearIt) {
  const Arm arm(GetParam());
  Rng rng = Rng::Stream(4, "servo", GetParam().folder);
  for (int k = 0; k < 200; ++k) {
    const JointVector seed = RandomJoints(arm.chain, &rng);
    JointVector goal = seed;
    for (int i = 0; i < goal.size(); ++i) {
      const ChainJoint& joint = arm.chain.joints()[i];
      goal[i] = std::clamp(goal[i] + rng.Uniform(-0.01, 0.01), joint.lower, joint.upper);
    }
    const IkResult result = Ik(arm.chain, arm.chain.Fk(goal), {.seed = seed});
    ASSERT_TRUE(result.success);
    EXPECT_EQ(result.restarts, 0);
    EXPECT_LE(result.iterations, 10);
    for (int i = 0; i < seed.size(); ++i) EXPECT_NEAR(result.q[i], seed[i], 0.3);
  }
}

TEST(Ik, SolvesRandomChainsOfFiveToEightJoints) {
  for (int k = 0; k < 24; ++k) {
    const RandomChainOptions options{.joints = 5 + k % 4, .slide_share = 0.1 * (k % 3)};
    const AnyArm arm(k, options);
    Rng rng = Rng::Stream(5, "random ik", k);
    EXPECT_GE(CountSolved(*arm.model, *arm.chain, 100, &rng), 99) << "chain " << k;
  }
}

TEST(Ik, DoesNotDependOnTheSizeOfTheRobot) {
  for (const double size : {0.01, 100.0}) {
    const TestModel t = TestModel::FromXml(fmt::format(
        "<mujoco><compiler angle='radian'/><worldbody><body name='base'><geom size='.1'/>"
        "<body pos='0 0 {0}'><joint range='-3 3'/><geom size='.1'/><body pos='0 0 {0}'><joint "
        "axis='0 1 0' range='-2 2'/>"
        "<geom size='.1'/><body pos='0 0 {0}'><joint range='-3 3'/><geom size='.1'/><body pos='{1} "
        "0 {0}'>"
        "<joint axis='0 1 0' range='-2 2'/><geom size='.1'/><body pos='0 0 {0}'><joint range='-3 "
        "3'/><geom size='.1'/>"
        "<body pos='0 0 {1}'><joint axis='0 1 0' range='-2 2'/><geom size='.1'/><body name='tip' "
        "pos='0 0 {1}'>"
        "<joint range='-3 3'/><geom "
        "size='.1'/></body></body></body></body></body></body></body></body></worldbody>"
        "</mujoco>",
        0.2 * size, 0.05 * size));
    const Chain chain(t.model(), "base", ChainTip::Body("tip"));
    Rng rng = Rng::Stream(6, "sizes");
    EXPECT_GE(CountSolved(t, chain, 300, &rng), 299) << size;
  }
}

TEST(Ik, ReturnsTheBestItFoundForATargetOutOfReach) {
  const TestModel t = TestModel::FromXml(kPlanar);
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const IkResult result = Ik(chain, Pose(Eigen::Vector3d(0, 3, 0)));
  EXPECT_FALSE(result.success);
  EXPECT_NEAR(result.position_error, 1, 1e-3);
  EXPECT_NEAR(result.rotation_error, 0, 1e-2);
  EXPECT_TRUE(InLimits(chain, result.q));
  EXPECT_NEAR(chain.Fk(result.q).translation().y(), 2, 1e-3);
}

TEST(Ik, EndsInBoundedTimeForAbsurdTargets) {
  const TestModel t = TestModel::FromXml(kPlanar);
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const IkOptions options{.max_restarts = 20, .max_iterations = 30};
  for (const double far : {1e3, 1e12, 1e200, 1e308}) {
    const IkResult result = Ik(chain, Pose(Eigen::Vector3d(far, far, far)), options);
    EXPECT_FALSE(result.success);
    EXPECT_LE(result.iterations, 21 * 30);
    EXPECT_TRUE(InLimits(chain, result.q));
    EXPECT_TRUE(std::isfinite(result.q[0] + result.q[2]));
  }
  const IkResult out_of_plane = Ik(chain, Pose(Eigen::Vector3d(1, 0, 0.5)), options);
  EXPECT_FALSE(out_of_plane.success);
  EXPECT_NEAR(out_of_plane.position_error, 0.5, 1e-2);
}

TEST(Ik, FindsTheStretchedPoseWhereTheJacobianIsSingular) {
  const TestModel t = TestModel::FromXml(kPlanar);
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  for (const double elbow : {0.0, 1e-9, 1e-5, 1e-3}) {
    const IkResult result = Ik(chain, chain.Fk(JointVector{0.4, elbow, 0.1}));
    EXPECT_TRUE(result.success) << elbow << " " << result.position_error;
  }
}

// Hinges one after the other along x, and slides where the axis requests them.
std::string Row(const std::vector<std::string>& joints, double link, double tip) {
  std::string open, close;
  for (const std::string& joint : joints) {
    open += fmt::format("<body pos='{} 0 0'><joint {}/><geom size='.1'/>", link, joint);
    close += "</body>";
  }
  return fmt::format(
      "<mujoco><compiler angle='radian'/><worldbody><body name='base'><geom size='.1'/>{}"
      "<site name='tip' pos='{} 0 0'/>{}</body></worldbody></mujoco>",
      open, tip, close);
}

TEST(Ik, TurnsOnlyTheLastHingeByHalfATurn) {
  const TestModel t = TestModel::FromXml(kPlanar);
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const JointVector seed = {0.4, 1, 0.1};
  for (const double off : {0.0, 1e-9, 1e-3}) {
    const Pose target = chain.Fk(JointVector{0.4, 1, 0.1 + kPi - off});
    const IkResult result = Ik(chain, target, {.seed = seed});
    ASSERT_TRUE(result.success);
    EXPECT_EQ(result.restarts, 0);
    EXPECT_NEAR(result.q[0], 0.4, 1e-4);
    EXPECT_NEAR(result.q[1], 1, 1e-4);
  }
}

TEST(Ik, MinimisesAHalfTurnError) {
  const TestModel t = TestModel::FromXml(Row({"range='-1 1' axis='1 0 0'"}, 0, 0));
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  for (const double turn : {kPi, kPi - 1e-3, kPi - 0.1}) {
    const Pose target(Eigen::Vector3d::Zero(),
                      Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitX()).toRotationMatrix());
    const IkResult result = Ik(chain, target, {.seed = JointVector{0}});
    EXPECT_FALSE(result.success);
    EXPECT_NEAR(result.rotation_error, turn - 1, 1e-6) << turn;
  }
}

TEST(Ik, TravelsFarOnSlidesWithoutLimits) {
  for (const double tip : {0.002, 0.5}) {
    const TestModel t = TestModel::FromXml(
        Row({"type='slide' axis='1 0 0'", "type='slide' axis='0 1 0'", "axis='0 0 1'"}, 0, tip));
    const Chain chain(t.model(), "base", ChainTip::Site("tip"));
    for (const double far : {3.0, -50.0, 3000.0}) {
      const Pose target = chain.Fk(JointVector{far, -0.5 * far, 2});
      EXPECT_TRUE(Ik(chain, target).success) << tip << " " << far;
      EXPECT_TRUE(Ik(chain, target, {.seed = JointVector{0, 0, 0}}).success) << tip << " " << far;
    }
  }
}

TEST(Ik, CountsAndLimitsSteps) {
  const TestModel t = TestModel::FromXml(Row({"type='slide' axis='1 0 0'"}, 0, 0));
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const Pose target(Eigen::Vector3d(0.3, 0, 0));
  IkOptions options{.tolerance = 0.01, .seed = {0}, .max_restarts = 0, .max_iterations = 0};
  EXPECT_FALSE(Ik(chain, target, options).success);
  EXPECT_EQ(Ik(chain, target, options).q[0], 0);
  EXPECT_EQ(Ik(chain, Pose(), options).iterations, 0);
  EXPECT_TRUE(Ik(chain, Pose(), options).success);
  options.max_iterations = 1;
  const IkResult one = Ik(chain, target, options);
  EXPECT_TRUE(one.success) << one.position_error;
  EXPECT_EQ(one.iterations, 1);
  options.max_restarts = std::numeric_limits<int>::max();
  EXPECT_TRUE(Ik(chain, target, options).success);
}

TEST(Ik, IsEvaluatedAfterItsLastStep) {
  const AnyArm arm(11, {.joints = 7, .slide_share = 0, .limited_share = 0});
  Rng rng = Rng::Stream(11, "last step");
  for (int k = 0; k < 20; ++k) {
    const JointVector seed = RandomJoints(*arm.chain, &rng);
    JointVector goal = seed;
    for (double& value : goal) value += rng.Uniform(-1e-4, 1e-4);
    IkOptions options{.seed = seed, .max_restarts = 0, .max_iterations = 0};
    const IkResult none = Ik(*arm.chain, arm.chain->Fk(goal), options);
    EXPECT_FALSE(none.success);
    EXPECT_EQ(none.q, seed);
    options.max_iterations = 1;
    const IkResult one = Ik(*arm.chain, arm.chain->Fk(goal), options);
    EXPECT_TRUE(one.success) << one.position_error << " " << one.rotation_error;
    EXPECT_EQ(one.iterations, 1);
  }
}

// Covers far and near seeds.
TEST(Ik, SolvesFromTheSeedIfPossible) {
  int alone = 0, together = 0;
  for (int k = 0; k < 300; ++k) {
    const AnyArm arm(200 + k % 3, {.joints = 6 + k % 3, .slide_share = 0.1});
    Rng rng = Rng::Stream(12, "from the seed", k);
    const JointVector seed = RandomJoints(*arm.chain, &rng);
    const Pose target = arm.chain->Fk(RandomJoints(*arm.chain, &rng));
    const IkResult from_seed = Ik(*arm.chain, target, {.seed = seed, .max_restarts = 0});
    const IkResult found = Ik(*arm.chain, target, {.seed = seed});
    together += found.success;
    if (!from_seed.success) continue;
    ++alone;
    EXPECT_EQ(found.q, from_seed.q);
    EXPECT_EQ(found.restarts, 0);
  }
  EXPECT_GE(alone, 50);
  EXPECT_GE(together, 298);
  EXPECT_LT(alone, together);
}

TEST(Ik, KeepsLockedJointsExactlyAtTheSeed) {
  const AnyArm arm(7, {.joints = 8, .slide_share = 0});
  Rng rng = Rng::Stream(7, "locked");
  const std::vector<std::string> names = {arm.chain->joints()[1].name, arm.chain->joints()[6].name};
  const LockedJoints locked = LockJoints(*arm.chain, names);
  int solved = 0;
  for (int k = 0; k < 100; ++k) {
    const JointVector truth = RandomJoints(*arm.chain, &rng);
    JointVector seed = RandomJoints(*arm.chain, &rng);
    for (const int i : {1, 6}) seed[i] = truth[i];
    const IkResult result = Ik(*arm.chain, arm.chain->Fk(truth), {.seed = seed, .locked = locked});
    solved += result.success;
    EXPECT_EQ(result.q[1], seed[1]);
    EXPECT_EQ(result.q[6], seed[6]);
  }
  EXPECT_GE(solved, 99);
}

TEST(Ik, KeepsLockedJointsOutsideTheirLimitsButMovesOtherSeedsInside) {
  const TestModel t = TestModel::FromXml(kPlanar);
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const Pose target = chain.Fk(JointVector{0.3, 2.51, 0});
  const std::vector<std::string> elbow = {"elbow"};
  const JointVector seed = {0.2, 2.51, 0.1};
  const IkResult kept = Ik(chain, target, {.seed = seed, .locked = LockJoints(chain, elbow)});
  EXPECT_TRUE(kept.success);
  EXPECT_EQ(kept.q[1], 2.51);
  const IkResult moved = Ik(chain, target, {.seed = seed});
  EXPECT_FALSE(moved.success);
  EXPECT_LE(moved.q[1], 2.5);
}

TEST(Ik, WithAllJointsLockedEvaluatesTheSeed) {
  const TestModel t = TestModel::FromXml(kPlanar);
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const JointVector seed = {0.2, 1, 0.1};
  LockedJoints all;
  all.fill(true);
  EXPECT_TRUE(Ik(chain, chain.Fk(seed), {.seed = seed, .locked = all}).success);
  const IkResult no = Ik(chain, chain.Fk(JointVector{0.3, 1, 0.1}), {.seed = seed, .locked = all});
  EXPECT_FALSE(no.success);
  EXPECT_EQ(no.q, seed);
}

TEST(Ik, ReachesAPositionWithFreeRotation) {
  const TestModel t = TestModel::FromXml(kPlanar);
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const Pose upside_down = Pose::FromRpy({1, 1, 0}, {kPi, 0, 0});
  EXPECT_FALSE(Ik(chain, upside_down).success);
  const IkResult result = Ik(chain, upside_down, {.position_only = true});
  EXPECT_TRUE(result.success);
  EXPECT_NEAR(result.rotation_error, kPi, 1e-6);
  EXPECT_LT((chain.Fk(result.q).translation() - upside_down.translation()).norm(), 1e-5);
}

TEST(Ik, ReturnsTheTurnNearestToTheSeed) {
  const TestModel t = TestModel::FromXml(kPlanar);
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const Pose target = chain.Fk(JointVector{0.5, 1, 0.2});
  const IkResult result = Ik(chain, target, {.seed = {0.5 + 6 * kPi, 1, 0.2 - 4 * kPi}});
  ASSERT_TRUE(result.success);
  EXPECT_NEAR(result.q[0], 0.5 + 6 * kPi, 1e-4);
  EXPECT_NEAR(result.q[2], 0.2 - 4 * kPi, 1e-4);
}

TEST(Ik, CanPreferTheSolutionNearTheSeed) {
  double plain = 0, near = 0;
  int farther = 0;
  for (int k = 0; k < 40; ++k) {
    const AnyArm arm(100 + k % 4, {.joints = 7, .slide_share = 0});
    Rng rng = Rng::Stream(8, "near", k);
    const JointVector seed = RandomJoints(*arm.chain, &rng);
    const Pose target = arm.chain->Fk(RandomJoints(*arm.chain, &rng));
    const auto distance = [&](const IkResult& result) {
      EXPECT_TRUE(result.success);
      double sum = 0;
      for (int i = 0; i < seed.size(); ++i) sum += std::pow(result.q[i] - seed[i], 2);
      return std::sqrt(sum);
    };
    const double first = distance(Ik(*arm.chain, target, {.seed = seed}));
    const double nearest =
        distance(Ik(*arm.chain, target, {.seed = seed, .prefer = IkPrefer::kSeed}));
    farther += nearest > first + 1e-9;
    plain += first;
    near += nearest;
  }
  EXPECT_LT(near, 0.85 * plain);
  EXPECT_LE(farther, 4);  // the first solution of the plain search may be lucky
}

TEST(Ik, IsBitwiseReproducibleOnEveryThread) {
  const AnyArm arm(9);
  Rng rng = Rng::Stream(9, "again");
  const Pose target = arm.chain->Fk(RandomJoints(*arm.chain, &rng));
  const IkResult here = Ik(*arm.chain, target);
  IkResult there;
  std::thread([&] { there = Ik(*arm.chain, target); }).join();
  EXPECT_EQ(here.q, there.q);
  EXPECT_EQ(here.iterations, there.iterations);
  EXPECT_EQ(Ik(*arm.chain, target).q, here.q);
}

TEST(Ik, AllocatesNothingAndNeitherDoKinematicsAndDynamics) {
  const AnyArm arm(10, {.joints = 9});
  Rng rng = Rng::Stream(10, "allocations");
  const JointVector q = RandomJoints(*arm.chain, &rng);
  const Pose target = arm.chain->Fk(q), far(Eigen::Vector3d(9, 0, 0));
  Eigen::Matrix<double, 6, 9> jacobian;
  JointVector torques(9);
  Eigen::MatrixXd mass(9, 9);
  Ik(*arm.chain, far);  // makes the table of starts
  const AllocationCount count;
  Ik(*arm.chain, target, {.seed = q, .prefer = IkPrefer::kSeed});
  Ik(*arm.chain, target, {.axis = Eigen::Vector3d::UnitX(), .cone = 0.1});
  Ik(*arm.chain, target, {.position_weights = {1, 1, 0}, .prefer = IkPrefer::kManipulability});
  Ik(*arm.chain, target);
  Ik(*arm.chain, far);
  DifferentialIk(*arm.chain, q, {.linear = {0.1, 0, 0}}, {.seconds = 0.01, .posture = q});
  arm.chain->Jacobian(q, jacobian);
  arm.chain->GravityTorques(q, {0, 0, -9.81}, torques);
  arm.chain->MassMatrix(q, mass);
  arm.chain->InverseDynamics(q, q, q, {0, 0, -9.81}, torques);
  EXPECT_EQ(count.allocations(), 0);
}

TEST(Ik, RejectsInvalidQueries) {
  const TestModel t = TestModel::FromXml(kPlanar);
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const Pose target(Eigen::Vector3d(1, 1, 0));
  const Pose huge(Eigen::Vector3d(1.5e308, 0, 0));
  ExpectThrow<ArgumentError>([&] { Ik(chain, huge * huge); },
                             "inverse kinematics: target has a number that is not finite");
  ExpectThrow<ArgumentError>(
      [&] {
        Ik(chain, target, {.seed = {1, 2}});
      },
      "inverse kinematics of chain 'base' -> site 'tip': seed: expected 3 joint values, got 2");
  ExpectThrow<ArgumentError>(
      [&] {
        Ik(chain, target, {.seed = {1, NAN, 2}});
      },
      "seed of joint 'elbow' is nan");
  const std::vector<std::string> elbow = {"elbow"};
  ExpectThrow<ArgumentError>(
      [&] { Ik(chain, target, {.locked = LockJoints(chain, elbow)}); },
      "joint 'elbow' is locked, but there is no seed that says where. Give a seed.");
  ExpectThrow<ArgumentError>([&] { Ik(chain, target, {.tolerance = 0}); },
                             "tolerance is 0; it must be more than 0");
  ExpectThrow<ArgumentError>([&] { Ik(chain, target, {.max_restarts = -1}); },
                             "max_restarts is -1");
  const std::vector<std::string> wrong = {"elbo"};
  ExpectThrow<NotFoundError>([&] { LockJoints(chain, wrong); }, "Did you mean 'elbow'?");
}

TEST(LowDiscrepancy, FillsEveryAxisAndEveryPairOfAxesEvenlyFromTheCentreOn) {
  for (int d = 0; d < kMaxChainJoints; ++d) {
    EXPECT_EQ(internal::LowDiscrepancy(0, d), 0.5);
    std::array<int, 8> bins{};
    for (int k = 0; k < 800; ++k) ++bins[static_cast<int>(internal::LowDiscrepancy(k, d) * 8)];
    for (const int count : bins) EXPECT_NEAR(count, 100, 5) << "axis " << d;
    for (int e = 0; e < d; ++e) {
      std::array<int, 16> squares{};
      for (int k = 0; k < 1600; ++k) {
        ++squares[static_cast<int>(internal::LowDiscrepancy(k, d) * 4) * 4 +
                  static_cast<int>(internal::LowDiscrepancy(k, e) * 4)];
      }
      for (const int count : squares) EXPECT_NEAR(count, 100, 40) << "axes " << d << " and " << e;
    }
  }
}

TEST(StartRange, IsOneTurnForHingesAndTheLimitsForSlides) {
  JointModel joint;
  joint.lower = -4 * kPi;
  joint.upper = 6 * kPi;
  EXPECT_NEAR(internal::StartRangeOf(joint, 1).upper, 2 * kPi, 1e-12);
  joint.slide = true;
  EXPECT_EQ(internal::StartRangeOf(joint, 1).upper, 6 * kPi);
  joint.lower = -INFINITY;
  joint.upper = INFINITY;
  joint.reference = 3;
  EXPECT_EQ(internal::StartRangeOf(joint, 0.5).lower, 2.5);
}

TEST(StartRange, OfOneLimitIsFullSizedAndInsideTheLimit) {
  for (const bool slide : {false, true}) {
    for (const double limit : {-20.0, -4.0, -1.0, 0.0, 1.0, 4.0, 20.0}) {
      const JointModel low{.slide = slide, .lower = limit, .upper = INFINITY};
      const JointModel high{.slide = slide, .lower = -INFINITY, .upper = limit};
      for (const JointModel& joint : {low, high}) {
        const internal::StartRange range = internal::StartRangeOf(joint, 0.5);
        EXPECT_GE(range.lower, joint.lower);
        EXPECT_LE(range.upper, joint.upper);
        EXPECT_NEAR(range.upper - range.lower, slide ? 1 : 2 * kPi, 1e-12);
      }
    }
  }
}

TEST(RestartsFor, AreFewIfNoStretchedChainReachesTheTarget) {
  const AnyArm arm(7, {.joints = 7, .slide_share = 1});
  const ChainModel& chain = arm.chain->model();
  const Transform far{Eigen::Matrix3d::Identity(), {3 * chain.reach_bound, 0, 0}};
  IkOptions options;
  const auto restarts = [&] {
    return internal::RestartsFor(chain, internal::IkTask(options), options, far);
  };
  EXPECT_EQ(restarts(), 8);
  // Beyond its limits a slide may carry the tip there.
  options.locked[2] = true;
  EXPECT_EQ(restarts(), 100);
}

}  // namespace
}  // namespace robocell
