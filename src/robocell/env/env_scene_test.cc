#include "robocell/env/env_scene.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <span>
#include <string>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/rng.h"
#include "robocell/env/env.h"
#include "robocell/env/testing/envs.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/task/task_kind.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/random_values.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::StartsWith;

constexpr double kExact = 1e-9;

#define EXPECT_POSE(actual, expected)                                                      \
  EXPECT_TRUE((actual).is_close((expected), kExact, kExact)) << (actual) << "\nexpected\n" \
                                                             << (expected)

Pose At(double x, double y, double z) { return Pose(Eigen::Vector3d(x, y, z)); }

Scene BuildEnvScene(const EnvConfig& config) { return Scene::Build(EnvSceneSpec(config)); }

TEST(EnvScene, ASingleRobotWithoutOffsetsIsAtTheWorldOrigin) {
  TwoArmFolder folder;
  EnvConfig config;
  config.robots["robot"] = folder.arm();
  const Scene scene = BuildEnvScene(config);
  EXPECT_EQ(scene.root_frame_to_world(), Pose());
  EXPECT_EQ(scene.shared_base_frame_to_world(), Pose());
  EXPECT_POSE(scene.body_pose("robotrobot_base"), Pose());
  EXPECT_POSE(Robot::Of(scene, "robot").base_in_world(), Pose());
}

int Skies(const mjModel* model) {
  const auto types = std::span(model->tex_type, static_cast<size_t>(model->ntex));
  return static_cast<int>(std::ranges::count(types, mjTEXTURE_SKYBOX));
}

TEST(EnvScene, BuiltInScenesHaveASkyAndTheirOwnLights) {
  TwoArmFolder folder;
  EnvConfig config;
  config.robots["robot"] = folder.arm();
  for (const std::string& name : assets::BuiltinScenes()) {
    config.scene = name;
    const Scene scene = BuildEnvScene(config);
    EXPECT_EQ(Skies(scene.model()), 1) << name;
    EXPECT_EQ(scene.model()->nlight, 2) << name;
  }
}

TEST(EnvScene, ASceneFileKeepsItsLook) {
  TwoArmFolder folder;
  const TempDir files;
  AtomicWrite(files / "dark.xml", "<mujoco><worldbody><body name='a'/></worldbody></mujoco>");
  EnvConfig config;
  config.robots["robot"] = folder.arm();
  config.scene = (files / "dark.xml").string();
  const Scene scene = BuildEnvScene(config);
  EXPECT_EQ(Skies(scene.model()), 0);
  EXPECT_EQ(scene.model()->nlight, 0);
}

TEST(EnvScene, RobotPosesAreTheProductOfThreeTransforms) {
  TwoArmFolder folder;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    Rng rng = Rng::Stream(seed, "env rig");
    const EnvConfig config = folder.RandomDuo(rng);
    const Scene scene = BuildEnvScene(config);
    for (const char* robot : {"left", "right"}) {
      EXPECT_POSE(Robot::Of(scene, robot).base_in_world(),
                  config.root_frame_to_world * config.shared_base_frame_to_root_frame *
                      *config.robot_to_shared_base_frame.find(robot));
    }
  }
}

// The whole cell: two arms with grippers, an object in each frame, a camera in each.
EnvConfig WholeCell(const TwoArmFolder& folder) {
  EnvConfig config = folder.Duo();
  config.gripper_offsets["left"] = Pose::FromRpy({0.01, 0.02, 0.03}, {0.4, 0, 0.2});
  config.world_frame_objects["lamp"] = {.mjcf_path = folder.box(), .offset = At(1, 0, 2)};
  config.root_frame_objects["mount"] = {.mjcf_path = folder.box(), .offset = At(0, 0, 0.2)};
  config.robot_frame_objects["left"]["bracket"] = {.mjcf_path = folder.box(),
                                                   .offset = At(0, 0.1, 0)};
  config.camera_adds["bird_eye"] = {.offset = Pose::FromRpy({0.3, 0, 2}, {0, 0.1, 0})};
  config.camera_adds["wrist"] = {.offset = At(0.05, 0, 0), .robot_name = "left"};
  for (const std::string& camera : config.camera_adds.keys())
    config.cameras.streams.push_back({.name = camera, .camera = camera});
  return config;
}

TEST(EnvScene, ObjectsArePlacedInTheFrameOfTheirDictionary) {
  TwoArmFolder folder;
  EnvConfig config = WholeCell(folder);
  config.root_frame_to_world = Pose::FromRpy({1, 2, 3}, {0.3, 0.2, 0.1});
  const Scene scene = BuildEnvScene(config);
  const Pose wrist = scene.site_pose("robotleft_flange"), root = config.root_frame_to_world;
  EXPECT_POSE(scene.body_pose("lamp_box"), At(1, 0, 2));
  EXPECT_POSE(scene.body_pose("mount_box"), root * At(0, 0, 0.2));
  EXPECT_POSE(scene.body_pose("bracket_box"), wrist * At(0, 0.1, 0));
  EXPECT_POSE(scene.body_pose("gripperleft_palm"), wrist * *config.gripper_offsets.find("left"));
  EXPECT_POSE(scene.body_pose("gripperright_palm"), scene.site_pose("robotright_flange"));
  EXPECT_POSE(scene.camera_pose("bird_eye"), root * Pose::FromRpy({0.3, 0, 2}, {0, 0.1, 0}));
  EXPECT_POSE(scene.camera_pose("wrist"), wrist * At(0.05, 0, 0));
}

TEST(EnvScene, MovingTheRootMovesOnlyTheRig) {
  TwoArmFolder folder;
  EnvConfig config = WholeCell(folder);
  const Scene before = BuildEnvScene(config);
  const Pose move = Pose::FromRpy({0.4, -0.3, 0.2}, {0.5, -0.4, 2});
  config.root_frame_to_world = move * config.root_frame_to_world;
  const Scene after = BuildEnvScene(config);
  ASSERT_EQ(after.body_names(), before.body_names());
  for (const std::string& body : before.body_names()) {
    const bool of_room = body == "world" || body == "lamp_box";
    EXPECT_POSE(after.body_pose(body), (of_room ? Pose() : move) * before.body_pose(body)) << body;
  }
  for (const std::string& camera : before.camera_names())
    EXPECT_POSE(after.camera_pose(camera), move * before.camera_pose(camera));
}

TEST(EnvScene, WristObjectsFollowOnlyTheirWrist) {
  TwoArmFolder folder;
  const Scene scene = BuildEnvScene(WholeCell(folder));
  const Pose carried =
      scene.site_pose("robotleft_flange").inverse() * scene.body_pose("bracket_box");
  const Pose other = scene.body_pose("gripperright_palm"), mount = scene.body_pose("mount_box");
  const Pose above = scene.camera_pose("bird_eye");
  Robot::Of(scene, "left").SetJointPos(std::vector<double>{0.7, -1.1});
  const Pose wrist = scene.site_pose("robotleft_flange");
  EXPECT_POSE(scene.body_pose("bracket_box"), wrist * carried);
  EXPECT_POSE(scene.camera_pose("wrist"), wrist * At(0.05, 0, 0));
  EXPECT_POSE(scene.camera_pose("bird_eye"), above);
  EXPECT_POSE(scene.body_pose("gripperright_palm"), other);
  EXPECT_POSE(scene.body_pose("mount_box"), mount);
}

TEST(EnvScene, GrippersAreSeparateRobots) {
  TwoArmFolder folder;
  const Scene scene = BuildEnvScene(folder.Duo());
  EXPECT_TRUE(Robot::Of(scene, "gripperleft").has_gripper());
  EXPECT_FALSE(Robot::Of(scene, "left").has_gripper());
  EXPECT_TRUE(scene.has_actuator("gripperleft_grip"));
  EXPECT_EQ(MountedGripperName("left"), "gripperleft");
}

TEST(EnvScene, GravityCompensationIsForRobotsAndGrippers) {
  TwoArmFolder folder;
  EnvConfig config = WholeCell(folder);
  for (const bool add : {false, true}) {
    config.add_gravcomp = add;
    const Scene scene = BuildEnvScene(config);
    for (const std::string& body : scene.body_names()) {
      const bool of_robot = body.starts_with("robot") || body.starts_with("gripper");
      EXPECT_EQ(scene.model()->body_gravcomp[FindId(scene.model(), mjOBJ_BODY, body)],
                add && of_robot ? 1 : 0)
          << body;
    }
  }
}

TEST(EnvScene, CamerasHaveTheirLens) {
  TwoArmFolder folder;
  EnvConfig config = WholeCell(folder);
  config.camera_adds["wrist"].fovy = 42;
  const Scene scene = BuildEnvScene(config);
  const auto fovy = [&](const char* camera) {
    return scene.model()->cam_fovy[FindId(scene.model(), mjOBJ_CAMERA, camera)];
  };
  EXPECT_EQ(fovy("wrist"), 42);
  EXPECT_EQ(fovy("bird_eye"), 60);
}

TEST(EnvScene, ACameraStaysInItsHousingAtAnotherSite) {
  TwoArmFolder folder;
  EnvConfig config = WholeCell(folder);
  config.camera_adds["wrist"] = {.xml_path = folder.housing(),
                                 .offset = At(0, 0, 0.1),
                                 .robot_name = "right",
                                 .attachment_site = "flange"};
  const Scene scene = BuildEnvScene(config);
  const Pose shell = scene.site_pose("robotright_flange") * At(0, 0, 0.1);
  EXPECT_POSE(scene.body_pose("wrist_shell"), shell);
  EXPECT_POSE(scene.camera_pose("wrist"), shell * At(0, 0, 0.02));
  EXPECT_THAT(scene.camera_names(), ::testing::UnorderedElementsAre("bird_eye", "wrist"));
}

// Two arms on one torso, in a model whose names begin with `prefix` and the robot's name.
std::string ArmsOnATorso(const std::string& prefix) {
  std::string bodies, actuators;
  for (const char* side : {"left", "right"}) {
    const std::string name = prefix + side + "_", y = side == std::string("left") ? "0.3" : "-0.3";
    bodies += fmt::format(R"(<body name="{0}base" pos="0 {1} 0.2">
        <geom size="0.05 0.05" type="cylinder"/>
        <body name="{0}upper" pos="0 0 0.1">
          <joint name="{0}shoulder"/><geom size="0.02" fromto="0 0 0 0 0 0.3"/>
          <body name="{0}fore" pos="0 0 0.3">
            <joint name="{0}elbow"/><geom size="0.02" fromto="0 0 0 0 0 0.2"/>
            <site name="{0}flange" pos="0 0 0.2"/>
          </body></body></body>)",
                          name, y);
    actuators += fmt::format(R"(<position name="{0}servo1" joint="{0}shoulder" kp="100" kv="10"/>
        <position name="{0}servo2" joint="{0}elbow" kp="50" kv="5"/>)",
                             name);
  }
  return R"(<compiler angle="radian" autolimits="true"/>
    <default><joint axis="0 1 0" range="-2 2"/>
      <geom type="capsule" contype="0" conaffinity="0"/></default>
    <worldbody><body name="torso" pos="9 9 9"><geom size="0.1" type="sphere"/>)" +
         bodies + "</body></worldbody><actuator>" + actuators + "</actuator>";
}

EnvConfig Combined(const TwoArmFolder& folder, const std::string& model) {
  EnvConfig config = folder.Duo();
  config.robot_to_shared_base_frame = {};
  config.root_frame_to_world = Pose::FromRpy({1, 2, 3}, {0.3, 0.2, 0.1});
  config.alternative_combined_robot_mjcf = model;
  return config;
}

TEST(EnvScene, RobotsOfACombinedModelKeepItsPoses) {
  TwoArmFolder folder;
  ModelFolder models;
  EnvConfig config = Combined(folder, models.Write("duo", ArmsOnATorso("robot")));
  config.robots["left"].tcp_offset = At(0, 0, 0.1);
  config.robots["left"].move_groups["arm"].leaf.reset();
  config.robot_frame_objects["right"]["bracket"] = {.mjcf_path = folder.box()};
  const Scene scene = BuildEnvScene(config);
  const Pose root = config.root_frame_to_world;
  EXPECT_POSE(scene.body_pose("torso"), root);
  EXPECT_POSE(Robot::Of(scene, "left").base_in_world(), root * At(0, 0.3, 0.2));
  EXPECT_POSE(Robot::Of(scene, "right").base_in_world(), root * At(0, -0.3, 0.2));
  const Pose left = scene.site_pose("robotleft_flange"),
             right = scene.site_pose("robotright_flange");
  EXPECT_POSE(Robot::Of(scene, "left").tcp_in_world(), left * At(0, 0, 0.1));
  EXPECT_POSE(scene.body_pose("gripperright_palm"), right);
  EXPECT_POSE(scene.body_pose("bracket_box"), right);
  Robot::Of(scene, "right").SetJointPos(std::vector<double>{0.7, -1.1});
  EXPECT_POSE(scene.site_pose("robotleft_flange"), left);
  EXPECT_FALSE(scene.site_pose("robotright_flange").is_close(right, 0.1, 0.1));
}

TEST(EnvScene, NamesInACombinedModelStartWithTheRobots) {
  TwoArmFolder folder;
  ModelFolder models;
  const std::string file = models.Write("duo", ArmsOnATorso("arm_"));
  ExpectThrow<SpecError>([&] { BuildEnvScene(Combined(folder, file)); },
                         "robot 'left': in " + file +
                             " the names of robot 'left' must begin with 'robotleft_'; its bodies "
                             "are torso, arm_left_base");
}

TEST(EnvScene, ReportsACombinedModelThatCannotBeParsed) {
  TwoArmFolder folder;
  ModelFolder models;
  const std::string file = models.Write("duo", "<worldbody><body");
  ExpectThrow<SpecError>([&] { BuildEnvScene(Combined(folder, file)); }, "robot 'left': " + file);
}

TEST(EnvScene, AnErrorOfOneRobotDoesNotAffectTheOthers) {
  TwoArmFolder folder;
  ModelFolder models;
  std::string duo = ArmsOnATorso("robot");
  const std::string place = R"(robotright_flange" pos="0 0 0.2")";
  duo.replace(duo.find(place), place.size(),
              R"(robotright_flange" type="capsule" size="0.01" fromto="0 0 0 0 0 0.2")");
  EnvConfig config = Combined(folder, models.Write("duo", duo));
  config.robots["right"].tcp_offset = At(0, 0, 0.1);
  config.robots["right"].move_groups["arm"].leaf.reset();
  config.robots["third"] = folder.arm();
  const auto build = [&] { BuildEnvScene(config); };
  ExpectThrow<SpecError>(build, "robot 'right': site 'robotright_flange' is written with fromto");
  ExpectThrow<SpecError>(build, "robot 'third': in ");
  ExpectThrow<SpecError>(build,
                         "the names of robot 'third' must begin with 'robotthird_'; its "
                         "bodies are torso, robotleft_base");
}

TEST(EnvScene, RejectsAnInvalidConfigurationAndNamesTheEnvironment) {
  ExpectThrow<SpecError>([] { EnvSceneSpec({.name = "duo"}); },
                         "environment 'duo' is not valid: robots: an environment needs a robot");
}

TEST(EnvScene, ProblemsNameTheLineOfTheField) {
  const TempDir folder;
  const std::string file = folder / "env.yaml";
  const auto problem = [&](const std::string& fields) -> std::string {
    AtomicWrite(file, fmt::format("robots: {{left: {}/models/robots/rc7/rc7.yaml}}\n{}",
                                  SourceDir(), fields));
    try {
      Env(EnvConfig::Load(file));
    } catch (const NotFoundError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(problem(""), "");
  EXPECT_THAT(problem("scene: none.xml\n"),
              StartsWith(file + ":2:8: base: model file 'none.xml' not found."));
  EXPECT_THAT(problem("world_frame_objects:\n  cube: {mjcf_path: none.xml}\n"),
              StartsWith(file + ":3:21: object 'cube': model file 'none.xml' not found."));
  EXPECT_THAT(problem("root_frame_objects: {a: {shape: sphere, size: [0.1, 0, 0], mass: 1}}\n"
                      "robot_frame_objects:\n  left: {b: {mjcf_path: none.xml}}\n"),
              StartsWith(file + ":4:25: object 'b': model file 'none.xml' not found."));
  EXPECT_THAT(problem("camera_adds: {top: {xml_path: none.xml}}\n"),
              StartsWith(file + ":2:31: camera 'top': "));
  EXPECT_THAT(problem("features: [time, tim]\n"), StartsWith(file + ":2:11: no feature 'tim'."));
  EXPECT_THAT(problem("cameras: {streams: [{name: a, camera: none}]}\n"),
              StartsWith(file + ":2:20: stream 'a': no camera 'none'."));
}

TEST(EnvScene, ALooseObjectIsNotCarriedByARobot) {
  TwoArmFolder folder;
  EnvConfig config = folder.Duo();
  config.robot_frame_objects["left"]["tool"] = {.mjcf_path = folder.box(), .fixed = false};
  ExpectThrow<SpecError>([&] { BuildEnvScene(config); },
                         "object 'tool': can move freely, so it cannot be attached to the "
                         "attachment site of robot 'left'; attach it to the world, or set fixed: "
                         "true");
}

// A task that adds a model, which its field names.
struct OfAModelConfig {
  std::string model = "nowhere.xml";
  bool is_known = false;  // where prepare is written

  static constexpr const char* kKind = "of_a_model";
  static constexpr const char* kTypeName = "OfAModelConfig";
  template <class V>
  static void Fields(V&& v) {
    v("model", &OfAModelConfig::model, "Model of the object.");
    v("is_known", &OfAModelConfig::is_known, "Whether the code has a place.");
  }
};

class OfAModel : public Task {
 public:
  explicit OfAModel(const OfAModelConfig& fields) : fields_(fields) {}
  void Prepare(SceneSpec& spec, Rng& /*rng*/) override {
    spec.objects.push_back({.name = "cup", .mjcf_path = fields_.model});
  }
  TaskVerdict Judge(const Scene& /*scene*/) override { return {}; }
  std::string instruction() const override { return "drink"; }
  std::string PlaceOfHook(const char* method) const override {
    return fields_.is_known ? "mine.cc:7, in " + std::string(method) : "";
  }

 private:
  OfAModelConfig fields_;
};

TEST(EnvScene, AModelThatATaskAddsIsNamedWithItsLine) {
  RegisterTask<OfAModelConfig>(std::make_shared<TaskKindOf<OfAModelConfig, OfAModel>>());
  EnvConfig config = Rc7Env();
  config.root_frame_objects["box"] = {.offset = At(0.4, 0, 0.1),
                                      .shape = Shape::kBox,
                                      .size = Vec3{0.02, 0.02, 0.02},
                                      .mass = 0.05};
  config.task = OfAModelConfig{.is_known = true};
  ExpectThrow<NotFoundError>(
      [&] { CompileEnvScene(config); },
      "mine.cc:7, in prepare: object 'cup': model file 'nowhere.xml' not found");
  const TempDir folder;
  const std::string file = folder.path() / "cell.yaml";
  AtomicWrite(
      file, "robots: {robot: " + assets::BuiltinRobotFile("rc7") + "}\ntask: {kind: of_a_model}\n");
  ExpectThrow<NotFoundError>([&] { CompileEnvScene(EnvConfig::Load(file)); },
                             "cell.yaml:2:7: object 'cup': model file");
}

}  // namespace
}  // namespace robocell
