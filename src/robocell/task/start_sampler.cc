#include "robocell/task/start_sampler.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "robocell/base/call_hook.h"
#include "robocell/base/error.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/scene/scene_cache.h"
#include "robocell/scenes/object_places.h"
#include "robocell/scenes/related_places.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/scenes/settle.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/validate.h"
#include "robocell/task/task_kind.h"

namespace robocell {
namespace {

// Tries of objects and base around each other. Where none of a few fits, hardly one of many does:
// the next attempt moves on from there.
constexpr int kArrangements = 8;
constexpr int kPlaceTries = 60;           // for objects, until a base pose is clear of the support
constexpr size_t kMostScenes = 64;        // whose supports and landmarks are cached
constexpr double kSamePlace = 1e-6;       // metres
const Eigen::Vector3d kParked(20, 0, 1);  // where the robot waits while the objects settle

// Returns the position of an episode's base placement in a sequence that is even over any stretch,
// and over the first episodes of any number of scenes: the factor is prime.
uint64_t PlacementTurn(const SampleRequest& request) {
  return static_cast<uint64_t>(request.scene) * 7919 + static_cast<uint64_t>(request.episode);
}

// Checks objects that other code made: they are measured before they are compiled into a scene.
void RequireValid(const std::vector<SceneObject>& objects, const std::string& who) {
  for (const SceneObject& object : objects) {
    Problems problems;
    ValidateFields(object, problems);
    if (problems.empty()) continue;
    throw ArgumentError(fmt::format("{}object '{}', which is not valid: {}", who, object.name,
                                    fmt::join(LinesOf(problems), "; ")));
  }
}

}  // namespace

SceneSpec StartSampler::MakeBaseScene(int scene_index) {
  return robocell::MakeBaseScene(run_, *source_, scene_index);
}

struct StartSampler::Measured {
  ObjectSizes sizes;
  std::shared_ptr<const GripperShape> shape;
};

StartSampler::StartSampler(RunConfig run)
    : run_(std::move(run)),
      source_(MakeSceneSource(run_)),
      measured_(std::make_unique<Measured>()) {}
StartSampler::~StartSampler() = default;

ObjectSizes& StartSampler::sizes() { return measured_->sizes; }
std::shared_ptr<const GripperShape>& StartSampler::shape() { return measured_->shape; }

// Many scenes of a run may share a base, and a subclass may make a different one every time, or a
// different file of the same name.
Support StartSampler::FindSupportOf(const SceneSpec& base, int scene_index, Rng& rng) {
  if (const auto known = source_->CheckedAnnotations(scene_index);
      known && !known->supports.empty())
    return known->supports[rng.UniformInt(known->supports.size())].face;
  const std::string key = SceneKey(base);
  const auto it = supports_.find(key);
  if (it != supports_.end()) return it->second;
  if (supports_.size() >= kMostScenes) supports_.clear();
  return supports_[key] = FindSupport(base);
}

BasePlacement StartSampler::ChooseBasePlacement(const SampleRequest& request, Rng& rng) {
  return SpreadBasePlacement(base_range(), static_cast<uint64_t>(run_.seed), PlacementTurn(request),
                             request.attempt, rng);
}

bool StartSampler::PlaceObjects(const Support& support, std::vector<SceneObject>& objects,
                                Rng& rng) {
  std::vector<ObjectSize> own_sizes;
  for (const SceneObject& object : objects) own_sizes.push_back(sizes().Of(object));
  return internal::PlaceOn(support, own_sizes, objects, rng);
}

std::shared_ptr<const SceneAnnotations> StartSampler::AnnotationsOf(int scene_index) {
  if (auto known = source_->CheckedAnnotations(scene_index))
    return std::make_shared<const SceneAnnotations>(*std::move(known));
  const SceneSpec base = MakeBaseScene(scene_index);
  const std::string key = SceneKey(base);
  if (const auto it = annotations_.find(key); it != annotations_.end()) return it->second;
  if (annotations_.size() >= kMostScenes) annotations_.clear();
  return annotations_[key] = std::make_shared<const SceneAnnotations>(DeriveAnnotations(base));
}

// What `start` and the task say of places, in the order in which it counts.
std::vector<internal::SaidPlaces> StartSampler::SaidOfPlaces() const {
  std::vector<internal::SaidPlaces> said;
  if (!run_.start.places.empty())
    said.push_back({.places = run_.start.places, .path = "start.places"});
  if (const Map<ObjectPlace> own = own_places(); !own.empty())
    said.push_back({.places = own, .path = "task", .hook = "places()"});
  return said;
}

const std::shared_ptr<const internal::Landmarks>& StartSampler::LandmarksOf(const SceneSpec& base,
                                                                            int scene_index) {
  const std::string key = SceneKey(base);
  if (const auto known = landmarks_.find(key); known != landmarks_.end()) return known->second;
  if (landmarks_.size() >= kMostScenes) landmarks_.clear();
  return landmarks_[key] = internal::LandmarksOf(base, source_->CheckedAnnotations(scene_index));
}

// Unset when nobody says anything of places. `spec` has the contents from number `before` on.
std::optional<internal::RelatedPlaces> StartSampler::RelationsOf(const SceneSpec& spec,
                                                                 size_t before, int scene_index,
                                                                 const StartContents& contents) {
  const std::vector<internal::SaidPlaces> said = SaidOfPlaces();
  if (said.empty()) return std::nullopt;
  SceneSpec base = spec;
  base.objects.boxes().resize(std::min(before, base.objects.size()));
  const auto may_come = [this](const std::string& name) { return MayHaveObject(name); };
  Problems problems(run_.locations);
  std::vector<internal::PlaceLink> links = internal::LinkPlaces(
      LandmarksOf(base, scene_index), said, {contents.objects, contents.kinds, may_come}, problems);
  problems.Throw("run '" + run_.run + "'");
  return internal::RelatedPlaces(std::move(links));
}

std::vector<StartContents> StartSampler::PossibleContents(int scene_index) {
  SceneSpec spec = MakeBaseScene(scene_index);
  Rng rng = Rng::Stream(static_cast<uint64_t>(run_.seed), "possible contents", scene_index);
  return {AddContents({.scene = scene_index}, spec, rng)};
}

void StartSampler::ValidateStarts(std::span<const int> scenes, Problems& problems) {
  measured_ = std::make_unique<Measured>();
  const auto may_come = [this](const std::string& name) { return MayHaveObject(name); };
  Problems found(run_.locations);
  std::set<std::pair<std::string, std::string>> reported;
  for (const int scene : scenes) {
    const std::vector<StartContents> possible = PossibleContents(scene);
    const std::vector<internal::SaidPlaces> said = SaidOfPlaces();
    if (said.empty()) return;
    const std::shared_ptr<const internal::Landmarks> base =
        LandmarksOf(MakeBaseScene(scene), scene);
    for (const StartContents& contents : possible) {
      internal::LinkPlaces(base, said, {contents.objects, contents.kinds, may_come}, found);
    }
  }
  for (const Problem& problem : found.list()) {
    if (reported.emplace(problem.path, problem.message).second) problems.AddProblem(problem);
  }
}

std::optional<Refusal> StartSampler::PutObjects(
    const Support& support, const std::optional<internal::RelatedPlaces>& related,
    std::vector<SceneObject>& objects, Rng& rng) {
  const Refusal no_room =
      Refusal{Refusal::kNoFreePlace, "the objects do not fit beside each other"}.MadeBy(
          Refusal::kObjectsStage);
  if (!related) {
    if (PlaceObjects(support, objects, rng)) return std::nullopt;
    return no_room;
  }
  std::vector<SceneObject> loose;
  for (size_t i = 0; i < objects.size(); ++i) {
    if (!related->IsRelated(i)) loose.push_back(objects[i]);
  }
  if (!PlaceObjects(support, loose, rng)) return no_room;
  std::vector<ObjectSize> own_sizes;
  for (size_t i = 0, next = 0; i < objects.size(); ++i) {
    own_sizes.push_back(sizes().Of(objects[i]));
    if (!related->IsRelated(i)) objects[i] = loose[next++];
  }
  if (const auto why_not = related->Put(support, own_sizes, objects, rng))
    return Refusal{Refusal::kNoFreePlace, *why_not}.MadeBy(Refusal::kObjectsStage);
  return std::nullopt;
}

std::optional<Pose> StartSampler::ProposeBasePose(const Robot& robot, const Support& support,
                                                  const Pose& target,
                                                  const BasePlacement& placement, Rng& rng) {
  return robocell::ProposeBasePose(robot, support, target, placement, run_.start, rng);
}

std::optional<Refusal> StartSampler::ValidateBasePose(Scene& scene, Robot& robot,
                                                      const std::string& target_body) {
  if (auto refusal = ValidateBaseReach(robot, scene.body_pose(target_body))) return refusal;
  return ValidateBaseClearance(scene, robot, run_.start.base_clearance);
}

std::optional<Refusal> StartSampler::ValidateCameras(Scene& scene, const std::string& target_body) {
  return ValidateVisibility(scene, target_body, run_);
}

struct StartSampler::Setup {
  std::shared_ptr<Task> task;
  std::vector<SceneObject> contents;           // as they were added
  std::vector<std::optional<Pose>> own_poses;  // in the world, of those that keep theirs
  std::vector<SceneObject> objects;            // where they were put
  std::optional<internal::RelatedPlaces> related;
  Scene scene;
  Robot robot;
  std::string target_body;  // "" for a task without objects
  Pose middle;              // of the support
  StopRequest stop;
  RefusalCounts redrawn = {};

  // Whether a body is an object that has a place in relation to something.
  bool IsRelated(const std::string& body) const {
    for (size_t i = 0; related && i < contents.size(); ++i) {
      if (related->IsRelated(i) && scene.compiled()->object(contents[i].name).root_body == body)
        return true;
    }
    return false;
  }
  // Returns the pose beside which the robot stands.
  Pose target() const { return target_body.empty() ? middle : scene.body_pose(target_body); }
};

std::optional<Refusal> StartSampler::ArrangeOnce(Setup& setup, const Support& support,
                                                 const BasePlacement& placement, Rng& rng) {
  std::optional<Pose> base;
  BodyPoses moved;
  Pose target;
  for (int t = 0; t < kPlaceTries && !base; ++t) {
    setup.objects = setup.contents;
    if (auto refusal = PutObjects(support, setup.related, setup.objects, rng)) return refusal;
    moved = TaskStarts(rng);
    std::erase_if(moved, [&](const auto& body) { return setup.IsRelated(body.first); });
    if (setup.objects.empty())
      target = setup.middle;
    else
      target = setup.own_poses.front().value_or(setup.objects.front().pose());
    for (const auto& [body, pose] : moved) {
      if (body == setup.target_body) target = pose;
    }
    base = ProposeBasePose(setup.robot, support, target, placement, rng);
  }
  if (!base) {
    return Refusal{Refusal::kBaseInCollision,
                   fmt::format("{:.2f} m from the target and {:.2f} m above it the robot overlaps "
                               "the support wherever the target lies",
                               placement.distance, placement.height)}
        .MadeBy(Refusal::kBaseStage);
  }
  for (size_t i = 0; i < setup.objects.size(); ++i) {
    const ObjectRecord& record = setup.scene.compiled()->object(setup.objects[i].name);
    if (setup.own_poses[i] && !record.free_joint) continue;
    setup.scene.SetBodyPose(record.root_body, setup.own_poses[i].value_or(setup.objects[i].pose()));
  }
  internal::CallHook(*setup.task, "starts", [&] {
    for (const auto& [body, pose] : moved) setup.scene.SetBodyPose(body, pose);
  });
  setup.robot.base().SetPose(*base);
  setup.scene.Forward();
  if (auto refusal = ArrangeTask(setup.scene, rng))
    return std::move(*refusal).MadeBy(Refusal::kTaskStage);
  if (auto refusal = ValidateDistance(setup, target))
    return std::move(*refusal).MadeBy(Refusal::kBaseStage);
  return ValidatePlaced(setup);
}

// A task that moves its target again may take it out of the range that it required.
std::optional<Refusal> StartSampler::ValidateDistance(const Setup& setup,
                                                      const Pose& proposed_for) const {
  const Pose target = setup.target();
  if ((target.translation() - proposed_for.translation()).norm() < kSamePlace) return std::nullopt;
  return ValidateBaseDistance(setup.robot, target, base_range());
}

// Checks the conditions that hold both before and after settling.
std::optional<Refusal> StartSampler::ValidatePlaced(Setup& setup) {
  if (setup.target_body.empty()) {
    if (auto refusal = ValidateBaseClearance(setup.scene, setup.robot, run_.start.base_clearance))
      return std::move(*refusal).MadeBy(Refusal::kBaseStage);
    return std::nullopt;
  }
  if (auto refusal = ValidateBasePose(setup.scene, setup.robot, setup.target_body))
    return std::move(*refusal).MadeBy(Refusal::kBaseStage);
  if (auto refusal = ValidateCameras(setup.scene, setup.target_body))
    return std::move(*refusal).MadeBy(Refusal::kCamerasStage);
  return std::nullopt;
}

// Draws places for the objects and the base until both fit, and counts the rejected ones. Nothing
// is stepped, so many tries are cheap.
std::optional<Refusal> StartSampler::Arrange(Setup& setup, const Support& support,
                                             const BasePlacement& placement, Rng& rng) {
  std::optional<Refusal> refusal = ArrangeOnce(setup, support, placement, rng);
  for (int t = 1; t < kArrangements && refusal && !ShouldStop(setup.stop); ++t) {
    if (refusal->reason == Refusal::kNoGrasp) break;  // no base pose changes that
    ++setup.redrawn[refusal->counted_as()];
    refusal = ArrangeOnce(setup, support, placement, rng);
  }
  return refusal;
}

// Turns the built scene into the start state.
std::optional<Refusal> StartSampler::PrepareStart(Setup& setup, const Support& support,
                                                  const BasePlacement& placement, Rng& rng) {
  if (auto refusal = Arrange(setup, support, placement, rng)) return refusal;
  if (auto why_not = internal::Settle(setup.scene, {&setup.robot, 1}, setup.target_body,
                                      {.sim_steps = run_.rates.sim_steps(), .stop = setup.stop}))
    return Refusal{Refusal::kUnsettled, *why_not}.MadeBy(Refusal::kSettlingStage);
  if (setup.related) {
    if (const auto why_not = setup.related->WhyNotKept(setup.scene, setup.objects))
      return Refusal{Refusal::kUnsettled, *why_not}.MadeBy(Refusal::kSettlingStage);
  }
  if (auto refusal = ValidatePlaced(setup)) return refusal;
  setup.scene.data()->time = 0;
  setup.scene.Forward();
  return std::nullopt;
}

SampleResult StartSampler::Sample(const SampleRequest& request, Rng& rng) {
  measured_ = std::make_unique<Measured>();
  SceneSpec spec = MakeBaseScene(request.scene);
  Rng support_rng = rng.Fork("support");
  const Support support = FindSupportOf(spec, request.scene, support_rng);
  const size_t before = spec.objects.size();
  StartContents contents = AddContents(request, spec, rng);
  const std::vector<std::string>& kinds = contents.kinds;
  const std::string kind = kinds.empty() ? "" : kinds.front();
  const BasePlacement placement = ChooseBasePlacement(request, rng);
  RequireFinite(placement);
  std::vector<std::string> names;
  for (const SceneObject& object : contents.objects) names.push_back(object.name);
  const std::optional<internal::RelatedPlaces> related =
      RelationsOf(spec, before, request.scene, contents);
  std::vector<SceneObject> objects = contents.objects;
  if (auto refusal = PutObjects(support, related, objects, rng)) {
    refusal->object_kind = kind;
    return {.start = {}, .refusal = *std::move(refusal)};
  }
  for (size_t i = 0; i < objects.size(); ++i) {
    if (before + i < spec.objects.size())
      spec.objects[before + i] = objects[i];
    else
      spec.objects.push_back(objects[i]);
  }
  spec.robots.push_back({.name = run_.robot.config.name,
                         .config = run_.robot.config,
                         .prefix = "robot_0/",
                         .pos = ToVec3(kParked),
                         .control_modes = run_.robot.config.used_modes()});

  Scene scene = Scene::Build(spec);
  scene.Reset({.seed = rng.Fork("home").NextBits()});
  const std::string target = names.empty() ? "" : names.front();
  const std::shared_ptr<Task> task = MakeTask(target, kind, names);
  internal::CallHook(*task, "bind", [&] {
    task->Bind(scene, {.place = "run '" + run_.run + "'", .robots = {run_.robot.config.name}});
  });
  std::vector<std::optional<Pose>> own_poses;
  for (const SceneObject& object : contents.objects) {
    own_poses.emplace_back();
    if (internal::KeepsPose(object))
      own_poses.back() = scene.body_pose(scene.compiled()->object(object.name).root_body);
  }
  Setup setup{task,
              contents.objects,
              std::move(own_poses),
              std::move(objects),
              related,
              scene,
              Robot::Of(scene, run_.robot.config.name),
              target.empty() ? "" : scene.compiled()->object(target).root_body,
              support.frame_to_world,
              request.stop};
  if (auto refusal = PrepareStart(setup, support, placement, rng)) {
    refusal->redrawn = setup.redrawn;
    refusal->object_kind = kind;
    return {.start = {}, .refusal = *refusal};
  }
  return {.start = EpisodeStart{.scene = scene,
                                .task = task,
                                .target_object = target,
                                .object_kinds = kinds,
                                .base_in_world = setup.robot.base().pose(),
                                .redrawn = setup.redrawn,
                                .is_bound = true},
          .refusal = {}};
}

TaskStartSampler::TaskStartSampler(const RunConfig& run)
    : StartSampler(run), kind_(FindTaskKind(run.task.kind())) {
  kind_->Make(run.task);  // its errors come before the first start
}

// Makes one to answer for its fields while no start is under construction.
Task& TaskStartSampler::task() const {
  if (!task_) {
    task_ = internal::CallHook(Hooks(), "the task's constructor",
                               [&] { return kind_->Make(run().task); });
  }
  return *task_;
}

SampleResult TaskStartSampler::Sample(const SampleRequest& request, Rng& rng) {
  SampleResult result = StartSampler::Sample(request, rng);
  task_.reset();
  return result;
}

StartContents TaskStartSampler::AddContents(const SampleRequest& request, SceneSpec& spec,
                                            Rng& rng) {
  const size_t before = spec.objects.size();
  task_.reset();
  internal::CallHook(task(), "prepare", [&] {
    task().PrepareIn([&] { return AnnotationsOf(request.scene); }, spec, rng);
  });
  StartContents contents;
  for (size_t i = before; i < spec.objects.size(); ++i) {
    contents.objects.push_back(spec.objects[i]);
    contents.kinds.push_back(spec.objects[i].name);
  }
  internal::CallHook(task(), "prepare", [&] {
    RequireValid(contents.objects, "task '" + run().task.kind() + "': prepare added ");
  });
  return contents;
}

std::shared_ptr<Task> TaskStartSampler::MakeTask(const std::string& /*target*/,
                                                 const std::string& /*kind*/,
                                                 const std::vector<std::string>& /*objects*/) {
  return task_;
}

void TaskStartSampler::ValidateStarts(std::span<const int> scenes, Problems& problems) {
  if (run().robot.config.base.kind == BaseKind::kFixed) {
    problems.AddAt(
        "robot.base.kind",
        "the robot stands where `start` or base_range() of the task puts it, and a fixed "
        "base cannot be moved; give it `base: {kind: mocap}`, or the run a `sampler` of "
        "its own");
  }
  StartSampler::ValidateStarts(scenes, problems);
}

BaseRange TaskStartSampler::own_base_range() const { return SoundBaseRange(task()); }

Map<ObjectPlace> TaskStartSampler::own_places() const {
  return internal::CallHook(task(), "places", [&] { return task().places(); });
}

BodyPoses TaskStartSampler::TaskStarts(Rng& rng) {
  return internal::CallHook(task(), "starts", [&] { return task().Starts(rng); });
}

std::optional<Refusal> TaskStartSampler::ArrangeTask(Scene& scene, Rng& rng) {
  return internal::CallHook(task(), "arrange", [&] { return task().Arrange(scene, rng); });
}

}  // namespace robocell
