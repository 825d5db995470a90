// Tests where two hands can meet; forward kinematics and the planner are the oracles.
#include "robocell/expert/hand_meetings.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell {
namespace {

TEST(HandMeetings, HaveBothHandsOnTheObjectAndNoCollision) {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.name = "duo", .config = LoadShipped("examples/duo/duo.yaml")});
  SceneObject bar = BoxObject("bar", {2, 0, 0.5});  // out of the way
  bar.size = Vec3{0.1, 0.015, 0.015};
  spec.objects.push_back(bar);
  Scene scene = Scene::Build(spec);
  scene.Reset();
  const Robot duo = Robot::Of(scene, "duo"), left = Robot::Of(scene, "duo/left"),
              right = Robot::Of(scene, "duo/right");
  const Eigen::Vector3d middle =
      (left.tcp_in_world().translation() + right.tcp_in_world().translation()) / 2;
  const internal::HandMeetings meetings(left, right, "bar", middle);
  // The left hand holds the bar from above, near one end.
  const Pose held = Pose::FromRpy({0.06, 0, 0}, {3.14159265358979, 0, 0});
  ASSERT_TRUE(meetings.HasRoom(held));
  const std::vector<std::pair<std::string, std::string>> touching = {{"bar", ""}};
  const MotionPlanner planner(
      duo, {.groups = {"left", "right"}, .clearance = 0.004, .allowed_contacts = touching});
  int found = 0;
  meetings.Find(scene.body_pose("bar"), held, planner, planner, 300, [&](const auto& meeting) {
    const auto tcp = [&](const Robot& arm, const JointVector& q) {
      return arm.base_in_world() * arm.chain().Fk(q);
    };
    const Pose& object = meeting.object;
    EXPECT_TRUE(tcp(left, meeting.giver).is_close(object * held, 1e-4, 1e-4));
    EXPECT_TRUE(tcp(right, meeting.before).is_close(object * meeting.grasp.before(), 1e-4, 1e-4));
    EXPECT_TRUE(tcp(right, meeting.taken).is_close(object * meeting.grasp.tcp_in_body, 1e-4, 1e-4));
    EXPECT_GT((meeting.grasp.tcp_in_body.translation() - held.translation()).norm(), 0.04);
    std::vector<double> both(meeting.giver.begin(), meeting.giver.end());
    both.insert(both.end(), meeting.taken.begin(), meeting.taken.end());
    EXPECT_TRUE(planner.IsFree(both));
    return ++found == 3;
  });
  EXPECT_EQ(found, 3);
}

}  // namespace
}  // namespace robocell
