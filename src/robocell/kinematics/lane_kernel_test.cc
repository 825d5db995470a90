// Tests that a step of all lanes measures the same as scalar kinematics, that lanes do not mix, and
// that limits and locks hold.
#include "robocell/kinematics/lane_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "robocell/kinematics/pose_error.h"
#include "robocell/kinematics/testing/models.h"
#include "robocell/testing/instruction_sets.h"

namespace robocell::internal {
namespace {

// Random configurations of a random chain in all lanes, each with the pose of another as target.
struct Scene {
  explicit Scene(int joints, double slide_share = 0.2, double spread = 1)
      : rng(Rng::Stream(joints, "lanes")),
        model(TestModel::FromXml(
            RandomChainXml(&rng, {.joints = joints, .slide_share = slide_share, .limited_share = 1})
                .Write())),
        chain(model.model(), "base", ChainTip::Site("tip")),
        folded(Fold(chain.model())) {
    for (int lane = 0; lane < LaneCount(); ++lane) {
      JointVector q(joints), goal(joints);
      for (int i = 0; i < joints; ++i) {
        const ChainJoint& joint = chain.joints()[i];
        q[i] = rng.Uniform(joint.lower, joint.upper);
        goal[i] = std::clamp(q[i] + spread * rng.Uniform(-1, 1), joint.lower, joint.upper);
        state.q[i][lane] = q[i];
      }
      Aim(lane, ToTransform(chain.Fk(goal)));
    }
  }

  void Aim(int lane, const Transform& tip) {
    targets[lane] = tip;
    const ChainModel& m = chain.model();
    const Transform target = m.joints[0].fixed.inverse() * tip;
    const Eigen::Matrix3d axes = target.rotation * m.last_to_tip.rotation.transpose();
    for (int i = 0; i < 9; ++i) state.axes[i][lane] = axes.data()[i];
    for (int i = 0; i < 3; ++i) state.position[i][lane] = target.translation[i] * folded.per_metre;
    state.best_cost[lane] = INFINITY;
  }
  JointVector Q(int lane) const {
    JointVector q(chain.n_joints());
    for (int i = 0; i < q.size(); ++i) q[i] = state.q[i][lane];
    return q;
  }
  uint32_t Step() { return StepLanes(folded, options, (1U << LaneCount()) - 1, &state); }

  Rng rng;
  TestModel model;
  Chain chain;
  FoldedChain folded;
  LaneOptions options;
  LaneState state{};
  Transform targets[kMaxLanes];
};

TEST(LaneKernel, MatchesScalarKinematics) {
  for (const int joints : {1, 2, 5, 6, 7, 8, 12, 16}) {
    Scene scene(joints);
    std::vector<JointVector> before;
    for (int lane = 0; lane < LaneCount(); ++lane) before.push_back(scene.Q(lane));
    scene.Step();
    for (int lane = 0; lane < LaneCount(); ++lane) {
      const PoseError error =
          ErrorTo(scene.targets[lane], ToTransform(scene.chain.Fk(before[lane])));
      const double angle = error.angular.norm();
      EXPECT_NEAR(std::sqrt(scene.state.distance2[lane]) / scene.folded.per_metre,
                  error.linear.norm(), 1e-12);
      EXPECT_NEAR(2 * std::atan(std::sqrt(scene.state.turn2[lane]) / 2), angle,
                  angle < 3 ? 1e-9 : 0.04);
    }
  }
}

// At half a turn the rotation's axis is undefined and its sine is 0.
TEST(LaneKernel, IsNotConvergedHalfATurnAway) {
  Scene scene(7, 0);
  scene.options.distance2 = scene.options.turn2 = 1;
  for (const double off : {0.0, 1e-12, 1e-6, 1e-3, 0.05}) {
    for (int lane = 0; lane < LaneCount(); ++lane) {
      const Eigen::Vector3d axis =
          Eigen::Vector3d(scene.rng.Normal(), scene.rng.Normal(), scene.rng.Normal()).normalized();
      Transform target = ToTransform(scene.chain.Fk(scene.Q(lane)));
      target.rotation *= Eigen::AngleAxisd(std::numbers::pi - off, axis).toRotationMatrix();
      scene.Aim(lane, target);
    }
    EXPECT_EQ(scene.Step(), 0u) << off;
    for (int lane = 0; lane < LaneCount(); ++lane) EXPECT_GT(scene.state.turn2[lane], 1000) << off;
  }
}

TEST(LaneKernel, ConvergesToNearTargetsInFewSteps) {
  Scene scene(7, 0, 0.1);
  const double tolerance = 1e-8;
  scene.options.distance2 = std::pow(tolerance * scene.folded.per_metre, 2);
  scene.options.turn2 = tolerance * tolerance;
  uint32_t arrived = 0;
  for (int k = 0; k < 12; ++k) arrived = scene.Step();
  EXPECT_EQ(arrived, (1U << LaneCount()) - 1);
  const LaneState there = scene.state;
  scene.Step();
  for (int i = 0; i < 7; ++i)
    EXPECT_TRUE(std::ranges::equal(std::span(there.q[i]), std::span(scene.state.q[i])));
}

// Bit for bit, in any lane and with any neighbours.
TEST(LaneKernel, LanesAreIndependent) {
  for (const int joints : {6, 7, 9}) {
    Scene scene(joints);
    const JointVector first = scene.Q(0);
    const Transform target = scene.targets[0];
    for (int k = 0; k < 5; ++k) scene.Step();
    const JointVector moved = scene.Q(0);
    for (int lane = 0; lane < LaneCount(); ++lane) {
      Scene other(joints, 0.2, 2);
      for (int i = 0; i < joints; ++i) other.state.q[i][lane] = first[i];
      other.Aim(lane, target);
      for (int k = 0; k < 5; ++k) other.Step();
      EXPECT_EQ(other.Q(lane), moved) << joints << " joints, lane " << lane;
    }
  }
}

// Bit for bit: one query uses shorter registers than many.
TEST(LaneKernel, TakesTheSameStepsInFewLanes) {
  OnEveryInstructionSet([](const std::string& name) {
    for (const int joints : {6, 7, 9}) {
      for (const int lanes : {1, LanesOfOneQuery()}) {
        Scene all(joints), few(joints);
        for (int k = 0; k < 6; ++k) {
          all.Step();
          StepLanes(few.folded, few.options, (1U << lanes) - 1, &few.state);
          for (int lane = 0; lane < lanes; ++lane) {
            EXPECT_EQ(few.Q(lane), all.Q(lane)) << name << ", " << joints << " joints";
            EXPECT_EQ(few.state.distance2[lane], all.state.distance2[lane]);
            EXPECT_EQ(few.state.turn2[lane], all.state.turn2[lane]);
            EXPECT_EQ(few.state.best_cost[lane], all.state.best_cost[lane]);
          }
        }
      }
    }
  });
}

TEST(LaneKernel, ObeysLimitsAndLocks) {
  Scene scene(7, 0.3, 3);
  scene.options.locked[2] = scene.options.locked[5] = true;
  std::vector<JointVector> before;
  for (int lane = 0; lane < LaneCount(); ++lane) before.push_back(scene.Q(lane));
  for (int k = 0; k < 20; ++k) {
    scene.Step();
    for (int lane = 0; lane < LaneCount(); ++lane) {
      const JointVector q = scene.Q(lane);
      for (int i = 0; i < 7; ++i) {
        EXPECT_GE(q[i], scene.chain.joints()[i].lower);
        EXPECT_LE(q[i], scene.chain.joints()[i].upper);
      }
      EXPECT_EQ(q[2], before[lane][2]);
      EXPECT_EQ(q[5], before[lane][5]);
    }
  }
}

TEST(LaneKernel, KeepsTheBestConfiguration) {
  Scene scene(4, 0, 3);  // four joints reach few poses
  double least[kMaxLanes];
  std::fill(std::begin(least), std::end(least), INFINITY);
  for (int k = 0; k < 30; ++k) {
    scene.Step();
    for (int lane = 0; lane < LaneCount(); ++lane)
      least[lane] = std::min(least[lane], scene.state.distance2[lane] + scene.state.turn2[lane]);
  }
  for (int lane = 0; lane < LaneCount(); ++lane) {
    EXPECT_EQ(scene.state.best_cost[lane], least[lane]);
    for (int i = 0; i < 4; ++i) scene.state.q[i][lane] = scene.state.best_q[i][lane];
  }
  scene.Step();
  for (int lane = 0; lane < LaneCount(); ++lane)
    EXPECT_EQ(scene.state.distance2[lane] + scene.state.turn2[lane], least[lane]);
}

}  // namespace
}  // namespace robocell::internal
