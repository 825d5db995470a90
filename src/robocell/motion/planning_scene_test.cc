#include "robocell/motion/planning_scene.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <set>
#include <string>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/motion/clearance.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

JointVector RandomJoints(const PickScene& pick, Rng& rng) {
  JointVector q(pick.robot.n_joints());
  const std::vector<Interval> limits = pick.robot.joint_limits();
  for (int i = 0; i < q.size(); ++i) q[i] = rng.Uniform(limits[i].lower, limits[i].upper);
  return q;
}

// Returns contacts of the real model with the robot at q, by a full forward pass.
bool EngineSeesContact(const PickScene& pick, const JointVector& q, double gap) {
  const mjModel* m = pick.scene.model();
  const DataPtr d = CopyData(m, pick.scene.data());
  for (int i = 0; i < q.size(); ++i) d->qpos[pick.robot.chain().joints()[i].qpos_address] = q[i];
  const auto shape = pick.shape();
  std::vector<double> fingers(shape->joint_names().size());
  shape->JointsAt(gap, fingers);
  for (size_t i = 0; i < fingers.size(); ++i) {
    const std::string name = "robot_0/" + shape->joint_names()[i];
    d->qpos[m->jnt_qposadr[mj_name2id(m, mjOBJ_JOINT, name.c_str())]] = fingers[i];
  }
  mj_forward(m, d.get());
  std::vector<char> own(m->ngeom, 0);
  for (const int g : pick.robot.geom_ids()) own[g] = 1;
  for (int c = 0; c < d->ncon; ++c) {
    if ((own[d->contact[c].geom[0]] || own[d->contact[c].geom[1]]) && d->contact[c].dist < 0)
      return true;
  }
  return false;
}

TEST(PlanningScene, AgreesWithTheEnginesContacts) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("mug"));
  PlanningScene planning = pick.planning();
  Rng rng = Rng::Stream(1, "contacts");
  int touching = 0;
  const int tries = 400;
  for (int i = 0; i < tries; ++i) {
    const JointVector q = RandomJoints(pick, rng);
    const double gap = rng.Uniform(0.01, 0.09);
    const bool contact = EngineSeesContact(pick, q, gap);
    EXPECT_EQ(planning.IsFree(q, {.gap = gap}), !contact) << i;
    touching += contact;
  }
  EXPECT_GT(touching, tries / 20);
  EXPECT_LT(touching, tries / 2);
  EXPECT_EQ(planning.checks(), tries);
}

// The object in the hand moves with the forward kinematics.
TEST(PlanningScene, AHeldObjectMovesWithTheHandAndMayTouchIt) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  PlanningScene planning = pick.planning();
  const mjModel* m = pick.scene.model();
  const Pose in_tcp = Pose::FromRpy({0.01, 0, 0.02}, {0.3, 0.2, 0.1});
  planning.HoldTarget(in_tcp);
  const int target = mj_name2id(m, mjOBJ_BODY, pick.target_body.c_str());
  std::vector<char> robot(m->ngeom, 0);
  for (const int g : pick.robot.geom_ids()) robot[g] = 1;
  const auto engine_says = [&](const JointVector& q, double gap) {
    const DataPtr d = CopyData(m, pick.scene.data());
    for (int i = 0; i < q.size(); ++i) d->qpos[pick.robot.chain().joints()[i].qpos_address] = q[i];
    const auto shape = pick.shape();
    std::vector<double> fingers(shape->joint_names().size());
    shape->JointsAt(gap, fingers);
    for (size_t i = 0; i < fingers.size(); ++i) {
      const std::string name = "robot_0/" + shape->joint_names()[i];
      d->qpos[m->jnt_qposadr[mj_name2id(m, mjOBJ_JOINT, name.c_str())]] = fingers[i];
    }
    mj_kinematics(m, d.get());
    const int tcp = mj_name2id(m, mjOBJ_SITE, "robot_0/tcp");
    const Pose held =
        Pose::FromTranslationAndMatrix(d->site_xpos + 3 * tcp, d->site_xmat + 9 * tcp) * in_tcp;
    held.ToWxyz(d->qpos + m->jnt_qposadr[m->body_jntadr[target]],
                d->qpos + m->jnt_qposadr[m->body_jntadr[target]] + 3);
    mj_forward(m, d.get());
    for (int c = 0; c < d->ncon; ++c) {
      const int a = d->contact[c].geom[0], b = d->contact[c].geom[1];
      const bool held_a = m->geom_bodyid[a] == target, held_b = m->geom_bodyid[b] == target;
      if (d->contact[c].dist >= 0 || (held_a && robot[b]) || (held_b && robot[a])) continue;
      if (robot[a] || robot[b] || held_a || held_b) return true;
    }
    return false;
  };
  Rng rng = Rng::Stream(4, "held");
  int touching = 0;
  for (int i = 0; i < 400; ++i) {
    const JointVector q = RandomJoints(pick, rng);
    const bool contact = engine_says(q, 0.04);
    EXPECT_EQ(planning.IsFree(q, {.gap = 0.04}), !contact) << i;
    touching += contact;
  }
  EXPECT_GT(touching, 20);
}

TEST(PlanningScene, AReleasedObjectStaysInPlace) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  PlanningScene planning = pick.planning();
  const JointVector home = pick.home();
  ASSERT_TRUE(planning.IsFree(home, {.gap = 0.04}));
  planning.PutTarget(pick.robot.tcp_in_world());
  EXPECT_FALSE(planning.IsFree(home, {.gap = 0.01}));
  EXPECT_TRUE(planning.IsFree(home, {.gap = 0.01, .touch_target = true}));
  planning.HoldTarget(Pose());
  EXPECT_TRUE(planning.IsFree(home, {.gap = 0.01}));
  planning.Update();
  EXPECT_TRUE(planning.IsFree(home, {.gap = 0.04}));
}

// The distances that judge a base placement are an independent way to the same numbers.
TEST(PlanningScene, ClearanceIsTheDistanceToTheSurroundings) {
  PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  PlanningScene planning = pick.planning();
  const double open = pick.shape()->open_gap();
  Rng rng = Rng::Stream(2, "clearance");
  int compared = 0;
  for (int i = 0; i < 4000 && compared < 8; ++i) {
    const JointVector q = RandomJoints(pick, rng);
    if (!planning.IsFree(q, {.gap = open})) continue;
    pick.robot.SetJointPos(q);
    const internal::Clearance nearest =
        internal::RobotClearance(pick.scene, pick.robot, kMostClearance);
    if (nearest.distance < 0.004 || nearest.distance > kMostClearance - 0.004) continue;
    if (nearest.robot_geom.find("pedestal") != std::string::npos) continue;
    ++compared;
    EXPECT_TRUE(planning.IsFree(q, {.gap = open, .clearance = nearest.distance - 0.002}))
        << nearest.robot_geom;
    EXPECT_FALSE(planning.IsFree(q, {.gap = open, .clearance = nearest.distance + 0.002}))
        << nearest.robot_geom;
  }
  EXPECT_EQ(compared, 8);
}

// A ball between the fingers is in a vessel, and moves with it; or it lies between the legs of a
// stool, where it is in the way.
TEST(PlanningScene, WhatMovesWithTheHeldObjectLiesInAHollowOfIt) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  const Pose tcp(pick.robot.tcp_in_world().translation());
  constexpr const char* kSides =
      R"(<geom type="box" size=".002 .04 .04" pos=".04 0 0"/>
         <geom type="box" size=".002 .04 .04" pos="-.04 0 0"/>
         <geom type="box" size=".04 .002 .04" pos="0 .04 0"/>
         <geom type="box" size=".04 .002 .04" pos="0 -.04 0"/>)";
  constexpr const char* kFloor = R"(<geom type="box" size=".04 .04 .002" pos="0 0 -.04"/>)";
  constexpr const char* kTop = R"(<geom type="box" size=".04 .04 .002" pos="0 0 .04"/>)";
  constexpr const char* kLegs = R"(<geom type="box" size=".004 .004 .04" pos=".036 .036 0"/>
                                   <geom type="box" size=".004 .004 .04" pos="-.036 -.036 0"/>)";
  const std::pair<std::string, bool> shapes[] = {
      {std::string(kSides) + kFloor, true},
      {std::string(kLegs) + kTop, false},
      {std::string(kSides) + kTop, false},  // upside down
      {std::string(kLegs) + kFloor, false}};
  for (const auto& shape : shapes) {
    ModelFolder folder;
    SceneSpec spec = pick.scene.spec();
    spec.objects[0] = {
        .name = "target",
        .mjcf_path = folder.Write("held", "<worldbody><body name=\"held\"><freejoint/>" +
                                              shape.first + "</body></worldbody>"),
        .pos = ToVec3(tcp.translation()),
        .fixed = false};
    SceneObject ball = BoxObject("ball", ToVec3(tcp.translation()));
    ball.shape = Shape::kSphere;
    ball.size = Vec3{0.012, 0, 0};
    spec.objects.push_back(ball);
    Scene scene = Scene::Build(spec);
    scene.Reset();
    scene.Forward();
    const Robot robot = Robot::Of(scene, pick.robot.name());
    PlanningScene planning(scene, robot, scene.compiled()->object("target").root_body,
                           pick.shape());
    planning.HoldTarget(robot.tcp_in_world().inverse() * tcp);
    EXPECT_EQ(planning.IsFree(pick.home(), {.gap = 0.015}), shape.second) << shape.first;
  }
}

TEST(PlanningScene, OnlyReadsTheSimulation) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("nut"));
  const std::vector<double> before = pick.scene.state();
  const double margin = pick.scene.model()->opt.o_margin;
  const int flags = pick.scene.model()->opt.enableflags;
  PlanningScene planning = pick.planning();
  Rng rng = Rng::Stream(3, "read");
  for (int i = 0; i < 20; ++i)
    planning.IsFree(RandomJoints(pick, rng), {.gap = 0.05, .clearance = 0.02});
  EXPECT_EQ(pick.scene.state(), before);
  EXPECT_EQ(pick.scene.model()->opt.o_margin, margin);
  EXPECT_EQ(pick.scene.model()->opt.enableflags, flags);
}

TEST(PlanningScene, UsesObjectPosesOfTheLastUpdate) {
  PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  PlanningScene planning = pick.planning();
  const JointVector q = pick.home();
  const double open = pick.shape()->open_gap();
  ASSERT_TRUE(planning.IsFree(q, {.gap = open}));
  pick.scene.SetBodyPose(pick.target_body,
                         Pose(pick.robot.tcp_in_world() * Eigen::Vector3d(0, 0.045, 0)));
  EXPECT_TRUE(planning.IsFree(q, {.gap = open}));
  planning.Update();
  EXPECT_FALSE(planning.IsFree(q, {.gap = open}));
  EXPECT_TRUE(planning.IsFree(q, {.gap = open, .touch_target = true}));
}

TEST(PlanningScene, IsInvalidAfterObjectsAreAdded) {
  PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  PlanningScene planning = pick.planning();
  SceneObject other = pick.scene.spec().objects[0];
  other.name = "other";
  other.pos = {3, 3, 1};
  pick.scene.AddObject(other);
  ExpectThrow<Error>([&] { planning.Update(); }, "objects were added or removed since");
  ExpectThrow<Error>([&] { planning.IsFree(pick.home(), {.gap = 0.01}); }, "begin planning again");
}

// Only the hand's link counts: the others may be in the table.
TEST(PlanningScene, UsesOnlyTheConfiguredCollisionGeoms) {
  PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  RobotConfig config = pick.robot.config();
  config.collision_geoms = {ElementRef{.kind = ElementKind::kGeom, .body = "link7", .index = 0}};
  SceneSpec spec = pick.scene.spec();
  spec.robots[0].config = config;
  Scene scene = Scene::Build(spec);
  scene.Reset();
  Robot robot = Robot::Of(scene, config.name);
  EXPECT_EQ(robot.geom_ids().size(), pick.robot.geom_ids().size());
  ASSERT_EQ(robot.collision_geom_ids().size(), 2u);  // and the pedestal
  EXPECT_EQ(pick.robot.collision_geom_ids(), pick.robot.geom_ids());
  std::set<std::string> names{""};
  for (const int g : robot.collision_geom_ids())
    names.insert(Describe(scene.model(), mjOBJ_GEOM, g));
  PlanningScene all = pick.planning();
  PlanningScene few(scene, robot, scene.compiled()->object("target").root_body, pick.shape());
  Rng rng = Rng::Stream(4, "collision geoms");
  int only_all = 0;
  for (int i = 0; i < 200; ++i) {
    JointVector q(robot.n_joints());
    for (int j = 0; j < q.size(); ++j)
      q[j] = rng.Uniform(robot.joint_limits()[j].lower, robot.joint_limits()[j].upper);
    const FreedomDemand demand{.gap = pick.shape()->open_gap()};
    const bool free_of_all = all.IsFree(q, demand), free_of_few = few.IsFree(q, demand);
    EXPECT_TRUE(free_of_few || !free_of_all);
    only_all += free_of_few && !free_of_all;
    robot.SetJointPos(q);
    EXPECT_TRUE(names.contains(internal::RobotClearance(scene, robot, 0.5).robot_geom));
  }
  EXPECT_GT(only_all, 5);
}

}  // namespace
}  // namespace robocell
