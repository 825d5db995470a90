// For tests only: two hands that hold a bar, or not. Hands and bar are put in place; nothing is
// simulated.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/relations.h"
#include "robocell/task/held_relation.h"

namespace robocell {

inline constexpr double kHandHeight = 0.5;     // of the hands over the floor, m
inline constexpr double kBarHalfWidth = 0.02;  // half width of the bar between the fingers
inline constexpr double kBarSqueeze = 1e-4;    // m into the bar
inline constexpr double kHandClosed = 0.03 - kBarHalfWidth + kBarSqueeze,
                        kHandOpen = 0;  // of the finger slides

// Two hands on a beam, 0.12 m apart along y, whose fingers close along x. The arms are slides along z.
inline std::string TwoHands(ModelFolder& folder) {
  std::string bodies, servos, joined;
  for (const auto& hand : {std::pair{"l", 0.06}, {"r", -0.06}}) {
    const std::string side = hand.first;
    const double y = hand.second;
    const auto finger = [&](const char* name, int sign) {
      return fmt::format(
          R"(<body name="{0}{1}" pos="{2} 0 0"><joint name="{0}{1}" type="slide" axis="{3} 0 0" range="0 .03" damping="5"/>
<geom type="box" size=".005 .01 .01" mass=".05"/></body>)",
          side, name, sign * 0.035, -sign);
    };
    bodies += fmt::format(
        R"(<body name="{0}" pos="0 {1} {2}"><joint name="{0}z" type="slide" axis="0 0 1" range="-.5 .5" damping="5"/>
<geom type="box" size=".01 .01 .01" pos="0 0 .1" mass="1"/><site name="{0}"/>{3}{4}</body>)",
        side, y, kHandHeight, finger("a", 1), finger("b", -1));
    servos += fmt::format(
        R"(<position name="{0}z" joint="{0}z" kp="500" kv="50"/><position name="{0}g" joint="{0}a" kp="200" kv="20" ctrlrange="0 .03"/>)",
        side);
    joined += fmt::format(R"(<joint joint1="{0}a" joint2="{0}b"/>)", side);
  }
  return folder.Write(
      "hands",
      fmt::format(R"(<compiler angle="radian"/><worldbody><body name="beam">{}</body></worldbody>
<equality>{}</equality><actuator>{}</actuator>)",
                  bodies, joined, servos));
}

class TwoHandsTest : public ::testing::Test {
 protected:
  TwoHandsTest() {
    internal::RegisterTaskRelations();
    const RobotConfig hands = ParseYaml<RobotConfig>(
        "name: hands\nmodel: " + TwoHands(folder_) +
            "\nroot_body: beam\nmove_groups:\n"
            "  left: {kind: arm, joints: [lz], leaf: {site: l}}\n"
            "  right: {kind: arm, joints: [rz], leaf: {site: r}}\n"
            "  left_hand: {kind: gripper, joints: [la, lb], actuators: lg, fingers: [la, lb]}\n"
            "  right_hand: {kind: gripper, joints: [ra, rb], actuators: rg, fingers: [ra, rb]}\n",
        "hands.yaml");
    SceneSpec spec = EmptyScene();
    spec.add_floor = true;
    spec.robots.push_back({.name = "hands", .config = hands});
    SceneObject bar = BoxObject("bar", {0, 0, kHandHeight});
    bar.size = Vec3{kBarHalfWidth, 0.1, kBarHalfWidth};
    spec.objects.push_back(bar);
    spec.objects.push_back({.name = "region", .mjcf_path = "region", .pos = Vec3{0, 0, 0.001}});
    scene_.emplace(Scene::Build(spec));
    scene_->Reset();
  }

  // Closes these hands, and puts the bar between them, or elsewhere.
  void Hold(bool left, bool right, const Pose& bar = Pose(Eigen::Vector3d(0, 0, kHandHeight))) {
    Robot hands = Robot::Of(*scene_, "hands");
    for (const auto& [hand, closed] : {std::pair{"left_hand", left}, {"right_hand", right}})
      hands.group(hand).SetJointPos(std::vector<double>(2, closed ? kHandClosed : kHandOpen));
    scene_->SetBodyPose("bar", bar);
    scene_->Forward();
  }
  std::shared_ptr<BoundRelation> Bound(const std::string& text) {
    return BindRelation(*scene_, ParseRelation(text));
  }
  // Judges the present state.
  static bool Judge(BoundRelation& relation) {
    relation.Watch();
    return relation.Holds();
  }

  static Pose Lying() { return Pose(Eigen::Vector3d(0, 0, kBarHalfWidth - kBarSqueeze)); }

  ModelFolder folder_;
  std::optional<Scene> scene_;
};

}  // namespace robocell
