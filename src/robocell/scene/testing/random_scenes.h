// For tests only: random scenes of written, built-in and Menagerie models.
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "robocell/assets/resolve.h"
#include "robocell/base/rng.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/menagerie.h"
#include "robocell/testing/random_values.h"

namespace robocell {

// A body with a hinge, an actuator with activation, an equality and a tendon, mostly unnamed.
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

// A tool without joints, with a site at its end and a frame at its rim.
inline const char* kProbe = R"(
  <worldbody>
    <body name="rod" pos="0.01 0 0.02" quat="0.9 0.1 0.2 0.3">
      <geom type="capsule" size="0.01 0.03" mass="0.05"/><site name="end" pos="0 0 0.05"/>
      <frame name="rim" pos="0.02 0 0.01" euler="0 30 0"/>
    </body>
  </worldbody>)";

// A fixed stand, with a site and a frame for objects on it.
inline const char* kStand = R"(
  <worldbody>
    <body name="board" pos="0 0 0.2">
      <geom type="box" size="0.1 0.1 0.2" contype="0" conaffinity="0"/>
      <site name="top" pos="0.1 0.2 0.3" euler="10 20 30"/>
      <frame name="edge" pos="0 0.3 0.1" euler="0 0 40"/>
    </body>
  </worldbody>)";

class RandomScenes {
 public:
  // `menagerie`: its available robots take part, in turn from the `first` on.
  explicit RandomScenes(bool menagerie = false, uint64_t first = 0)
      : turn_(first),
        arm_(ArmConfig(folder_.Write("arm", kTwoJointArm))),
        gripper_(folder_.Write("gripper", kTwoFingerGripper)),
        lid_box_(folder_.Write("lid_box", kLidBox)),
        stand_(folder_.Write("stand", kStand)) {
    tools_ = {{gripper_, {Body("palm"), Site("pinch")}},
              {folder_.Write("probe", kProbe), {Body("rod"), Site("end"), Frame("rim")}},
              {assets::Resolve("ft_sensor"), {Body("ft_sensor"), Site("wrist_ft_site")}}};
    if (!menagerie) return;
    for (const std::string& name : MenagerieTestModels()) {
      if (MissingMenagerie({name}).empty()) menagerie_.push_back(menagerie::ModelPath(name));
    }
    if (MissingMenagerie({"robotiq_2f85"}).empty())
      tools_.push_back({menagerie::ModelPath("robotiq_2f85"), {Body("base"), Site("pinch")}});
  }

  // Returns a scene with 0 to 3 robots and 0 to 5 objects.
  SceneSpec Next(Rng& rng) {
    SceneSpec spec = EmptyScene();
    for (uint64_t i = 0, n = rng.UniformInt(4); i < n; ++i) spec.robots.push_back(Robot(rng, i));
    for (uint64_t i = 0, n = rng.UniformInt(6); i < n; ++i)
      spec.objects.push_back(Object(rng, "thing" + std::to_string(i)));
    return spec;
  }

  // Returns a scene with 0 to 3 robots with 0 to 5 tools each, 0 to 10 objects, a rig and cameras.
  // Robots stand at any angle two metres above the floor, on any support; half of the objects are
  // within reach.
  SceneSpec NextCell(Rng& rng) {
    SceneSpec spec = EmptyScene();
    spec.root_frame_to_world = RandomPose(rng);
    spec.shared_base_frame_to_root_frame = RandomPose(rng);
    const uint64_t objects = rng.UniformInt(11);
    if (objects > 0 && rng.UniformInt(3) > 0) {
      spec.objects.push_back({.name = "stand", .mjcf_path = stand_, .fixed = true});
      PutAt(spec.objects.back(), RandomPose(rng));
    }
    for (uint64_t i = 0, n = rng.UniformInt(4); i < n; ++i) {
      spec.robots.push_back(menagerie_.empty() || rng.UniformInt(4) == 0 ? Robot(rng, i)
                                                                         : FromMenagerie(i));
      RobotSpec& robot = spec.robots.back();
      robot.reset_root_pose = rng.UniformInt(2) == 0;
      robot.attachments = {};
      const Eigen::Vector3d place(0, 3.0 * static_cast<double>(i), 2);
      Stand(rng, spec, Pose(place, RandomQuaternion(rng)), false, robot);
      for (uint64_t k = 0, tools = rng.UniformInt(6); k < tools; ++k) Equip(rng, k, robot);
    }
    while (spec.objects.size() < objects) {
      SceneObject object = Object(rng, "thing" + std::to_string(spec.objects.size()));
      Pose place = object.pose();
      if (rng.UniformInt(2) == 0) {
        const double robot = 3.0 * static_cast<double>(rng.UniformInt(3));
        place = Pose(Eigen::Vector3d(rng.Uniform(0.3, 0.8), robot + rng.Uniform(-0.5, 0.5),
                                     rng.Uniform(1.5, 2.5)),
                     RandomQuaternion(rng));
      }
      Stand(rng, spec, place, object.fixed != true, object);
      spec.objects.push_back(object);
    }
    for (uint64_t i = 0, n = rng.UniformInt(3); i < n; ++i) {
      spec.cameras.push_back({.name = "camera" + std::to_string(i),
                              .pos = ToVec3(RandomVector(rng, 3)),
                              .fovy = rng.Uniform(20, 90),
                              .attach_to = rng.UniformInt(2) == 0 ? Root() : World()});
    }
    return spec;
  }

  // Returns the pose of the element that a robot or an object of a cell is attached to.
  Pose Parent(const SceneSpec& spec, const AttachTarget& target) {
    const Pose& root = spec.root_frame_to_world;
    if (target.kind == AttachKind::kRoot) return root;
    if (target.kind == AttachKind::kSharedBase) return root * spec.shared_base_frame_to_root_frame;
    if (target.kind == AttachKind::kWorld) return {};
    const SceneObject& stand = spec.objects[0];
    const Pose board = stand.pose() * RootPose(stand_);
    return board * Inside(target.name.substr(stand.name.size() + 1));
  }

  // Returns the pose of a tool that is attached to an element of a robot.
  Pose Parent(const Scene& scene, const RobotSpec& robot, const AttachTarget& target) {
    const std::string name = robot.prefix + target.name;
    if (target.kind == AttachKind::kBody) return scene.body_pose(name);
    if (target.kind == AttachKind::kSite) return scene.site_pose(name);
    const std::string rod = name.substr(0, name.size() - 3) + "rod";
    return scene.body_pose(rod) * Inside("rim");
  }

  // Returns the model as the engine loads it alone.
  static const mjModel* Alone(const std::string& file) {
    static std::map<std::string, ModelPtr> models;  // meshes take time
    ModelPtr& model = models[file];
    if (!model) model.reset(mj_loadXML(file.c_str(), nullptr, nullptr, 0));
    return model.get();
  }
  // Returns the authored pose of a model's first body.
  static Pose RootPose(const std::string& file) {
    return Pose::FromWxyz(Alone(file)->body_pos + 3, Alone(file)->body_quat + 4);
  }
  static std::string FileOf(const RobotSpec& robot) {
    return robot.config ? assets::Resolve(robot.config->model, robot.config->source_dir)
                        : robot.path;
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

  RobotSpec FromMenagerie(uint64_t i) {
    return {.path = menagerie_[turn_++ % menagerie_.size()],
            .prefix = "r" + std::to_string(i) + "_",
            .pos = {0, 2.0 * i, 0}};
  }

  template <class Entity>
  static void PutAt(Entity& entity, const Pose& pose) {
    entity.pos = ToVec3(pose.translation());
    entity.quat = pose.quaternion();
  }

  // Places an entity at `world`, attached to any allowed target.
  template <class Entity>
  void Stand(Rng& rng, const SceneSpec& spec, const Pose& world, bool moves, Entity& entity) {
    std::vector<AttachTarget> parents = {World(), Root(), SharedBase()};
    if (!moves && !spec.objects.empty() && spec.objects[0].name == "stand") {
      parents.push_back(Site("stand_top"));
      parents.push_back(Frame("stand_edge"));
    }
    entity.attach_to = rng.Choice(parents);
    PutAt(entity, Parent(spec, entity.attach_to).inverse() * world);
  }

  // Poses in the bodies of kStand and kProbe.
  static Pose Inside(const std::string& name) {
    const auto at = [](const Vec3& pos, const Vec3& euler) {
      constexpr double kDegree = std::numbers::pi / 180;
      const auto turn = [&](int axis) {
        return Eigen::AngleAxisd(euler[axis] * kDegree, Eigen::Vector3d::Unit(axis));
      };
      // MJCF's default: rotations about the turned axes.
      return Pose(ToEigen(pos), (turn(0) * turn(1) * turn(2)).toRotationMatrix());
    };
    if (name == "top") return at({0.1, 0.2, 0.3}, {10, 20, 30});
    if (name == "edge") return at({0, 0.3, 0.1}, {0, 0, 40});
    return at({0.02, 0, 0.01}, {0, 30, 0});
  }

  // Mounts one more tool on the robot or on one of its tools: on bodies, sites and frames.
  void Equip(Rng& rng, uint64_t k, RobotSpec& robot) {
    AttachTarget on;
    if (k > 0 && rng.UniformInt(3) > 0) {
      const AttachmentSpec& other = robot.attachments[rng.UniformInt(k)];
      const auto kind = std::find_if(tools_.begin(), tools_.end(), [&](const Tool& tool) {
        return tool.mjcf_path == other.mjcf_path;
      });
      on = rng.Choice(kind->places);
      on.name = other.prefix + on.name;
    } else {
      const mjModel* model = Alone(FileOf(robot));
      const std::vector<std::string> sites = Named(model, mjOBJ_SITE);
      on = !sites.empty() && rng.UniformInt(2) == 0 ? Site(rng.Choice(sites))
                                                    : Body(rng.Choice(Named(model, mjOBJ_BODY)));
    }
    AttachmentSpec tool{.mjcf_path = rng.Choice(tools_).mjcf_path,
                        .attach_to = on,
                        .prefix = "t" + std::to_string(k) + "_"};
    PutAt(tool, Pose(RandomVector(rng, 0.1), RandomQuaternion(rng)));
    robot.attachments.push_back(tool);
  }

  static std::vector<std::string> Named(const mjModel* model, mjtObj kind) {
    std::vector<std::string> names = ElementNames(model, kind);
    std::erase(names, "world");
    std::erase(names, "");
    return names;
  }

  // A tool that a robot can carry, and the places on it for others.
  struct Tool {
    std::string mjcf_path;
    std::vector<AttachTarget> places;
  };

  uint64_t turn_;
  ModelFolder folder_;
  RobotConfig arm_;
  std::string gripper_, lid_box_, stand_;
  std::vector<Tool> tools_;
  std::vector<std::string> menagerie_;
};

}  // namespace robocell
