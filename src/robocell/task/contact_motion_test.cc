#include "robocell/task/contact_motion.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

ContactPath Over(const Eigen::Vector3d& at, double length, int steps = 20) {
  ContactPath path{.before = 0.05, .after = 0.05, .free_gap = 0.05, .contact_gap = 0.05};
  for (int i = 0; i <= steps; ++i) {
    path.tcp_in_world.emplace_back(at + Eigen::Vector3d(0, length * i / steps, 0),
                                   Quaternion{1, 0, 0, 0});
  }
  return path;
}

TEST(ContactMotions, FollowsItsPathByForwardKinematics) {
  const PickScene scene = MakePickScene(ObjectOnTheTable("box"));
  PlanningScene planning = scene.planning();
  planning.Update();
  const std::vector<ContactPath> paths = {Over({5, 0, 0.6}, 0.1), Over({0, 0, 0.65}, 0.1)};
  ContactMotions motions(planning, paths, scene.home());
  const auto motion = motions.Next();
  ASSERT_TRUE(motion.has_value()) << motions.Reasons();
  EXPECT_EQ(motion->path, 1u);  // the first one is out of reach
  EXPECT_EQ(motion->share, 1);
  ASSERT_EQ(motion->along.size(), paths[1].tcp_in_world.size());
  const Pose base = scene.robot.base_in_world();
  for (size_t i = 0; i < motion->along.size(); ++i) {
    const Pose tcp = base * scene.robot.chain().Fk(motion->along[i]);
    EXPECT_TRUE(tcp.is_close(paths[1].tcp_in_world[i], 1e-2, 1e-3));
  }
  EXPECT_EQ(JointDistance(motion->in.back(), motion->along.front()), 0);
  EXPECT_EQ(JointDistance(motion->out.front(), motion->along.back()), 0);
  const Pose before = base * scene.robot.chain().Fk(motion->in.front());
  EXPECT_NEAR(before.translation().z(), 0.70, 2e-3);
}

// A source is asked for more only while no path can be followed as a whole.
TEST(ContactMotions, AsksForMorePathsOnlyWhereTheFirstDoNotSuffice) {
  const PickScene scene = MakePickScene(ObjectOnTheTable("box"));
  PlanningScene planning = scene.planning();
  planning.Update();
  const std::vector<std::vector<ContactPath>> lots = {
      {Over({5, 0, 0.6}, 0.1)}, {Over({0, 0, 0.65}, 0.1)}, {Over({0, 0, 0.6}, 0.1)}};
  size_t asked = 0;
  ContactMotions motions(planning, {}, scene.home(), {.more = [&] {
                           return asked < lots.size() ? lots[asked++] : std::vector<ContactPath>();
                         }});
  const auto motion = motions.Next();
  ASSERT_TRUE(motion.has_value()) << motions.Reasons();
  EXPECT_EQ(asked, 2u);
  ASSERT_EQ(motions.paths().size(), 2u);
  EXPECT_EQ(motion->path, 1u);
  const Pose tcp = scene.robot.base_in_world() * scene.robot.chain().Fk(motion->along.back());
  EXPECT_TRUE(tcp.is_close(motions.paths()[1].tcp_in_world.back(), 1e-2, 1e-3));
  while (motions.Next()) {
  }
  EXPECT_EQ(motions.paths().size(), 3u);
  EXPECT_EQ(AllPathsOf(SourceOf(lots[0])).size(), 1u);
  EXPECT_FALSE(ContactMotions(planning, {}, scene.home(), {.more = SourceOf({})}).Next());
}

TEST(ContactMotions, TakesAPartOfAPathIfThatIsOfUse) {
  const PickScene scene = MakePickScene(ObjectOnTheTable("box"));
  PlanningScene planning = scene.planning();
  planning.Update();
  const std::vector<ContactPath> paths = {Over({0, 0, 0.65}, 3, 300)};
  EXPECT_FALSE(ContactMotions(planning, paths, scene.home()).Next().has_value());
  ContactMotions parts(planning, paths, scene.home(), {.least_share = 0.05});
  const auto part = parts.Next();
  ASSERT_TRUE(part.has_value()) << parts.Reasons();
  EXPECT_GT(part->share, 0.05);
  EXPECT_LT(part->share, 1);
  EXPECT_GT(part->out.size(), 2u);
}

// The hand comes free to the contact, and cannot leave: its way out leads into the table.
TEST(ContactMotions, RejectsPathsWithoutAWayOut) {
  const PickScene scene = MakePickScene(ObjectOnTheTable("box"));
  PlanningScene planning = scene.planning();
  planning.Update();
  ContactPath path = Over({0, 0.1, 0.47}, 0.05);
  EXPECT_TRUE(ContactMotions(planning, {path}, scene.home()).Next().has_value());
  path.away = -Eigen::Vector3d::UnitZ();
  ContactMotions motions(planning, {path}, scene.home());
  EXPECT_FALSE(motions.Next().has_value());
  EXPECT_NE(motions.Reasons().find("with no way out"), std::string::npos) << motions.Reasons();
}

TEST(ContactMotions, CountsWhyThereIsNone) {
  const PickScene scene = MakePickScene(ObjectOnTheTable("box"));
  PlanningScene planning = scene.planning();
  planning.Update();
  ContactMotions motions(planning, {Over({5, 0, 0.6}, 0.1)}, scene.home());
  EXPECT_FALSE(motions.Next().has_value());
  EXPECT_EQ(motions.Reasons(), "of 1 ways 1 out of reach");
}

}  // namespace
}  // namespace robocell
