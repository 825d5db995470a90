// For tests only: random scenes of written, built-in and Menagerie models.
#pragma once

#include <mujoco/mujoco.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "robocell/assets/resolve.h"
#include "robocell/base/rng.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/menagerie.h"
#include "robocell/testing/random_values.h"

namespace robocell {

// A thing with a hinge, an actuator with activation, an equality, a tendon, most of it without
// names.
inline const char* kLidBox = R"(
  <worldbody>
    <body name="box" pos="0 0 0.05">
      <geom type="box" size="0.05 0.05 0.02" mass="0.2"/>
      <body pos="0 0 0.03"><joint axis="0 1 0" pos="-0.05 0 0" range="0 90" limited="true" damping="0.01"/>
        <geom type="box" size="0.05 0.05 0.005" mass="0.05"/></body>
      <body pos="0 0 -0.03"><joint name="foot" type="slide" axis="0 0 1" range="-0.01 0.01" limited="true" stiffness="50" damping="1"/>
        <geom type="box" size="0.01 0.01 0.005" mass="0.05"/></body>
    </body>
  </worldbody>
  <tendon><fixed><joint joint="foot" coef="1"/></fixed></tendon>
  <equality><joint joint1="foot"/></equality>
  <actuator><general joint="foot" dyntype="filter" dynprm="0.1" gainprm="5" biastype="affine" biasprm="0 -5 0"/></actuator>)";

class RandomScenes {
 public:
  // `menagerie`: its robots that are at hand take part.
  explicit RandomScenes(bool menagerie = false)
      : arm_(ArmConfig(folder_.Write("arm", kTwoJointArm))),
        gripper_(folder_.Write("gripper", kTwoFingerGripper)),
        lid_box_(folder_.Write("lid_box", kLidBox)) {
    if (!menagerie) return;
    for (const std::string& name : MenagerieTestModels()) {
      if (MissingMenagerie({name}).empty()) menagerie_.push_back(menagerie::ModelPath(name));
    }
  }

  // 0 to 3 robots and 0 to 5 objects.
  SceneSpec Next(Rng& rng) {
    SceneSpec spec = EmptyScene();
    for (uint64_t i = 0, n = rng.UniformInt(4); i < n; ++i) spec.robots.push_back(Robot(rng, i));
    for (uint64_t i = 0, n = rng.UniformInt(6); i < n; ++i)
      spec.objects.push_back(Object(rng, "thing" + std::to_string(i)));
    return spec;
  }

  // 0 to 3 robots with 0 to 5 tools each, 0 to 10 objects, a rig, cameras.
  SceneSpec NextCell(Rng& rng) {
    SceneSpec spec = EmptyScene();
    spec.root_frame_to_world = RandomPose(rng);
    spec.shared_base_frame_to_root_frame = RandomPose(rng);
    for (uint64_t i = 0, n = rng.UniformInt(4); i < n; ++i) {
      spec.robots.push_back(menagerie_.empty() || rng.UniformInt(4) == 0 ? Robot(rng, i)
                                                                         : FromMenagerie(rng, i));
      RobotSpec& robot = spec.robots.back();
      robot.attachments = {};
      for (uint64_t k = 0, tools = rng.UniformInt(6); k < tools; ++k) Equip(rng, k, robot);
    }
    for (uint64_t i = 0, n = rng.UniformInt(11); i < n; ++i)
      spec.objects.push_back(Object(rng, "thing" + std::to_string(i)));
    for (uint64_t i = 0, n = rng.UniformInt(3); i < n; ++i) {
      spec.cameras.push_back({.name = "camera" + std::to_string(i),
                              .pos = ToVec3(RandomVector(rng, 3)),
                              .fovy = rng.Uniform(20, 90),
                              .attach_to = rng.UniformInt(2) == 0 ? Root() : World()});
    }
    return spec;
  }

  SceneObject Object(Rng& rng, const std::string& name) {
    const Vec3 pos{rng.Uniform(2, 9), rng.Uniform(-9, 9), rng.Uniform(0.1, 0.4)};
    switch (rng.UniformInt(4)) {
      case 0:
        return {.name = name, .mjcf_path = lid_box_, .pos = pos, .fixed = rng.UniformInt(2) == 0};
      case 1:
        return {.name = name, .mjcf_path = "mug", .pos = pos, .fixed = false};
      case 2:
        return {.name = name, .mjcf_path = "bracket", .pos = pos, .fixed = rng.UniformInt(2) == 0};
      default:
        return BoxObject(name, pos);
    }
  }

 private:
  RobotSpec Robot(Rng& rng, uint64_t i) {
    RobotSpec robot{.prefix = "r" + std::to_string(i) + "_", .pos = {0, 2.0 * i, 0}};
    if (rng.UniformInt(2) == 0) {
      robot.config = RobotConfig::Load(assets::BuiltinRobotFile("rc7"));
      robot.base = BaseConfig{.kind = rng.UniformInt(2) == 0 ? BaseKind::kMocap : BaseKind::kFixed};
    } else {
      robot.config = arm_;
      if (rng.UniformInt(2) == 0)
        robot.attachments = {
            {.mjcf_path = gripper_, .attach_to = {AttachKind::kSite, "flange"}, .prefix = "g_"}};
    }
    return robot;
  }

  RobotSpec FromMenagerie(Rng& rng, uint64_t i) {
    return {.path = rng.Choice(menagerie_),
            .prefix = "r" + std::to_string(i) + "_",
            .pos = {0, 2.0 * i, 0}};
  }

  // Hangs one more tool on the robot or on a tool that hangs there.
  void Equip(Rng& rng, uint64_t k, RobotSpec& robot) {
    const std::string prefix = "t" + std::to_string(k) + "_";
    std::string on;
    if (k > 0 && rng.UniformInt(2) == 0) {
      on = "t" + std::to_string(rng.UniformInt(k)) + "_palm";
    } else {
      const std::string& model = robot.config ? robot.config->model : robot.path;
      const std::string directory = robot.config ? robot.config->source_dir : "";
      on = rng.Choice(BodiesOf(assets::Resolve(model, directory)));
    }
    const Vec3 pos = ToVec3(RandomVector(rng, 0.1));
    robot.attachments.push_back(
        {.mjcf_path = gripper_, .attach_to = Body(on), .prefix = prefix, .pos = pos});
  }

  std::vector<std::string> BodiesOf(const std::string& file) {
    std::vector<std::string>& names = bodies_[file];
    if (names.empty()) {
      const ModelPtr model(mj_loadXML(file.c_str(), nullptr, nullptr, 0));
      names = ElementNames(model.get(), mjOBJ_BODY);
      std::erase(names, "world");
      std::erase(names, "");
    }
    return names;
  }

  ModelFolder folder_;
  RobotConfig arm_;
  std::string gripper_, lid_box_;
  std::vector<std::string> menagerie_;
  std::map<std::string, std::vector<std::string>> bodies_;
};

}  // namespace robocell
