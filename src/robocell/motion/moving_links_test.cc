#include "robocell/motion/moving_links.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/robot/testing/coupled_arms.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

// Compares the poses of all bodies with the engine's in random configurations.
void ExpectEnginesPoses(const mjModel* m, const std::vector<int>& joints,
                        const std::vector<std::pair<int, JointPolynomial>>& followers = {}) {
  const DataPtr owner = MakeData(m);
  mjData* d = owner.get();
  Rng rng = Rng::Stream(1, "configurations");
  for (int j = 0; j < m->njnt; ++j) {
    if (m->jnt_type[j] == mjJNT_HINGE) d->qpos[m->jnt_qposadr[j]] = rng.Uniform(-0.5, 0.5);
  }
  for (const auto& [joint, of] : followers)
    d->qpos[m->jnt_qposadr[joint]] = of.at(d->qpos[m->jnt_qposadr[joints[1]]]);
  mj_kinematics(m, d);
  const MovingLinks links(m, d, joints, "test");
  std::vector<Transform> poses(links.links().size());
  for (int k = 0; k < 20; ++k) {
    std::vector<double> q;
    for (const int joint : joints) {
      q.push_back(rng.Uniform(-0.7, 0.7));
      d->qpos[m->jnt_qposadr[joint]] = q.back();
    }
    for (const auto& [joint, of] : followers) d->qpos[m->jnt_qposadr[joint]] = of.at(q[1]);
    mj_kinematics(m, d);
    links.Place(q, poses);
    for (int b = 0; b < m->nbody; ++b) {
      const Transform pose = poses[links.link_of(b)] * links.in_link(b);
      EXPECT_LT((pose.translation - Eigen::Map<Eigen::Vector3d>(d->xpos + 3 * b)).norm(), 1e-12);
      EXPECT_LT((pose.rotation - Eigen::Map<RowMajor>(d->xmat + 9 * b)).norm(), 1e-12);
    }
  }
}

std::vector<int> ArmJoints(const Robot& robot) {
  std::vector<int> joints;
  for (const std::string& name : robot.joint_names())
    joints.push_back(FindId(robot.scene().model(), mjOBJ_JOINT, name));
  return joints;
}

TEST(MovingLinks, HaveTheEnginesPosesWhateverElseIsBent) {
  const Robot robot = RobotAlone(Rc7());
  ExpectEnginesPoses(robot.scene().model(), ArmJoints(robot));
}

TEST(MovingLinks, MayBeAnyJointsInAnyOrder) {
  const Robot robot = RobotAlone(Rc7());
  std::vector<int> joints = ArmJoints(robot);
  ExpectEnginesPoses(robot.scene().model(), {joints[5], joints[1], joints[3]});
}

class CoupledLinksOfMotion : public CoupledArms {};

TEST_F(CoupledLinksOfMotion, FollowersMoveWithTheirLeaders) {
  const Robot robot = Parallelogram("[j1, j2, j4, j5, j6]");
  const mjModel* m = robot.scene().model();
  const auto id = [&](const std::string& name) {
    return FindId(m, mjOBJ_JOINT, robot.prefix() + name);
  };
  ExpectEnginesPoses(m, {id("j1"), id("j2"), id("j4"), id("j5"), id("j6")},
                     {{id("j3"), JointPolynomial{0, {0, -1, 0, 0, 0}}}});
  const DataPtr data = MakeData(m);
  mj_kinematics(m, data.get());
  const MovingLinks links(m, data.get(), std::vector{id("j2")}, "test");
  EXPECT_NEAR(links.dofs()[0].lower, -1.2, 1e-12);  // of j3: -1.7 ... 1.2
  EXPECT_NEAR(links.dofs()[0].upper, 1.7, 1e-12);
  ExpectThrow<ArgumentError>(
      [&] {
        MovingLinks(m, data.get(), std::vector{id("j2"), id("j3")}, "test");
      },
      "follows");
}

TEST(MovingLinks, RejectsJointsThatAreNoSingleNumber) {
  SceneSpec spec = SceneWith({.name = "rc7", .config = Rc7()});
  spec.objects.push_back(BoxObject("cube", {0.5, 0, 0.5}));
  const Scene scene = Scene::Build(spec);
  const mjModel* m = scene.model();
  int free = 0;
  while (m->jnt_type[free] != mjJNT_FREE) ++free;
  ExpectThrow<ArgumentError>([&] { MovingLinks(m, scene.data(), std::vector{free}, "test"); },
                             "ball or free joint");
  const int hinge = FindId(m, mjOBJ_JOINT, Robot::Of(scene, "rc7").joint_names()[0]);
  ExpectThrow<ArgumentError>(
      [&] {
        MovingLinks(m, scene.data(), std::vector{hinge, hinge}, "test");
      },
      "appears twice");
}

TEST(MovingLinks, AttachedBodiesMoveWithTheirLink) {
  SceneSpec spec = SceneWith({.name = "rc7", .config = Rc7()});
  spec.objects.push_back(BoxObject("cube", {0.5, 0, 0.5}));
  const Scene scene = Scene::Build(spec);
  const Robot robot = Robot::Of(scene, "rc7");
  const mjModel* m = scene.model();
  scene.SyncPoses();
  MovingLinks links(m, scene.data(), ArmJoints(robot), "test");
  const int cube = FindId(m, mjOBJ_BODY, "cube");
  EXPECT_EQ(links.link_of(cube), 0);
  links.Attach(m, scene.data(), cube, 7);
  EXPECT_EQ(links.link_of(cube), 7);
  std::vector<Transform> poses(links.links().size());
  std::vector<double> q(robot.jnt_pos_msr().begin(), robot.jnt_pos_msr().end());
  links.Place(q, poses);
  const Eigen::Vector3d before = (poses[7] * links.in_link(cube)).translation;
  EXPECT_LT((before - Eigen::Vector3d(0.5, 0, 0.5)).norm(), 1e-9);
  q[0] += 0.3;
  links.Place(q, poses);
  EXPECT_GT(((poses[7] * links.in_link(cube)).translation - before).norm(), 0.05);
}

}  // namespace
}  // namespace robocell::internal
