// Tests the built-in filter for inverse kinematics against the engine.
#include "robocell/robot/collision_filter.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <thread>

#include "robocell/base/error.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/mujoco/owners.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

// The built-in robot behind a wall, and a ball beside it.
class CollisionFilterTest : public testing::Test {
 protected:
  static SceneSpec Spec() {
    SceneSpec spec = SceneWith({.name = "rc7", .config = Rc7()});
    SceneObject wall = BoxObject("wall", {0.45, 0, 0.3});
    wall.size = Vec3{0.02, 0.5, 0.3};
    wall.fixed = true;
    spec.objects.push_back(wall);
    return spec;
  }

  JointVector RandomJoints() {
    JointVector q(robot_.n_joints());
    for (int i = 0; i < q.size(); ++i)
      q[i] = rng_.Uniform(robot_.joint_limits()[i].lower, robot_.joint_limits()[i].upper);
    return q;
  }

  // Runs a full forward pass of the engine, with its own margins.
  bool EngineSeesContact(const JointVector& q) {
    const mjModel* m = scene_.model();
    const DataPtr d = CopyData(m, scene_.data());
    for (int i = 0; i < q.size(); ++i) d->qpos[robot_.chain().joints()[i].qpos_address] = q[i];
    mj_forward(m, d.get());
    std::vector<char> own(m->ngeom, 0);
    for (const int g : robot_.geom_ids()) own[g] = 1;
    for (int c = 0; c < d->ncon; ++c) {
      const auto [a, b] = d->contact[c].geom;
      if (d->contact[c].dist < 0 && (own[a] || own[b])) return true;
    }
    return false;
  }

  Rng rng_ = Rng::Stream(1, "collision filter");
  Scene scene_ = Scene::Build(Spec());
  Robot robot_ = Robot::Of(scene_, "rc7");
};

TEST_F(CollisionFilterTest, AgreesWithTheEngine) {
  CollisionFilter filter(robot_);
  int touching = 0;
  for (int k = 0; k < 200; ++k) {
    const JointVector q = RandomJoints();
    const bool contact = EngineSeesContact(q);
    EXPECT_EQ(filter.IsFree(q), !contact) << k;
    touching += contact;
  }
  EXPECT_GT(touching, 20);
  EXPECT_LT(touching, 180);
  EXPECT_EQ(scene_.time(), 0);
}

TEST_F(CollisionFilterTest, FiltersInverseKinematics) {
  const CollisionFilter filter(robot_, {.clearance = 0.02});
  std::vector<Pose> targets;
  for (int k = 0; k < 4000 && targets.size() < 60; ++k) {
    // Targets whose first solution touches something, but not every solution does.
    const JointVector q = RandomJoints();
    const Pose target = robot_.chain().Fk(q);
    const IkResult first = Ik(robot_.chain(), target);
    if (CollisionFilter(filter).IsFree(q) && EngineSeesContact(first.q)) targets.push_back(target);
  }
  ASSERT_GE(targets.size(), 20u);
  const IkBatchResult plain = IkBatch(robot_.chain(), targets);
  const IkBatchResult found = IkBatch(robot_.chain(), targets, {}, {.ik = {.filter = filter}});
  int colliding = 0;
  for (int b = 0; b < found.size; ++b) {
    colliding += EngineSeesContact(JointVector(plain.row(b)));
    if (!found.success[b]) continue;
    EXPECT_FALSE(EngineSeesContact(JointVector(found.row(b)))) << b;
  }
  EXPECT_GT(colliding, 5) << "else the filter had nothing to do";
  EXPECT_GE(found.solved(), 0.8 * static_cast<double>(targets.size()));
  const IkResult one = robot_.Ik(targets[0], {.filter = filter});
  EXPECT_TRUE(one.success);
  EXPECT_FALSE(EngineSeesContact(one.q));
}

TEST_F(CollisionFilterTest, BodiesCanBeIgnored) {
  CollisionFilter strict(robot_), through(robot_, {.ignored = {"wall"}});
  int only_the_wall = 0;
  for (int k = 0; k < 300; ++k) {
    const JointVector q = RandomJoints();
    EXPECT_LE(strict.IsFree(q), through.IsFree(q));
    only_the_wall += through.IsFree(q) && !strict.IsFree(q);
  }
  EXPECT_GT(only_the_wall, 5);
}

// Copies share the data that configurations are put into.
TEST_F(CollisionFilterTest, CanBeSharedByThreads) {
  constexpr int kCount = 2000;
  CollisionFilter filter(robot_);
  std::vector<double> q;
  for (int k = 0; k < kCount; ++k) {
    for (const double v : RandomJoints()) q.push_back(v);
  }
  std::vector<uint8_t> alone(kCount), first(kCount), second(kCount);
  filter(q, kCount, alone);
  {
    const auto judge = [&](CollisionFilter copy, std::vector<uint8_t>* keep) {
      copy(q, kCount, *keep);
    };
    const std::jthread one(judge, filter, &first), two(judge, filter, &second);
    for (int k = 0; k < 50; ++k) filter.Update();
  }
  EXPECT_EQ(first, alone);
  EXPECT_EQ(second, alone);
}

TEST_F(CollisionFilterTest, IsInvalidAfterObjectsAreAdded) {
  CollisionFilter filter(robot_);
  scene_.AddObject(BoxObject("other", {3, 3, 1}));
  ExpectThrow<Error>([&] { filter.IsFree(JointVector(7)); },
                     "objects were added or removed since the robot's surroundings were looked at; "
                     "make the filter again");
  ExpectThrow<Error>([&] { filter.Update(); }, "make the filter again");
}

TEST_F(CollisionFilterTest, RejectsInvalidOptions) {
  ExpectThrow<ArgumentError>([&] { CollisionFilter(robot_, {.clearance = -1}); },
                             "collision filter: clearance is -1 m; it must be 0 or more");
  ExpectThrow<NotFoundError>([&] { CollisionFilter(robot_, {.ignored = {"wal"}}); },
                             "Did you mean 'wall'?");
  CollisionFilter filter(robot_);
  std::vector<double> q(10);
  std::vector<uint8_t> keep(2);
  ExpectThrow<ArgumentError>([&] { filter(q, 2, keep); },
                             "expected 14 values for 2 configurations of 7 joints, got 10");
}

}  // namespace
}  // namespace robocell
