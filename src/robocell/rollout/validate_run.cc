#include "robocell/rollout/validate_run.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <set>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/expert/expert_kind.h"
#include "robocell/features/own_features.h"
#include "robocell/render/stream_camera.h"
#include "robocell/rollout/episode_cameras.h"
#include "robocell/rollout/plan.h"
#include "robocell/rollout/validate_robot.h"
#include "robocell/rollout/validate_streams.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/scenes/support.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/spec_bytes.h"
#include "robocell/spec/validate.h"
#include "robocell/task/sampler_kind.h"
#include "robocell/task/task_kind.h"
#include "robocell/task/visible_from.h"

namespace robocell {
namespace {

void ValidateOwnFeatures(const RunConfig& run, Problems& problems) {
  const std::vector<std::string> known = OwnFeatures();
  Problems::Scope features(problems, "features");
  for (size_t i = 0; i < run.features.size(); ++i) {
    if (IsOwnFeature(run.features[i])) continue;
    Problems::Scope item(problems, i);
    problems.Add(NoSuchName("", "registered feature", run.features[i], known) +
                 " Its module belongs into `imports`");
  }
}

void ValidateSampler(const RunConfig& run, Problems& problems) {
  if (run.sampler.empty()) return;
  try {
    FindSamplerKind(run.sampler);
  } catch (const NotFoundError& error) {
    problems.AddAt("sampler", error.what());
  }
}

// Problems of the fields alone.
Problems FieldProblems(const RunConfig& run) {
  Problems problems(run.locations);
  ValidateFields(run, problems);
  ValidateStreams(run, problems);
  FindTaskKind(run.task.kind())->ValidateRun(run, problems);
  try {
    ValidateHouses(run, problems);
  } catch (const Error& error) {  // of a source that cannot be made
    problems.AddAt("scenes", error.what());
  }
  ValidateOwnFeatures(run, problems);
  ValidateSampler(run, problems);
  return problems;
}

std::string Title(const RunConfig& run) { return "run '" + run.run + "'"; }

// The checks that need a compiled scene: the first of the run, with its robot and one object of
// each kind.
class SceneValidator {
 public:
  SceneValidator(const RunConfig& run, const RunDemands& demands, Problems& problems)
      : run_(run), demands_(demands), problems_(problems) {}

  // Warnings of the scene.
  const std::vector<std::string>& warnings() const { return warnings_; }

  void Run() {
    std::vector<SceneSpec> bases;
    if (!Try("scenes", [&] { source_ = MakeSceneSource(run_); })) return;
    for (const int scene : SceneIndices(run_)) {
      if (!Try("scenes", [&] { bases.push_back(MakeBaseScene(run_, *source_, scene)); })) return;
    }
    const int first = SceneIndices(run_).front();
    if (!Try("scenes", [&] { RequireSameAgain(run_, *source_, first, bases.front()); })) return;
    if (!ValidateSupports(bases)) return;
    std::optional<Scene> scene;
    if (!Try("task", [&] { Scene::Build(WithContents(bases.front(), false)); })) return;
    if (!Try("robot", [&] { scene = Scene::Build(WithContents(bases.front())); })) return;
    warnings_ = scene->compiled()->warnings();
    ValidateCameras(*scene);
    std::optional<Robot> robot;
    if (!Try("robot", [&] { robot = Robot::Of(*scene, run_.robot.config.name); })) return;
    // What cannot be measured is reported once.
    if (ValidateRobotItself(*robot)) ValidateForTask(*scene, *robot);
    if (demands_.on_this_machine && problems_.empty()) ValidateStreamsHere(run_, *scene, problems_);
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
  bool ValidateSupports(const std::vector<SceneSpec>& bases) {
    bool good = true;
    std::set<std::string> checked;
    const std::vector<int> indices = SceneIndices(run_);
    for (size_t i = 0; i < bases.size(); ++i) {
      if (!checked.insert(SpecBytes(bases[i])).second) continue;
      good &= Try("scenes", [&] {
        for (const Support& support : SupportsOf(*source_, indices[i], bases[i]))
          RequireSteady(bases[i], support);
      });
    }
    return good;
  }

  SceneSpec WithContents(SceneSpec spec, bool with_robot = true) const {
    double x = 10;
    for (SceneObject object : task_->Contents(run_)) {
      object.pos = Vec3{x++, 0, 1};
      spec.objects.push_back(object);
    }
    if (!with_robot) return spec;
    spec.robots.push_back({.name = run_.robot.config.name,
                           .config = run_.robot.config,
                           .prefix = "robot_0/",
                           .pos = Vec3{20, 10, 1},
                           .control_modes = run_.robot.config.used_modes()});
    return spec;
  }

  void ValidateCameras(const Scene& scene) {
    for (size_t i = 0; i < run_.cameras.streams.size(); ++i) {
      Problems::Scope streams(problems_, "cameras.streams");
      Problems::Scope item(problems_, i);
      const CameraConfig& stream = run_.cameras.streams[i];
      Try(stream.follow.empty() ? "camera" : "follow", [&] { ViewOfStream(scene, stream); });
    }
    for (const std::string& camera : run_.start.visible_from) {
      Try("start.visible_from",
          [&] { ViewOfStream(scene, internal::StreamToSee(run_.cameras, camera)); });
    }
  }

  void ValidateForTask(const Scene& scene, Robot& robot) {
    task_->ValidateScene(run_, scene, robot, problems_, warnings_);
    if (!demands_.scripted_expert) return;
    Try(run_.expert.empty() ? "task" : "expert",
        [&] { ExpertKindOf(run_)->Validate(run_, scene, robot, problems_, warnings_); });
  }

  bool ValidateRobotItself(const Robot& robot) {
    Problems::Scope scope(problems_, "robot");
    return ValidateRobot(robot, problems_);
  }

  const RunConfig& run_;
  const std::shared_ptr<const TaskKind> task_ = FindTaskKind(run_.task.kind());
  std::shared_ptr<SceneSource> source_;
  const RunDemands& demands_;
  Problems& problems_;
  std::vector<std::string> warnings_;
};

}  // namespace

void ValidateRunFields(const RunConfig& run) { FieldProblems(run).Throw(Title(run)); }

std::vector<std::string> ValidateRun(const RunConfig& run, const RunDemands& demands) {
  Problems problems = FieldProblems(run);
  problems.Throw(Title(run));
  SceneValidator scene(run, demands, problems);
  scene.Run();
  problems.Throw(Title(run));
  return scene.warnings();
}

}  // namespace robocell
