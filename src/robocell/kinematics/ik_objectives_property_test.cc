// Tests properties of every query for more or less than a pose: random chains of 2 to 12 joints
// with slides, tiny limits and locked joints, seeds inside and outside of the limits. The judge is
// the engine, with its own formulas.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/ik_solutions.h"
#include "robocell/kinematics/testing/ik_judge.h"

namespace robocell {
namespace {

using Eigen::Vector3d;

constexpr double kObjectiveTolerance = 1e-5;

enum class Joints { kWithSlides, kTinyLimits, kLocked, kWholeTurns };

struct Objective {
  std::string name;
  IkOptions options;
};

// The filters keep about four of five configurations.
bool FilterKeeps(std::span<const double> q) { return std::sin(3 * q[0] + 2 * q[1]) > -0.8; }

class IkObjectives : public testing::TestWithParam<std::tuple<int, Joints>> {
 protected:
  IkObjectives()
      : rng_(Rng::Stream(std::get<0>(GetParam()), "ik objectives",
                         static_cast<int>(std::get<1>(GetParam())))),
        model_(TestModel::FromXml(RandomChainXml(&rng_, Options()).Write())),
        chain_(model_.model(), "base", ChainTip::Site("tip")) {
    if (std::get<1>(GetParam()) != Joints::kLocked) return;
    for (int i = 0; i < chain_.n_joints(); ++i) locked_[i] = rng_.Uniform() < 0.25;
  }

  static RandomChainOptions Options() {
    const auto [joints, sort] = GetParam();
    return {.joints = joints,
            .slide_share = 0.3,
            .tiny_share = sort == Joints::kTinyLimits ? 0.3 : 0,
            .whole_turn_share = sort == Joints::kWholeTurns ? 0.7 : 0};
  }
  Vector3d RandomDirection() {
    return Vector3d(rng_.Normal(), rng_.Normal(), rng_.Normal()).normalized();
  }

  std::vector<Objective> Objectives() {
    const JointVector posture = RandomJoints(chain_, &rng_);
    const Vector3d axis = RandomDirection();
    const IkFilter filter = [](std::span<const double> q, int count, std::span<uint8_t> keep) {
      const std::size_t n = q.size() / count;
      for (int k = 0; k < count; ++k) keep[k] = FilterKeeps(q.subspan(k * n, n));
    };
    std::vector<Objective> objectives = {
        {"position only", {.position_only = true}},
        {"axis", {.axis = axis}},
        {"cone", {.axis = axis, .cone = 0.4}},
        {"weights", {.position_weights = {1, 0.3, 2}, .rotation_weights = {0.5, 1, 1}}},
        {"a line", {.position_weights = {1, 0, 1}}},
        {"a plane and an axis", {.position_weights = {0, 0, 1}, .rotation_weights = {1, 0, 1}}},
        {"near the seed", {.prefer = IkPrefer::kSeed}},
        {"near a posture", {.prefer = IkPrefer::kPosture, .posture = posture}},
        {"away from limits, anywhere in a cone",
         {.axis = axis, .cone = 0.2, .prefer = IkPrefer::kAwayFromLimits}},
        {"manipulability of a position",
         {.position_only = true, .prefer = IkPrefer::kManipulability}},
        {"filter", {.filter = filter}},
        {"filter near a posture on a line",
         {.position_weights = {1, 0, 1},
          .prefer = IkPrefer::kPosture,
          .posture = posture,
          .filter = filter}},
    };
    for (Objective& objective : objectives) objective.options.locked = locked_;
    return objectives;
  }

  // Makes targets that each objective can reach, with seeds and the required locked joints.
  void MakeQueries(int count) {
    targets_.clear();
    seeds_.clear();
    while (static_cast<int>(targets_.size()) < count) {
      const JointVector truth = RandomJoints(chain_, &rng_);
      if (!FilterKeeps(truth)) continue;
      targets_.push_back(chain_.Fk(truth));
      const double away = targets_.size() % 3 == 0 ? 20 : 0.5;
      for (int i = 0; i < truth.size(); ++i)
        seeds_.push_back(truth[i] + (locked_[i] ? 0 : rng_.Uniform(-away, away)));
    }
  }
  std::span<const double> Seed(int b) const {
    const std::size_t n = chain_.n_joints();
    return std::span(seeds_).subspan(b * n, n);
  }

  // Returns the errors of a result by the engine, weighted by the options: m, rad.
  std::pair<double, double> ErrorsOf(const Pose& target, std::span<const double> q,
                                     const IkOptions& options) {
    for (int i = 0; i < chain_.n_joints(); ++i)
      model_.data()->qpos[chain_.joints()[i].qpos_address] = q[i];
    mj_kinematics(model_.model(), model_.data());
    const Transform tip = ToTransform(target).inverse() * model_.TipInBase(chain_);
    const auto weighed = [](const Vector3d& v, const std::array<double, 3>& w) {
      return Vector3d(w[0] * v.x(), w[1] * v.y(), w[2] * v.z()).norm();
    };
    const double position = weighed(tip.translation, options.position_weights);
    if (options.position_only) return {position, 0};
    const bool is_axis = options.rotation_weights == std::array<double, 3>{1, 0, 1};
    if (options.axis || is_axis) {
      const Vector3d axis = is_axis ? Vector3d::UnitY() : *options.axis;
      const Vector3d now = tip.rotation * axis;
      const double angle = std::atan2(now.cross(axis).norm(), now.dot(axis));
      return {position, std::max(0.0, angle - options.cone)};
    }
    const Eigen::AngleAxisd turn(tip.rotation);
    return {position, weighed(turn.angle() * turn.axis(), options.rotation_weights)};
  }

  // Checks everything that a result claims.
  void Check(const Objective& objective, int b, std::span<const double> q, bool success) {
    const std::string what = fmt::format("{}, query {}", objective.name, b);
    for (int i = 0; i < chain_.n_joints(); ++i) {
      const ChainJoint& joint = chain_.joints()[i];
      if (locked_[i]) {
        EXPECT_EQ(q[i], Seed(b)[i]) << what << ", locked joint " << i;
      } else {
        EXPECT_TRUE(q[i] >= joint.lower && q[i] <= joint.upper) << what << ", joint " << i;
      }
    }
    if (!success) return;
    const auto [position, rotation] = ErrorsOf(targets_[b], q, objective.options);
    EXPECT_LE(position, 1.0001 * kObjectiveTolerance) << what;
    EXPECT_LE(rotation, 1.0001 * kObjectiveTolerance) << what;
    if (objective.options.filter) {
      EXPECT_TRUE(FilterKeeps(q)) << what;
    }
  }

  Rng rng_;
  TestModel model_;
  Chain chain_;
  LockedJoints locked_{};
  std::vector<Pose> targets_;
  std::vector<double> seeds_;
};
INSTANTIATE_TEST_SUITE_P(Joints, IkObjectives,
                         testing::Combine(testing::Range(2, 13),
                                          testing::Values(Joints::kWithSlides, Joints::kTinyLimits,
                                                          Joints::kLocked, Joints::kWholeTurns)));

TEST_P(IkObjectives, AreMetAloneAndInBatches) {
  constexpr int kCount = 12;
  for (const Objective& objective : Objectives()) {
    MakeQueries(kCount);
    const IkBatchResult batch = IkBatch(chain_, targets_, seeds_, {.ik = objective.options});
    const IkBatchResult threaded =
        IkBatch(chain_, targets_, seeds_, {.ik = objective.options, .threads = 2});
    EXPECT_EQ(batch.q, threaded.q) << objective.name;
    int singles = 0;
    for (int b = 0; b < kCount; ++b) {
      Check(objective, b, batch.row(b), batch.success[b]);
      const IkBatchResult alone =
          IkBatch(chain_, {&targets_[b], 1}, Seed(b), {.ik = objective.options});
      EXPECT_TRUE(std::ranges::equal(alone.q, batch.row(b))) << objective.name;
      IkOptions single = objective.options;
      single.seed = JointVector(Seed(b));
      const IkResult one = Ik(chain_, targets_[b], single);
      Check(objective, b, one.q, one.success);
      singles += one.success;
    }
    EXPECT_GE(batch.solved(), kCount - 1) << objective.name;
    EXPECT_GE(singles, kCount - 1) << objective.name;
  }
}

TEST_P(IkObjectives, AreMetByAllSolutions) {
  for (const Objective& objective : Objectives()) {
    MakeQueries(2);
    for (int b = 0; b < 2; ++b) {
      IkOptions options = objective.options;
      options.seed = JointVector(Seed(b));
      for (const IkResult& found : IkSolutions(chain_, targets_[b], options))
        Check(objective, b, found.q, found.success);
    }
  }
}

// Unreachable for every objective: reported as such, with the limits obeyed.
TEST_P(IkObjectives, ReportTargetsOutOfReach) {
  for (const Objective& objective : Objectives()) {
    const auto& w = objective.options.position_weights;
    if (*std::min_element(w.begin(), w.end()) == 0) continue;  // may be reachable
    MakeQueries(3);
    for (Pose& target : targets_) {
      const double far = 5 * chain_.model().reach_bound + 50;
      target = Pose(target.translation() + far * RandomDirection(), target.quaternion());
    }
    const IkBatchResult batch = IkBatch(chain_, targets_, seeds_, {.ik = objective.options});
    EXPECT_EQ(batch.solved(), 0) << objective.name;
    for (int b = 0; b < batch.size; ++b) {
      Check(objective, b, batch.row(b), false);
      EXPECT_TRUE(std::isfinite(batch.position_error[b])) << objective.name;
    }
  }
}

}  // namespace
}  // namespace robocell
