#include "robocell/rollout/validate_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/paths.h"
#include "robocell/base/suggestions.h"
#include "robocell/expert/expert_kind.h"
#include "robocell/features/cell_features.h"
#include "robocell/features/own_features.h"
#include "robocell/media/ffmpeg.h"
#include "robocell/render/renderer.h"
#include "robocell/render/stream_camera.h"
#include "robocell/robot/validate_config.h"
#include "robocell/rollout/episode_cameras.h"
#include "robocell/rollout/episode_columns.h"
#include "robocell/rollout/plan.h"
#include "robocell/rollout/run_renderer.h"
#include "robocell/rollout/source_demos.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/randomization.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/spec_bytes.h"
#include "robocell/spec/validate.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/sampler_kind.h"
#include "robocell/task/start_cameras.h"
#include "robocell/task/start_contents.h"
#include "robocell/task/task_calls.h"
#include "robocell/task/task_kind.h"
#include "robocell/task/task_sampler.h"

namespace robocell {
namespace {

// Checks whether the image streams of a run can be recorded: by their fields, and on this machine.

// Turns an exception into a problem of the field, or of the whole stream.
template <class F>
void Try(Problems& problems, const char* field, F&& check) {
  try {
    check();
  } catch (const ArgumentError& error) {
    field ? problems.AddAt(field, error.what()) : problems.Add(error.what());
  } catch (const EngineError& error) {
    problems.Add(error.what());
  } catch (const std::bad_alloc&) {
    problems.Add("there is not enough memory for an image of this size");
  }
}

// Checks names and sizes by the rules of the episode's writer; problems that ValidateFields reports
// are left out.
void ValidateVideo(const CameraSystemConfig& cameras, const CameraConfig& stream,
                   Problems& problems) {
  if (!stream.name.empty() && !internal::ValidFileName(stream.name))
    return Try(problems, "name", [&] { internal::RequireFileName("stream", stream.name); });
  const int width = cameras.width(stream), height = cameras.height(stream);
  if (stream.name.empty() || width < 1 || height < 1 || width % 2 != 0 || height % 2 != 0) return;
  Try(problems, nullptr, [&] {
    EpisodeSchema().AddCamera({.name = stream.name,
                               .width = width,
                               .height = height,
                               .depth = stream.depth,
                               .segmentation = stream.segmentation});
  });
}

std::string FailingStreams(const RunConfig& run) {
  const size_t count = run.cameras.streams.size();
  return fmt::format("run '{}' records {} camera stream{}, on this machine that fails: ", run.run,
                     count, count == 1 ? "" : "s");
}

// Returns a renderer of empty images: software OpenGL takes 0.2 s to prepare for a model's
// textures, and this check only asks whether it works.
std::unique_ptr<Renderer> RendererFor(const RunConfig& run) {
  try {
    FfmpegVersion();
    return internal::MakeRendererOf(run, {.geom_groups = {}, .sites = false, .skybox = false});
  } catch (const IoError& error) {
    throw IoError(FailingStreams(run) + error.what());
  } catch (const Error& error) {
    throw Error(FailingStreams(run) + error.what());
  }
}

// Adds problems at cameras.streams[i] for values that a spec may have but an episode cannot hold.
void ValidateStreams(const RunConfig& run, Problems& problems) {
  Problems::Scope cameras(problems, "cameras.streams");
  for (size_t i = 0; i < run.cameras.streams.size(); ++i) {
    Problems::Scope item(problems, i);
    const CameraConfig& stream = run.cameras.streams[i];
    ValidateVideo(run.cameras, stream, problems);
    if (stream.rate != 0)
      problems.AddAt("rate", "records take one frame per action; leave rate at 0");
    if (!stream.rgb) problems.AddAt("rgb", "a recorded stream needs rgb: true");
  }
}

// Returns true for a stream that may follow an object of a sampler of the run's own, which is only
// known with its starts.
bool IsOfSampler(const RunConfig& run, const CameraConfig& stream) {
  return !run.sampler.empty() && !stream.follow.empty();
}

// Draws one image of each stream with the settings of the run. Throws IoError without an encoder
// and Error without OpenGL, each naming what needs it; a stream that cannot be drawn becomes a
// problem. Does nothing without streams. `scene` must have the streams' cameras.
void ValidateStreamsHere(const RunConfig& run, const Scene& scene, Problems& problems) {
  if (run.cameras.drawn().empty()) return;
  const std::unique_ptr<Renderer> renderer = RendererFor(run);
  {
    Problems::Scope quality(problems, "cameras.renderer.quality");
    const size_t before = problems.list().size();
    Try(problems, nullptr, [&] { renderer->SetModel(scene.model()); });
    if (problems.list().size() != before) return;
  }
  std::vector<uint8_t> rgb;
  for (size_t i = 0; i < run.cameras.streams.size(); ++i) {
    const CameraConfig& stream = run.cameras.streams[i];
    if (IsOfSampler(run, stream)) continue;
    Problems::Scope cameras(problems, "cameras.streams");
    Problems::Scope item(problems, i);
    Try(problems, nullptr, [&] {
      const CameraView view = internal::ViewOfStream(scene, stream);
      const int width = run.cameras.width(stream), height = run.cameras.height(stream);
      rgb.resize(3 * static_cast<size_t>(width) * static_cast<size_t>(height));
      renderer->Render(scene.data(), {.camera = view, .width = width, .height = height},
                       {.rgb = rgb});
    });
  }
}

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

// Returns the problems of the fields alone.
Problems FieldProblems(RunConfig run, const RunDemands& demands) {
  if (!demands.output && run.output.empty()) run.output = ".";  // where nothing goes
  Problems problems(run.locations);
  ValidateFields(run, problems);
  ValidateStreams(run, problems);
  try {
    ValidateHouses(run, problems);
  } catch (const Error& error) {  // the source cannot be made
    problems.AddAt("scenes", error.what());
  }
  ValidateOwnFeatures(run, problems);
  ValidateSampler(run, problems);
  return problems;
}

std::string Title(const RunConfig& run) { return "run '" + run.run + "'"; }

// The checks that need a compiled scene: the first scene of the run, with its robot and one object
// of each kind.
class SceneValidator {
 public:
  SceneValidator(const RunConfig& run, const RunDemands& demands, Problems& problems)
      : run_(run), demands_(demands), problems_(problems), doubts_(run.locations) {}

  // Returns the warnings of the scene, and those of task and expert.
  std::vector<Finding> Warnings() const {
    std::vector<Finding> warnings;
    for (const std::string& line : compile_warnings_) {
      auto [place, text] = SplitPlace(line);
      warnings.push_back({.place = std::move(place), .text = std::move(text)});
    }
    for (const Problem& doubt : doubts_.list()) {
      warnings.push_back(
          {.subject = doubts_.Shown(doubt.path), .place = doubt.source, .text = doubt.message});
    }
    return warnings;
  }

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
    std::vector<SceneObject> contents;
    if (!Try("task", [&] { contents = task_->Contents(run_); })) return;
    if (!Try("task", [&] { BuildWith(bases.front(), contents, false); })) return;
    if (!Try("robot", [&] { scene = BuildWith(bases.front(), contents); })) return;
    if (!run_.start.cameras.empty()) {
      if (!Try("start.cameras", [&] { MountCameras(*scene); })) return;
      if (!Try("start.cameras", [&] { scene = BuildWith(bases.front(), contents); })) return;
    }
    compile_warnings_ = scene->compiled()->warnings();
    std::optional<Scene> start = scene;
    if ((FollowsObjects() || cameras_ || run_.randomize) &&
        !Try("task", [&] { start = BuildStart(first, bases.front()); }))
      return;
    ValidateCameras(*start);
    ValidateRandomize(*start);
    std::optional<Robot> robot;
    if (!Try("robot", [&] { robot = Robot::Of(*scene, run_.robot.config.name); })) return;
    if (cameras_) Try("start.cameras", [&] { RequireCamerasObjects(*start); });
    // A robot that cannot be measured is reported once.
    if (ValidateRobotItself(*robot)) ValidateForTask(*scene, *robot);
    if (problems_.empty()) ValidateStarts(bases);
    if (demands_.on_this_machine && problems_.empty()) ValidateStreamsHere(run_, *start, problems_);
  }

 private:
  // Runs a check and turns its exception into a problem of the field.
  template <class F>
  bool Try(const char* field, F&& check) {
    try {
      check();
      return true;
    } catch (const IoError&) {
      throw;  // an error of the disk, not of the spec
    } catch (const Error& error) {
      problems_.AddAt(field, error.what());
      return false;
    }
  }

  // Every scene must have a fixed support for objects; reports all scenes that have none.
  bool ValidateSupports(const std::vector<SceneSpec>& bases) {
    bool good = true;
    std::set<std::string> checked;
    const std::vector<int> indices = SceneIndices(run_);
    for (size_t i = 0; i < bases.size(); ++i) {
      if (!checked.insert(internal::SpecBytes(bases[i])).second) continue;
      good &= Try("scenes", [&] { SupportsOf(*source_, indices[i], bases[i]); });
    }
    return good;
  }

  // Requires that what is randomised is in some start.
  void ValidateRandomize(const Scene& start) {
    if (!run_.randomize) return;
    std::vector<std::string> others;
    for (const StartContents& contents : starts_) {
      for (const SceneObject& object : contents.objects) others.push_back(object.name);
    }
    for (int i = 0; run_.randomize->clutter && i < RandomClutter::kMost; ++i)
      others.push_back(fmt::format("clutter_{}", i));
    Try("randomize", [&] {
      internal::Randomization(*run_.randomize, start.inner(),
                              {.place = Title(run_), .directory = run_.source_dir})
          .Validate(others);
    });
  }

  // Finds the cameras of `start.cameras` on a scene without them; scenes built later have them.
  void MountCameras(const Scene& scene) {
    cameras_ = std::make_shared<internal::StartCameras>(
        run_, scene, Robot::Of(scene, run_.robot.config.name), nullptr);
  }

  void RequireCamerasObjects(const Scene& start) const {
    const std::shared_ptr<Task> task = task_->Make(run_.task);
    const std::vector<std::string> named = internal::TaskCalls(*task).Objects();
    cameras_->RequireNames(start, Robot::Of(start, run_.robot.config.name), {}, named);
  }

  bool FollowsObjects() const {
    return std::ranges::any_of(run_.cameras.streams.boxes(), [&](const auto& stream) {
      return !stream->follow.empty() && !IsOfSampler(run_, *stream);
    });
  }

  // Builds the scene of a start, whose objects have other names than one of each kind, and
  // remembers what else starts have.
  Scene BuildStart(int index, const SceneSpec& base) {
    const auto known = [&] {
      return std::make_shared<const SceneAnnotations>(source_->Annotations(index));
    };
    starts_ = task_->TaskKind::PossibleContents(run_, index, base, known);
    return BuildWith(base, starts_.front().objects);
  }

  // Requires that what a stream follows is in each start.
  void RequireAlwaysThere(const Scene& scene, const CameraConfig& stream) const {
    const SegmentLabel followed =
        internal::SegmentLabelsOf(scene)[internal::FollowedBody(scene, stream)];
    // The model of an object decides on its bodies' names; its root has one in each model.
    for (const StartContents& start : starts_) {
      if (HasFollowed(start, followed, stream.follow)) continue;
      throw ArgumentError(fmt::format("'{}' is not in every start; follow an object that is: {}",
                                      stream.follow, ListNames(AlwaysThere(scene))));
    }
  }

  bool HasFollowed(const StartContents& start, const SegmentLabel& followed,
                   const std::string& name) const {
    const StartContents& first = starts_.front();
    const auto kind_of = [&](const StartContents& of) -> std::string {
      for (size_t i = 0; i < of.objects.size(); ++i) {
        if ("objects/" + of.objects[i].name == followed.owner) return of.kinds[i];
      }
      return "";
    };
    if (kind_of(first).empty()) return true;  // of the scene itself, or of the robot
    const bool is_object = "objects/" + name == followed.owner;
    return is_object ? !kind_of(start).empty() : kind_of(start) == kind_of(first);
  }

  std::vector<std::string> AlwaysThere(const Scene& scene) const {
    std::vector<std::string> names = scene.object_names();
    const std::vector<SceneObject>& drawn = starts_.front().objects;
    std::erase_if(names, [&](const std::string& name) {
      const auto has_name = [&](const SceneObject& object) { return object.name == name; };
      return std::ranges::any_of(drawn, has_name) &&
             !std::ranges::all_of(starts_, [&](const StartContents& start) {
               return std::ranges::any_of(start.objects, has_name);
             });
    });
    return names;
  }

  // Builds a scene with objects of the task, apart from each other, and the robot.
  Scene BuildWith(SceneSpec spec, const std::vector<SceneObject>& objects,
                  bool with_robot = true) const {
    const size_t before = spec.objects.size();
    spec = WithContents(std::move(spec), objects, with_robot);
    return BuildPrepared(spec, before, *task_->Make(run_.task));
  }

  SceneSpec WithContents(SceneSpec spec, const std::vector<SceneObject>& objects,
                         bool with_robot) const {
    std::set<std::string> names;
    for (const SceneObject& object : spec.objects) names.insert(object.name);
    double x = 10;
    for (SceneObject object : objects) {
      object.pos = Vec3{x++, 0, 1};
      // A kind may be called like an object of the scene.
      const std::string name = object.name;
      for (int i = 2; !names.insert(object.name).second; ++i)
        object.name = fmt::format("{}_{}", name, i);
      spec.objects.push_back(object);
    }
    if (!with_robot) return spec;
    spec.robots.push_back({.name = run_.robot.config.name,
                           .config = run_.robot.config,
                           .prefix = "robot_0/",
                           .pos = Vec3{20, 10, 1},
                           .control_modes = run_.robot.config.used_modes()});
    if (cameras_) cameras_->AddTo(spec);
    return spec;
  }

  void ValidateCameras(const Scene& scene) {
    for (size_t i = 0; i < run_.cameras.streams.size(); ++i) {
      Problems::Scope streams(problems_, "cameras.streams");
      Problems::Scope item(problems_, i);
      const CameraConfig& stream = run_.cameras.streams[i];
      if (IsOfSampler(run_, stream)) continue;
      if (stream.follow.empty())
        Try("camera", [&] { internal::ViewOfStream(scene, stream); });
      else
        Try("follow", [&] { RequireAlwaysThere(scene, stream); });
    }
    for (const std::string& camera : run_.start.visible_from) {
      Try("start.visible_from", [&] {
        const CameraConfig stream = StreamToSee(run_.cameras, camera);
        if (stream.follow.empty()) internal::ViewOfStream(scene, stream);  // else checked above
      });
    }
  }

  void ValidateForTask(const Scene& scene, Robot& robot) {
    task_->ValidateScene(run_, scene, robot, problems_, doubts_);
    if (!demands_.scripted_expert) return;
    Try("task", [&] { ValidateBaseRange(robot); });
    if (run_.augment) {
      if (!robot.has_arm())
        problems_.AddAt("robot", "has no arm, and the source episodes are of one");
      Try("augment.dataset", [&] { internal::RequireSources(run_); });
      return;
    }
    Try(run_.expert.empty() ? "task" : "expert",
        [&] { ExpertKindFor(run_)->Validate(run_, scene, robot, problems_, doubts_); });
  }

  // Other samplers have places of their own for the base.
  void ValidateBaseRange(const Robot& robot) {
    if (!run_.sampler.empty()) return;
    MakeSampler(run_)->ValidateBaseRange(robot, problems_);
  }

  // Validates the starts in each distinct scene.
  void ValidateStarts(const std::vector<SceneSpec>& bases) {
    std::vector<int> scenes;
    std::set<std::string> seen;
    const std::vector<int> indices = SceneIndices(run_);
    for (size_t i = 0; i < bases.size(); ++i) {
      if (seen.insert(internal::SpecBytes(bases[i])).second) scenes.push_back(indices[i]);
    }
    Try(run_.sampler.empty() ? "task" : "sampler",
        [&] { MakeSampler(run_)->ValidateStarts(scenes, problems_); });
  }

  bool ValidateRobotItself(const Robot& robot) {
    Problems::Scope scope(problems_, "robot");
    return ValidateRobot(robot, problems_);
  }

  const RunConfig& run_;
  const std::shared_ptr<const TaskKind> task_ = FindTaskKind(run_.task.kind());
  std::shared_ptr<SceneSource> source_;
  std::vector<StartContents> starts_;  // contents of a number of starts, if something names objects
  std::shared_ptr<internal::StartCameras> cameras_;
  const RunDemands& demands_;
  Problems& problems_;
  Problems doubts_;
  std::vector<std::string> compile_warnings_;
};

// Turns an exception of a check into a problem of the robot.
template <class F>
void AsProblem(Problems& problems, const F& check) {
  try {
    check();
  } catch (const IoError&) {
    throw;  // an error of the disk, not of the spec
  } catch (const Error& error) {
    problems.Add(error.what());
  }
}

// Names of joints and sensors become paths in steps.h5, which restricts them.
void RequireRecordable(const Robot& robot) {
  EpisodeSchema schema;
  const internal::OutcomeColumns outcome(schema, robot.scene(), {}, {});
  const internal::FeatureColumns columns(schema, CellFeatures(robot.scene(), {robot}).schema());
}

}  // namespace

void ValidateRunFields(const RunConfig& run, const RunDemands& demands) {
  FieldProblems(run, demands).Throw(Title(run));
}

std::vector<Finding> ValidateRun(const RunConfig& run, const RunDemands& demands) {
  Problems problems = FieldProblems(run, demands);
  problems.Throw(Title(run));
  SceneValidator scene(run, demands, problems);
  scene.Run();
  problems.Throw(Title(run));
  return scene.Warnings();
}

bool ValidateRobot(const Robot& robot, Problems& problems) {
  const size_t before = problems.list().size();
  // Recording uses the controllers, and would report the same problems again.
  if (internal::ValidateControllers(robot, problems))
    AsProblem(problems, [&] { RequireRecordable(robot); });
  AsProblem(problems, [&] { internal::ValidateConfig(robot, problems); });
  return problems.list().size() == before;
}

}  // namespace robocell
