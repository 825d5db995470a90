// Tests the numbers that are read from a model; chain_test.cc has the errors.
#include "robocell/kinematics/chain_builder.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/base/rng.h"
#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/testing/ik_judge.h"
#include "robocell/kinematics/testing/models.h"

namespace robocell::internal {
namespace {

BuiltChain Build(const TestModel& t, const std::vector<double>& qpos = {}) {
  return BuildChain(t.model(), "base", ChainTip::Site("tip"), {.qpos = qpos});
}

std::vector<double> PresentQpos(const TestModel& t) {
  return {t.data()->qpos, t.data()->qpos + t.model()->nq};
}

// Returns the frame of the body that joint `i` moves, in the base, from the built numbers.
Transform BodyOfJoint(const BuiltChain& chain, const JointVector& q, int i) {
  Transform frame;
  for (int k = 0; k <= i; ++k) {
    frame = frame * chain.model.joints[k].fixed;
    MoveJoint(chain.model.joints[k], q[k], &frame);
  }
  return frame * chain.model.joints[i].joint_to_body;
}

TEST(ChainBuilder, FramesOfBodiesAreThoseOfTheEngine) {
  for (int k = 0; k < 10; ++k) {
    Rng rng = Rng::Stream(k, "chain builder frames");
    TestModel t = TestModel::FromXml(RandomChainXml(&rng, {.joints = 2 + k}).Write());
    const BuiltChain chain = Build(t);
    t.Randomise(&rng);
    JointVector q(chain.model.n);
    for (int i = 0; i < chain.model.n; ++i) q[i] = t.data()->qpos[chain.joints[i].qpos_address];
    const Transform base = t.BodyInWorld("base");
    for (int i = 0; i < chain.model.n; ++i) {
      // The body's final frame is that behind its last joint.
      if (i + 1 < chain.model.n && chain.joints[i + 1].body == chain.joints[i].body) continue;
      const Transform body = BodyOfJoint(chain, q, i);
      const Transform expected = base.inverse() * t.BodyInWorld(chain.joints[i].body);
      EXPECT_LT((body.translation - expected.translation).norm(), 1e-12) << k << " " << i;
      EXPECT_LT((body.rotation - expected.rotation).norm(), 1e-12) << k << " " << i;
    }
  }
}

// The engine's centre and mass of a subtree are those of the links from its first joint on.
TEST(ChainBuilder, LinksCarryEverythingThatHangsOnThem) {
  for (int k = 0; k < 10; ++k) {
    Rng rng = Rng::Stream(k, "chain builder masses");
    TestModel t = TestModel::FromXml(RandomChainXml(&rng, {.joints = 2 + k}).Write());
    t.Randomise(&rng);
    const BuiltChain chain = Build(t, PresentQpos(t));
    JointVector q(chain.model.n);
    for (int i = 0; i < chain.model.n; ++i) q[i] = t.data()->qpos[chain.joints[i].qpos_address];
    const Transform base = t.BodyInWorld("base");
    double mass = 0;
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    for (int i = chain.model.n - 1; i >= 0; --i) {
      const JointModel& joint = chain.model.joints[i];
      const Transform frame = BodyOfJoint(chain, q, i) * joint.joint_to_body.inverse();
      mass += joint.link.mass;
      moment += joint.link.mass * frame.translation + frame.rotation * joint.link.moment;
      // The subtree of a body of two joints hangs on the last one.
      if (i > 0 && chain.joints[i - 1].body == chain.joints[i].body) continue;
      const int body = mj_name2id(t.model(), mjOBJ_BODY, chain.joints[i].body.c_str());
      EXPECT_NEAR(mass, t.model()->body_subtreemass[body], 1e-12);
      const Eigen::Vector3d center =
          Eigen::Map<const Eigen::Vector3d>(t.data()->subtree_com + 3 * body);
      EXPECT_LT((base.rotation * moment / mass + base.translation - center).norm(), 1e-12);
    }
  }
}

TEST(ChainBuilder, NoConfigurationReachesBeyondTheBound) {
  for (int k = 0; k < 10; ++k) {
    Rng rng = Rng::Stream(k, "chain builder length");
    const TestModel t =
        TestModel::FromXml(RandomChainXml(&rng, {.joints = 2 + k, .slide_share = 0.4}).Write());
    const Chain chain(t.model(), "base", ChainTip::Site("tip"));
    const ChainModel& model = chain.model();
    const Eigen::Vector3d origin = model.joints[0].fixed.translation;
    double farthest = 0;
    for (int n = 0; n < 300; ++n) {
      const Pose tip = chain.Fk(RandomJoints(chain, &rng));
      farthest = std::max(farthest, (tip.translation() - origin).norm());
    }
    EXPECT_LE(farthest, model.reach_bound * (1 + 1e-12));
    EXPECT_LE(model.length, model.reach_bound * (1 + 1e-12));
  }
}

// Known in closed form: links of 0.3 m and 0.2 m, and a slide of 0.1 m.
TEST(ChainBuilder, TheBoundOfAStretchedArmIsTheSumOfItsParts) {
  const auto arm = [](const std::string& range) {
    return TestModel::FromXml(
        "<mujoco><compiler angle='radian'/><worldbody><body name='base'><geom size='.1'/>"
        "<body pos='5 0 0'><joint axis='0 0 1'/><geom size='.1'/>"
        "<body pos='.3 0 0'><joint type='slide' axis='1 0 0' " +
        range +
        "/><geom size='.1'/><site name='tip' pos='.2 0 0'/></body></body></body></worldbody>"
        "</mujoco>");
  };
  const TestModel limited = arm("range='-.05 .1'"), free = arm("");
  const BuiltChain chain = Build(limited);
  EXPECT_NEAR(chain.model.length, 0.5, 1e-12) << "without the place of the first joint";
  EXPECT_NEAR(chain.model.reach_bound, 0.6, 1e-12);
  EXPECT_EQ(Build(free).model.reach_bound, std::numeric_limits<double>::infinity());
  EXPECT_NEAR(Build(free).model.length, 0.5, 1e-12);
}

}  // namespace
}  // namespace robocell::internal
