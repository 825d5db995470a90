// Tests reading and writing of groups, for joints and actuators of every kind.
#include "robocell/robot/group_core.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

// A floating trunk with a ball joint, a slide and a hinge, and actuators of all sorts.
const char* kOddBody = R"(
  <compiler angle="radian" autolimits="true"/>
  <default><geom size="0.05" mass="1" contype="0" conaffinity="0"/></default>
  <worldbody>
    <body name="trunk"><freejoint name="float"/><geom/>
      <body name="head" pos="0 0 0.2"><joint name="neck" type="ball"/><geom pos="0 0 0.1"/>
        <body name="jaw"><joint name="slide" type="slide" axis="0 0 1" range="-0.1 0.2"/><geom/>
          <body name="tongue"><joint name="hinge" axis="0 1 0" range="-1 1"/><geom pos="0.1 0 0"/>
            <site name="tip" pos="0.1 0 0"/></body></body></body></body>
  </worldbody>
  <tendon><fixed name="sum"><joint joint="slide" coef="2"/><joint joint="hinge" coef="1"/></fixed></tendon>
  <actuator>
    <position name="geared" joint="slide" kp="100" gear="4"/>
    <general name="scaled" joint="hinge" gainprm="2" biastype="affine" biasprm="10 -50 -1" ctrlrange="-100 20"/>
    <position name="pulled" tendon="sum" kp="10"/>
    <motor name="motor" joint="hinge"/>
    <intvelocity name="integrated" joint="hinge" kp="5" actrange="-1 1"/>
  </actuator>)";

class OddGroup : public ::testing::Test {
 protected:
  GroupCore Make(std::vector<std::string> joints, std::vector<std::string> actuators) {
    const FrameName trunk{false, "trunk"};
    return GroupCore(scene, {.group = "odd",
                             .joints = std::move(joints),
                             .actuators = std::move(actuators),
                             .root = trunk,
                             .leaf = {true, "tip"},
                             .robot_base = trunk});
  }

  ModelFolder folder;
  Scene scene = Scene::Build(SceneWith({.path = folder.Write("odd", kOddBody)}));
  const mjModel* m = scene.model();
  GroupCore all = Make({"hinge", "float", "slide", "neck"}, {});
};

std::vector<double> Numbered(int n) {
  std::vector<double> v(n);
  for (int i = 0; i < n; ++i) v[i] = 0.1 * (i + 1);
  return v;
}

TEST_F(OddGroup, ReadsAndWritesJointsInItsOrder) {
  EXPECT_EQ(all.nq(), 1 + 7 + 1 + 4);
  EXPECT_EQ(all.nv(), 1 + 6 + 1 + 3);
  const std::vector<double> q = Numbered(13), v = Numbered(11);
  all.SetJointPos(q);
  all.SetJointVel(v);
  std::vector<double> got_q(13), got_v(11);
  all.GetJointPos(got_q);
  all.GetJointVel(got_v);
  EXPECT_EQ(got_q, q);
  EXPECT_EQ(got_v, v);
  const int hinge = RequireId(m, mjOBJ_JOINT, "hinge", "");
  EXPECT_EQ(scene.data()->qpos[m->jnt_qposadr[hinge]], q[0]);
  EXPECT_EQ(scene.data()->qvel[m->jnt_dofadr[hinge]], v[0]);
}

TEST_F(OddGroup, IntegratesLikeTheEngine) {
  std::vector<double> q(13), v(11), expected(scene.data()->qpos, scene.data()->qpos + m->nq);
  Rng rng = Rng::Stream(1, "integrate");
  for (int k = 0; k < 50; ++k) {
    std::vector<double> velocity(static_cast<size_t>(m->nv));
    for (double& x : velocity) x = rng.Uniform(-1, 1);
    std::copy(velocity.begin(), velocity.end(), scene.data()->qvel);
    all.GetJointPos(q);
    all.GetJointVel(v);
    all.Integrate(q, v);
    mj_integratePos(m, expected.data(), velocity.data(), 1);
    all.SetJointPos(q);
    for (int i = 0; i < m->nq; ++i) EXPECT_NEAR(scene.data()->qpos[i], expected[i], 1e-12);
  }
}

TEST_F(OddGroup, HasLimitsOnlyWhereJointsHaveThem) {
  const std::vector<Interval> limits = all.joint_pos_limits();
  ASSERT_EQ(limits.size(), 13u);
  EXPECT_EQ(limits[0].lower, -1);
  EXPECT_EQ(limits[8].upper, 0.2);
  for (const int i : {1, 4, 7, 9, 12}) EXPECT_TRUE(std::isinf(limits[i].upper)) << i;
}

TEST_F(OddGroup, JacobianMatchesTheEngineForEveryJointType) {
  all.SetJointPos(Numbered(13));
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, 11);
  all.Jacobian(jacobian);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> p(3, m->nv), r(3, m->nv);
  mj_jacSite(m, scene.data(), p.data(), r.data(), RequireId(m, mjOBJ_SITE, "tip", ""));
  int column = 0;
  for (const int joint : all.joint_ids()) {
    const int width = m->jnt_type[joint] == mjJNT_FREE   ? 6
                      : m->jnt_type[joint] == mjJNT_BALL ? 3
                                                         : 1;
    for (int k = 0; k < width; ++k, ++column) {
      const int dof = m->jnt_dofadr[joint] + k;
      EXPECT_EQ(jacobian.col(column).head<3>(), p.col(dof));
      EXPECT_EQ(jacobian.col(column).tail<3>(), r.col(dof));
    }
  }
}

// Returns the engine's force of an actuator with this control at the present lengths.
double ForceWith(Scene& scene, const char* actuator, double ctrl) {
  scene.SetActuatorCtrl(actuator, ctrl);
  scene.Forward();
  return scene.data()->actuator_force[RequireId(scene.model(), mjOBJ_ACTUATOR, actuator, "")];
}

TEST_F(OddGroup, NoopCtrlHoldsServosOfEveryKindAtRest) {
  GroupCore group = Make({"slide", "hinge"}, {"geared", "scaled", "pulled", "motor", "integrated"});
  group.SetJointPos(std::vector<double>{0.15, -0.6});
  std::vector<double> ctrl(5);
  group.NoopCtrl(ctrl);
  EXPECT_NEAR(ForceWith(scene, "geared", ctrl[0]), 0, 1e-12);
  EXPECT_NEAR(ForceWith(scene, "scaled", ctrl[1]), 0, 1e-12);
  EXPECT_NEAR(ForceWith(scene, "pulled", ctrl[2]), 0, 1e-12);
  EXPECT_DOUBLE_EQ(ctrl[0], 0.6);
  EXPECT_EQ(ctrl[3], 0) << "a motor rests at no force";
  EXPECT_EQ(ctrl[4], 0) << "an integrator rests at no speed";
}

TEST_F(OddGroup, NoopCtrlFollowsATeleportInsideOfAReset) {
  GroupCore group = Make({"slide", "hinge"}, {"geared", "pulled"});
  std::vector<double> ctrl(2);
  scene.AddResetHook([&](ResetContext& reset) {
    reset.scene.data()->qpos[group.model()->jnt_qposadr[group.joint_ids()[0]]] = 0.1;
  });
  struct Watch : SceneObserver {
    std::function<void()> read;
    void OnReset() override { read(); }
  };
  const auto watch = std::make_shared<Watch>();
  watch->read = [&] { group.NoopCtrl(ctrl); };
  scene.AddObserver(watch);
  scene.Reset();
  EXPECT_DOUBLE_EQ(ctrl[0], 0.4);
  EXPECT_DOUBLE_EQ(ctrl[1], 0.2);
}

TEST_F(OddGroup, CtrlForJointPosHoldsServosAtRest) {
  GroupCore group = Make({"slide", "hinge"}, {"geared", "scaled"});
  std::vector<double> ctrl(2);
  const std::vector<double> q{0.15, -0.6};
  group.CtrlForJointPos(q, ctrl);
  group.SetJointPos(q);
  EXPECT_NEAR(ForceWith(scene, "geared", ctrl[0]), 0, 1e-12);
  EXPECT_NEAR(ForceWith(scene, "scaled", ctrl[1]), 0, 1e-12);
  group.CtrlForJointPos(std::vector<double>{0, 1}, ctrl);
  EXPECT_EQ(ctrl[1], 20) << "clamped to the control range";
}

TEST_F(OddGroup, CtrlForJointPosNamesAnUnsuitableActuator) {
  std::vector<double> ctrl(1);
  for (const char* name : {"pulled", "motor", "integrated"}) {
    GroupCore group = Make({"hinge"}, {name});
    ExpectThrow<ArgumentError>([&] { group.CtrlForJointPos(std::vector<double>{0}, ctrl); },
                               std::string("group 'odd': actuator '") + name +
                                   "' is not a position servo of one of its joints");
  }
}

TEST_F(OddGroup, RejectsWrongSizesAndInvalidNumbersByName) {
  GroupCore group = Make({"hinge", "slide"}, {"motor"});
  std::vector<double> one(1), two(2);
  ExpectThrow<ArgumentError>([&] { group.GetJointPos(one); },
                             "group 'odd': expected 2 joint values, got 1");
  ExpectThrow<ArgumentError>([&] { group.SetJointVel(one); },
                             "group 'odd': expected 2 joint velocity values, got 1");
  ExpectThrow<ArgumentError>([&] { group.SetCtrl(two); },
                             "group 'odd': expected 1 control value, got 2");
  ExpectThrow<ArgumentError>(
      [&] {
        group.SetJointPos(std::vector<double>{0, NAN});
      },
      "group 'odd': joint 'slide' cannot be set to nan");
  ExpectThrow<ArgumentError>([&] { group.SetCtrl(std::vector<double>{INFINITY}); },
                             "group 'odd': actuator 'motor' cannot be set to inf");
  std::vector<double> q = Numbered(13);
  q[3] = NAN;
  ExpectThrow<ArgumentError>([&] { all.SetJointPos(q); }, "group 'odd': value 3 cannot be set");
  Eigen::Matrix<double, 6, Eigen::Dynamic> narrow(6, 1);
  ExpectThrow<ArgumentError>([&] { group.Jacobian(narrow); },
                             "group 'odd': expected 2 Jacobian column values, got 1");
}

TEST_F(OddGroup, NamesAMissingElement) {
  ExpectThrow<NotFoundError>(
      [&] { Make({"hing"}, {}); },
      "scene 'test' / group 'odd': no joint 'hing'. Its joints: float, neck, "
      "slide, hinge. Did you mean 'hinge'?");
  ExpectThrow<NotFoundError>([&] { Make({}, {"moter"}); }, "Did you mean 'motor'?");
}

TEST_F(OddGroup, FramesMatchTheSceneAfterSteps) {
  EXPECT_TRUE(scene.StepN(10).ok());
  EXPECT_EQ(all.leaf_frame_to_world(), scene.site_pose("tip"));
  EXPECT_EQ(all.root_frame_to_world(), scene.body_pose("trunk"));
  EXPECT_EQ(all.leaf_frame_to_robot(), scene.body_pose("trunk").inverse() * scene.site_pose("tip"));
}

}  // namespace
}  // namespace robocell
