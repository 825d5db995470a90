#include "robocell/rollout/check_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "robocell/base/error.h"
#include "robocell/base/names.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/mujoco/names.h"
#include "robocell/render/stream_camera.h"
#include "robocell/robot/robot_trial.h"
#include "robocell/robot/unused_groups.h"
#include "robocell/rollout/check_reach.h"
#include "robocell/rollout/check_robot.h"
#include "robocell/rollout/check_streams.h"
#include "robocell/rollout/episode_cameras.h"
#include "robocell/rollout/plan.h"
#include "robocell/rollout/run_inputs.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/spec/problem_lines.h"
#include "robocell/spec/validate.h"
#include "robocell/task/grasp_candidates.h"
#include "robocell/task/pick_sampler.h"

namespace robocell {
namespace {

void CheckKinds(const RunConfig& run, Problems& problems) {
  const std::vector<std::string> known = ObjectKinds();
  Problems::Scope objects(problems, "task.objects");
  for (size_t i = 0; i < run.task.objects.size(); ++i) {
    const std::string& kind = run.task.objects.names[i];
    if (std::find(known.begin(), known.end(), kind) != known.end()) continue;
    Problems::Scope item(problems, i);
    problems.Add(NoSuchName("task", "kind", kind, known));
  }
}

// Problems of the fields alone.
Problems FieldProblems(const RunConfig& run) {
  Problems problems(run.locations);
  ValidateFields(run, problems);
  CheckStreams(run, problems);
  CheckKinds(run, problems);
  return problems;
}

std::string Title(const RunConfig& run) { return "run '" + run.run + "'"; }

// The checks that need a compiled scene: the first of the run, with its robot and one object of
// each kind.
class SceneCheck {
 public:
  SceneCheck(const RunConfig& run, const RunDemands& demands, Problems& problems)
      : run_(run), demands_(demands), problems_(problems) {}

  // Warnings of the scene.
  const std::vector<std::string>& warnings() const { return warnings_; }

  void Run() {
    PickTaskSampler sampler(run_);
    std::vector<SceneSpec> bases;
    for (const int scene : SceneIndices(run_)) {
      if (!Try("scenes", [&] { bases.push_back(sampler.MakeBaseScene(scene)); })) return;
    }
    if (!CheckSupports(bases)) return;
    std::optional<Scene> scene;
    if (!Try("robot", [&] { scene = Scene::Build(WithContents(bases.front())); })) return;
    warnings_ = scene->compiled()->warnings();
    CheckCameras(*scene);
    std::optional<Robot> robot;
    if (!Try("robot", [&] { robot = Robot::Of(*scene, run_.robot.config.name); })) return;
    // What cannot be measured is reported once.
    if (CheckRobotItself(*robot) && demands_.scripted_expert) CheckForExpert(*scene, *robot);
    if (demands_.scripted_expert) TellUnused(*robot);
    if (demands_.scripted_expert && problems_.empty()) Try("robot", [&] { TryAlone(); });
    if (demands_.on_this_machine && problems_.empty()) CheckStreamsHere(run_, *scene, problems_);
  }

 private:
  // Runs a check; what it throws becomes a problem of the field.
  template <class F>
  bool Try(const char* field, F&& check) {
    try {
      check();
      return true;
    } catch (const IoError&) {
      throw;  // of the disk, not of the spec
    } catch (const Error& error) {
      problems_.AddAt(field, error.what());
      return false;
    }
  }

  // Every scene has to have a place for objects, and one that stays; all that have none are told.
  bool CheckSupports(const std::vector<SceneSpec>& bases) {
    bool good = true;
    std::set<std::string> checked;
    for (const SceneSpec& base : bases) {
      if (!checked.insert(base.base.value_or("")).second) continue;
      good &= Try("scenes", [&] { RequireSteady(base, FindSupport(base)); });
    }
    return good;
  }

  SceneSpec WithContents(SceneSpec spec) const {
    Rng rng = Rng::Stream(0, "check");
    const std::vector<std::string> kinds = ObjectKindsOf(run_);
    for (size_t i = 0; i < kinds.size(); ++i) {
      SceneObject object = MakeCatalogueObject(kinds[i], fmt::format("object_{}", i), rng);
      object.pos = Vec3{10.0 + static_cast<double>(i), 0, 1};
      spec.objects.push_back(object);
    }
    spec.robots.push_back({.name = run_.robot.config.name,
                           .config = run_.robot.config,
                           .prefix = "robot_0/",
                           .pos = Vec3{20, 10, 1},
                           .control_modes = run_.robot.config.used_modes()});
    return spec;
  }

  void CheckCameras(const Scene& scene) {
    for (size_t i = 0; i < run_.cameras.streams.size(); ++i) {
      Problems::Scope streams(problems_, "cameras.streams");
      Problems::Scope item(problems_, i);
      const CameraConfig& stream = run_.cameras.streams[i];
      Try(stream.follow.empty() ? "camera" : "follow", [&] { ViewOfStream(scene, stream); });
    }
  }

  bool CheckRobotItself(const Robot& robot) {
    Problems::Scope scope(problems_, "robot");
    return CheckRobot(robot, problems_);
  }

  void CheckForExpert(const Scene& scene, Robot& robot) {
    {
      Problems::Scope scope(problems_, "robot");
      if (!CheckScriptedExpert(robot, run_.options, scene.timestep(), problems_)) return;
    }
    CheckReach(run_, robot, problems_);
    Try("task", [&] { CheckGraspable(scene, robot); });
  }

  // The expert acts with one arm.
  void TellUnused(const Robot& robot) {
    const std::string unused = TellUnusedGroups(robot);
    if (unused.empty()) return;
    Problems doubt(run_.locations);
    doubt.AddAt("robot", fmt::format("has several arms or grippers, and pick tasks act with one of "
                                     "each, the first arm of `move_groups` and its gripper: {}",
                                     unused));
    warnings_.push_back(LinesOf(doubt).front());
  }

  // Kinds of objects that the gripper cannot take; sizes that are drawn may differ.
  void CheckGraspable(Scene scene, const Robot& robot) {
    const auto shape = GripperShape::Of(robot.config(), run_.options, scene.timestep());
    scene.Forward();
    const std::vector<std::string> kinds = ObjectKindsOf(run_);
    for (size_t i = 0; i < kinds.size(); ++i) {
      const ObjectRecord& object = scene.compiled()->object(fmt::format("object_{}", i));
      const int body = FindId(scene.model(), mjOBJ_BODY, object.root_body);
      if (!FindGrasps(scene.model(), scene.data(), body, *shape, robot.tcp_in_world()).empty())
        continue;
      Problems doubt(run_.locations);
      doubt.AddAt("task.objects",
                  fmt::format("gripper '{}' cannot hold '{}' ({}): such starts are refused. Leave "
                              "the kind out of task.objects, or take a gripper that fits",
                              robot.gripper().name(), kinds[i],
                              SizesForGrasp(scene.model(), scene.data(), body, *shape)));
      warnings_.push_back(LinesOf(doubt).front());
    }
  }

  // What it does, in a scene of its own. On a floor: a free base that falls carries nothing.
  void TryAlone() {
    SceneSpec spec{.name = run_.run,
                   .timestep = run_.rates.timestep().value(),
                   .add_floor = true,
                   .add_skybox = false,
                   .options = run_.options};
    const RobotConfig& config = run_.robot.config;
    spec.robots.push_back(
        {.name = config.name, .config = config, .control_modes = config.used_modes()});
    const std::vector<std::string> doubts =
        TryRobotBesideWarnings(Robot::Of(Scene::Build(spec), config.name));
    warnings_.insert(warnings_.end(), doubts.begin(), doubts.end());
  }

  const RunConfig& run_;
  const RunDemands& demands_;
  Problems& problems_;
  std::vector<std::string> warnings_;
};

}  // namespace

void CheckRunFields(const RunConfig& run) { FieldProblems(run).Throw(Title(run)); }

std::vector<std::string> CheckRun(const RunConfig& run, const RunDemands& demands) {
  Problems problems = FieldProblems(run);
  problems.Throw(Title(run));
  SceneCheck scene(run, demands, problems);
  scene.Run();
  problems.Throw(Title(run));
  std::vector<std::string> warnings = scene.warnings();
  for (std::string& small : SmallStreams(run)) warnings.push_back(std::move(small));
  return warnings;
}

}  // namespace robocell
