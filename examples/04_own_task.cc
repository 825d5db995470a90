// Example 4: a custom task, pushing a cube, and a dataset of it. Three small classes: a sampler
// makes the start, a task judges, an expert acts. The runner does the rest, like for picking. The
// same in Python: 04_own_task.py.
//
//   build/release/example_04_own_task [folder]
#include <robocell/robocell.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace fs = std::filesystem;
namespace rc = robocell;

namespace {

constexpr double kFar = .1;              // m, the distance to push the cube
const rc::Quaternion kDown{1, 0, 0, 0};  // xyzw: the gripper points down

// Success: the cube stands kFar further along x than at the start.
class Push : public rc::Task {
 public:
  void Begin(const rc::Scene& scene) override { start_ = Cube(scene); }
  rc::TaskVerdict Judge(const rc::Scene& scene) override {
    const Eigen::Vector3d way = Cube(scene) - start_;
    return {.reward = way.x(), .success = way.x() >= kFar && std::abs(way.z()) < .005};
  }
  std::string instruction() const override { return "push the cube 10 cm away"; }
  std::vector<std::string> objects() const override { return {"cube"}; }

 private:
  static Eigen::Vector3d Cube(const rc::Scene& scene) {
    return scene.body_pose("cube").translation();
  }
  Eigen::Vector3d start_;
};

// The robot, and a cube somewhere in front of it; a cube that is too near is refused.
class CubeOnTheFloor : public rc::TaskSampler {
 public:
  explicit CubeOnTheFloor(const rc::RunConfig& run)
      : robot_{.name = run.robot.config.name, .config = run.robot.config} {}

  rc::SampleResult Sample(const rc::SampleRequest& /*request*/, rc::Rng& rng) override {
    const double x = rng.Uniform(.2, .5), y = rng.Uniform(-.2, .2);
    if (x < .35) {
      return {.start = {},
              .refusal = {rc::Refusal::kNoReachableBasePose, "no room behind the cube"}};
    }
    rc::SceneSpec spec{.name = "push", .timestep = 0.002, .add_floor = true, .add_skybox = true};
    spec.robots.push_back(robot_);
    spec.objects.push_back({.name = "cube",
                            .shape = rc::Shape::kBox,
                            .size = rc::Vec3{.02, .02, .02},
                            .rgba = rc::Vec4{.95, .5, .1, 1},
                            .mass = .1,
                            .friction = rc::Vec3{.6, .02, .001},
                            .pos = rc::Vec3{x, y, .02}});
    rc::Scene scene = rc::Scene::Build(spec);
    scene.Reset({.seed = rng.UniformInt(uint64_t{1} << 31)});
    return {.start = rc::EpisodeStart{.scene = scene,
                                      .task = std::make_shared<Push>(),
                                      .target_object = "cube",
                                      .object_kinds = {"box"}}};
  }

 private:
  rc::RobotSpec robot_;
};

// Moves the closed gripper over, behind and against the cube, 15 mm per action.
class Pusher : public rc::Expert {
 public:
  Pusher(const rc::RunConfig& run, const rc::EpisodeStart& /*start*/)
      : name_(run.robot.config.name) {}

  void Begin(const rc::Scene& scene, rc::Rng& /*rng*/) override {
    const rc::Robot robot = rc::Robot::Of(scene, name_);
    goal_ = robot.FkFrame();
    const rc::Pose cube = robot.base_in_world().inverse() * scene.body_pose("cube");
    path_.clear();
    for (const Eigen::Vector3d& from_cube :
         {Eigen::Vector3d(-.08, 0, .15), Eigen::Vector3d(-.08, 0, 0), Eigen::Vector3d(kFar, 0, 0)})
      path_.emplace_back(cube.translation() + from_cube, kDown);
    at_ = 0;
  }
  rc::Action Act(const rc::Scene& /*scene*/, rc::Rng& /*rng*/) override {
    const rc::Pose way = goal_.inverse() * path_[at_];
    goal_ = goal_ * way.limit_translation(.015).limit_rotation(.1);
    if (goal_.is_close(path_[at_], 1e-6, 1e-6)) ++at_;
    return {
        {name_,
         {{"arm", rc::GroupCommand::LeafPose(goal_)}, {"gripper", rc::GroupCommand::Opening(0)}}}};
  }
  bool done() const override { return at_ == path_.size(); }
  // It never gives up; the task judges whether the cube was pushed far enough.
  std::string failure() const override { return ""; }
  int phase() const override { return std::min(static_cast<int>(at_), 2); }
  std::vector<std::string> phase_names() const override { return {"over", "behind", "push"}; }

 private:
  std::string name_;
  rc::Pose goal_;
  std::vector<rc::Pose> path_;
  size_t at_ = 0;
};

// Five frames of a video side by side.
rc::RgbImage Strip(const rc::Episode& episode, const std::string& name) {
  const rc::CameraInfo& camera = episode.camera(name);
  rc::VideoReader video = episode.Video(name);
  std::vector<uint8_t> frame(video.frame_bytes());
  rc::RgbImage strip{5 * camera.width, camera.height, {}};
  strip.pixels.resize(5 * frame.size());
  const size_t line = 3 * static_cast<size_t>(camera.width);
  for (int i = 0; i < 5; ++i) {
    video.Read(i * (camera.frames - 1) / 4, frame);
    for (int y = 0; y < camera.height; ++y)
      std::copy_n(&frame[y * line], line, &strip.pixels[(5 * y + i) * line]);
  }
  return strip;
}

}  // namespace

int main(int argc, char** argv) try {
  const fs::path folder = argc > 1 ? argv[1] : fs::temp_directory_path() / "robocell_example_04";
  rc::RegisterSampler("push", std::make_shared<rc::SamplerKindOf<CubeOnTheFloor>>());
  rc::RegisterExpert("pusher", std::make_shared<rc::ExpertKindOf<Pusher>>());
  rc::RunConfig run{.run = "push"};
  run.sampler = "push";
  run.expert = "pusher";
  run.episodes_per_scene = 2;
  run.output = folder / "push";
  fs::remove_all(run.output);
  run.robot.config = rc::RobotConfig::Load(rc::assets::BuiltinRobotFile("rc7"));
  run.robot.config.cameras.push_back({.name = "side",
                                      .pos = rc::Vec3{.6, -.9, .3},
                                      .fovy = 40,
                                      .look_at = rc::Vec3{.45, 0, -.12},
                                      .attach_to = rc::Body("base_link")});
  run.cameras.resolution = {320, 240};
  run.cameras.streams = {{.name = "side", .camera = "side"}};
  rc::PrepareDataset(run);
  rc::Runner runner(run);
  for (const rc::PlanItem& item : rc::MakePlan(run)) {
    const rc::ItemResult result = runner.Run(item);
    int refused = 0;
    for (const auto& [reason, count] : result.refusals) refused += count;
    std::printf("%s: %d rows, starts refused: %d\n", item.id.c_str(), result.rows, refused);
  }

  for (const rc::Episode& episode : rc::Dataset(run.output)) {
    const std::vector<double> cube = episode.Read<double>("objects/cube/pose");
    std::printf("%s: pushed %.3f m\n", episode.id().c_str(), cube[cube.size() - 7] - cube[0]);
    if (!episode.success() || episode.Read<double>("reward").back() < kFar)
      throw rc::Error("this is no success");
  }
  rc::WritePng(folder / "picture.png", Strip(*rc::Dataset(run.output).begin(), "side"));
  return rc::Verify(run.output).good.size() == 2 ? 0 : 1;
} catch (const rc::Error& e) {
  std::fprintf(stderr, "error: %s\n", e.what());
  return 1;
}
