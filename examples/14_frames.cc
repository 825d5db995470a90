// Example 14: a cell, frame by frame, in the best order to describe a new one. One robot in the
// origin; then the support of its rig, objects fixed in the room, parts on its wrist, and cameras;
// last the offsets that turn it into a rig of two arms, which then acts. Poses are checked after
// each step, and a picture is drawn with the frames. The same in Python: 14_frames.py.
//
//   build/release/example_14_frames [folder for the pictures]
#include <robocell/robocell.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace fs = std::filesystem;
namespace rc = robocell;

namespace {

constexpr int kWide = 320, kHigh = 240;

rc::Pose At(double x, double y, double z) { return rc::Pose(Eigen::Vector3d(x, y, z)); }

// On the bracket, towards the tool.
rc::Pose Beside() { return rc::Pose::FromRpy({.085, 0, .014}, {0, -.26, 0}); }

rc::RobotConfig Rc7() { return rc::RobotConfig::Load(rc::assets::BuiltinRobotFile("rc7")); }

// Throws if something is not at its place.
void Check(const rc::Pose& found, const rc::Pose& expected) {
  if (!found.is_close(expected, 1e-9, 1e-9)) throw rc::Error("it stands somewhere else");
}

rc::RgbImage Draw(const rc::Scene& scene, const rc::EnvConfig& config) {
  std::vector<rc::Marker> markers;
  const auto add = [&](const rc::Pose& frame) { rc::AddFrame(markers, frame, .2); };
  add(rc::Pose());
  add(scene.root_frame_to_world());
  add(scene.shared_base_frame_to_world());
  for (const std::string& robot : config.robots.keys())
    add(scene.site_pose("robot" + robot + "_attachment_site"));
  const auto renderer = rc::MakeRenderer({.quality = {.shadows = true, .multisamples = 4}});
  renderer->SetModel(scene.model());
  const rc::OrbitCamera view{
      .lookat = {.05, -.2, 0}, .distance = 2.6, .azimuth = 150, .elevation = -22};
  rc::RgbImage image{kWide, kHigh, std::vector<uint8_t>(3 * kWide * kHigh)};
  renderer->Render(scene.data(),
                   {.camera = view, .width = kWide, .height = kHigh, .markers = markers},
                   {.rgb = image.pixels});
  return image;
}

// Builds the scene after each step and draws it.
struct Steps {
  rc::EnvConfig config;
  fs::path folder;
  std::vector<rc::RgbImage> pictures = {};

  rc::Scene Next(const char* title) {
    rc::Scene scene = rc::Scene::Build(rc::EnvSceneSpec(config));
    scene.Reset();
    pictures.push_back(Draw(scene, config));
    const std::string number = std::to_string(pictures.size());
    rc::WritePng(folder / ("step_" + number + ".png"), pictures.back());
    std::printf("%s. %s\n", number.c_str(), title);
    return scene;
  }
};

// Checks the product of the three transforms, and the parts that move with the root frame.
void RequireRig(const rc::Scene& scene, const rc::EnvConfig& config) {
  const rc::Pose& root = config.root_frame_to_world;
  const rc::Pose shared = root * config.shared_base_frame_to_root_frame;
  for (const std::string& robot : config.robots.keys())
    Check(rc::Robot::Of(scene, robot).base_in_world(),
          shared * *config.robot_to_shared_base_frame.find(robot));
  Check(scene.body_pose("table_table"), root * At(.35, 0, 0));
  Check(scene.camera_pose("bird_eye"), root * At(.4, 0, 1.6));
  Check(scene.body_pose("cabinet_cabinet"), At(-.4, -.8, -.7));
  Check(scene.body_pose("wrist_d405"), scene.site_pose("robotleft_attachment_site") * Beside());
}

void Describe(Steps& steps) {
  rc::EnvConfig& config = steps.config;
  rc::Scene scene = steps.Next("one robot, nothing else: all frames are the world's");
  Check(scene.body_pose("robotleft_base_link"), rc::Pose());

  config.root_frame_objects["table"] = {.mjcf_path = "table", .offset = At(.35, 0, 0)};
  scene = steps.Next("what moves with the rig: a table");
  Check(scene.body_pose("table_table"), At(.35, 0, 0));

  config.world_frame_objects["cabinet"] = {.mjcf_path = "cabinet", .offset = At(-.4, -.8, -.7)};
  scene = steps.Next("what stays in the room: a cabinet");
  Check(scene.body_pose("cabinet_cabinet"), At(-.4, -.8, -.7));

  config.robot_frame_objects["left"]["bracket"] = {.mjcf_path = "robotiq_d405_mount"};
  scene = steps.Next("what the wrist carries: a bracket");
  const rc::Pose wrist = scene.site_pose("robotleft_attachment_site");
  Check(scene.body_pose("bracket_robotiq_d405_mount"), wrist);

  config.camera_adds["bird_eye"] = {.fovy = 60, .offset = At(.4, 0, 1.6)};
  config.camera_adds["wrist"] = {.xml_path = "d405", .offset = Beside(), .robot_name = "left"};
  config.cameras.resolution = {64, 48};
  for (const char* camera : {"bird_eye", "wrist"})
    config.cameras.streams.push_back({.name = camera, .camera = camera});
  scene = steps.Next("cameras: one above, one in its housing on the bracket");
  Check(scene.camera_pose("bird_eye"), At(.4, 0, 1.6));
  Check(scene.body_pose("wrist_d405"), wrist * Beside());

  config.robots["right"] = Rc7();
  config.root_frame_objects["mount"] = {.mjcf_path = "fr3_duo_mount"};
  config.robot_to_shared_base_frame["left"] = rc::Pose::FromRpy({0, .05, 0}, {-.8, .2, 0});
  config.robot_to_shared_base_frame["right"] = rc::Pose::FromRpy({0, -.05, 0}, {.8, .2, 0});
  config.shared_base_frame_to_root_frame = At(0, 0, .342);
  config.root_frame_to_world = rc::Pose::FromRpy({-.1, .1, .1}, {0, 0, .4});
  RequireRig(steps.Next("the offsets: two arms on a mount, and the rig put elsewhere"), config);
}

// Moves both arms along one axis of the frame that they share.
void Act(const rc::EnvConfig& config) {
  rc::Env env(config);
  env.Reset({.seed = 0});
  const std::vector<double> before(env.observation().begin(), env.observation().end());
  const rc::Pose shared = env.scene().shared_base_frame_to_world();
  std::vector<double> action(env.layout().action.size());
  for (const rc::RobotLayout& robot : env.layout().robots) {
    const double* seen = &before[robot.tquat.begin];
    Check(shared * rc::Pose({seen[0], seen[1], seen[2]},
                            rc::Quaternion{seen[3], seen[4], seen[5], seen[6]}),
          rc::Robot::Of(env.scene(), robot.robot).tcp_in_world());
    action[robot.action.begin + 2] = .04;
    action[robot.action.begin + 6] = 1;  // no rotation
    action[robot.gripper_action] = 1;
  }
  const rc::EnvStep step = env.Step(action);
  std::printf("both arms up, in the shared base frame: %s\n", ToString(step.reason));
  for (const rc::RobotLayout& robot : env.layout().robots) {
    const double* now = &env.observation()[robot.tquat.begin];
    const double* then = &before[robot.tquat.begin];
    if (std::hypot(now[0] - then[0], now[1] - then[1], now[2] - then[2] - .04) > 6e-3)
      throw rc::Error("it went somewhere else");
    std::printf("  %s: %.2f m\n", robot.robot.c_str(), now[2] - then[2]);
  }
  if (env.frames().size() != 2) throw rc::Error("two images were asked for");
}

// Arranges the pictures in two rows of three.
rc::RgbImage Sheet(const std::vector<rc::RgbImage>& pictures) {
  constexpr int kColumns = 3, kRow = 3 * kWide;  // bytes
  rc::RgbImage sheet{kColumns * kWide, 2 * kHigh, {}};
  sheet.pixels.resize(3 * sheet.width * sheet.height);
  for (size_t i = 0; i < pictures.size(); ++i) {
    const size_t left = i % kColumns, top = i / kColumns * kHigh;
    for (size_t y = 0; y < kHigh; ++y) {
      std::copy_n(&pictures[i].pixels[y * kRow], kRow,
                  &sheet.pixels[((top + y) * kColumns + left) * kRow]);
    }
  }
  return sheet;
}

}  // namespace

int main(int argc, char** argv) try {
  const fs::path folder = argc > 1 ? argv[1] : fs::temp_directory_path() / "robocell_example_14";
  fs::create_directories(folder);
  Steps steps{.config = {.name = "cell"}, .folder = folder};
  steps.config.robots["left"] = Rc7();
  Describe(steps);
  steps.config.control_mode = rc::ControlMode::kCartesianTquat;
  Act(steps.config);
  rc::WritePng(folder / "picture.png", Sheet(steps.pictures));
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 1;
}
