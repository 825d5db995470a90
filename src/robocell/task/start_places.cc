// The part of StartSampler about where objects may lie: the placements that a run and its task state,
// what a start may contain, and the checks of both before the first start.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robocell/scene/scene_cache.h"
#include "robocell/scenes/object_places.h"
#include "robocell/scenes/related_places.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/yaml.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/start_contents.h"
#include "robocell/task/start_sampler.h"
#include "robocell/task/task_calls.h"
#include "robocell/task/task_kind.h"

namespace robocell {

// Returns the placements of `start` and of the task, in the order of precedence.
std::vector<internal::StatedPlaces> StartSampler::PlacesStated() {
  std::vector<internal::StatedPlaces> stated;
  if (!run_.start.places.empty())
    stated.push_back({.places = run_.start.places, .path = "start.places"});
  if (const Map<ObjectPlace> own = internal::TaskCalls(*task_).Places(); !own.empty())
    stated.push_back({.places = own, .path = "task", .hook = "places()"});
  return stated;
}

const std::shared_ptr<const internal::Landmarks>& StartSampler::LandmarksOf(const SceneSpec& base,
                                                                            int scene_index) {
  const std::string key = SceneKey(base);
  if (const auto known = landmarks_.find(key); known != landmarks_.end()) return known->second;
  if (landmarks_.size() >= kMostScenes) landmarks_.clear();
  return landmarks_[key] =
             internal::LandmarksOf(base, RequireSource().CheckedAnnotations(scene_index));
}

// Unset when nobody says anything of places. `spec` has the contents from number `before` on.
std::optional<internal::RelatedPlaces> StartSampler::RelationsOf(const SceneSpec& spec,
                                                                 size_t before, int scene_index,
                                                                 const StartContents& contents) {
  const std::vector<internal::StatedPlaces> stated = PlacesStated();
  if (stated.empty()) return std::nullopt;
  SceneSpec base = spec;
  base.objects.boxes().resize(std::min(before, base.objects.size()));
  const auto may_come = [&](const std::string& name) {
    return PossibleNames(scene_index).contains(name);
  };
  Problems problems(run_.locations);
  std::vector<internal::PlaceLink> links =
      internal::LinkPlaces(LandmarksOf(base, scene_index), stated,
                           {contents.objects, contents.kinds, may_come}, problems);
  problems.Throw("run '" + run_.run + "'");
  return internal::RelatedPlaces(std::move(links));
}

StartContents StartSampler::TakePlaced(SceneSpec& spec, size_t before) {
  StartContents taken;
  const std::vector<internal::StatedPlaces> stated = PlacesStated();
  std::vector<SceneObject> others;
  for (size_t i = 0; i < spec.objects.size(); ++i) {
    SceneObject object = spec.objects[i];
    const auto says = [&](const internal::StatedPlaces& each) {
      return each.places.contains(object.name);
    };
    if (i >= before || std::ranges::none_of(stated, says)) {
      others.push_back(std::move(object));
      continue;
    }
    if (!internal::IsFixed(object)) internal::ForgetPose(object);
    taken.kinds.push_back(object.name);
    taken.objects.push_back(std::move(object));
  }
  if (taken.objects.empty()) return taken;
  ReplaceObjects(spec, 0, others);
  ReplaceObjects(spec, others.size(), taken.objects);
  return taken;
}

std::vector<StartContents> StartSampler::PossibleContents(int scene_index) {
  return kind_->PossibleContents(run_, scene_index, MakeBaseScene(scene_index),
                                 [&] { return AnnotationsOf(scene_index); });
}

const std::set<std::string>& StartSampler::PossibleNames(int scene_index) {
  const auto known = possible_names_.find(scene_index);
  if (known != possible_names_.end()) return known->second;
  if (possible_names_.size() >= kMostScenes) possible_names_.clear();
  std::set<std::string>& names = possible_names_[scene_index];
  for (const StartContents& contents : PossibleContents(scene_index)) {
    for (const SceneObject& object : contents.objects) names.insert(object.name);
    names.insert(contents.kinds.begin(), contents.kinds.end());
  }
  return names;
}

void StartSampler::ValidateStarts(std::span<const int> scenes, Problems& problems) {
  // The experts of the built-in kinds require a base that can be moved themselves. A run of such a
  // kind whose expert and sampler are given to the Runner may have another one.
  if (run_.robot.config.base.kind == BaseKind::kFixed && !kind_->is_built_in()) {
    problems.AddAt(
        "robot.base.kind",
        "the robot stands where `start` or base_range() of the task puts it, and a fixed "
        "base cannot be moved; give it `base: {kind: mocap}`, or the run a `sampler` of "
        "its own");
  }
  const std::shared_ptr<void> forget(nullptr, [this](void*) { task_.reset(); });
  sizes_ = std::make_unique<ObjectSizes>();
  if (!scenes.empty()) ValidateRepeats(scenes.front(), problems);
  Problems found(run_.locations);
  internal::PlaceMistakes reported;  // several starts show one mistake
  for (const int scene : scenes) {
    SceneSpec spec = MakeBaseScene(scene);
    Rng rng = Rng::Stream(static_cast<uint64_t>(run_.seed), "possible contents", scene);
    AddContents({.scene = scene}, spec, rng);  // tasks may choose their places in prepare()
    const std::vector<internal::StatedPlaces> stated = PlacesStated();
    if (stated.empty()) continue;
    SceneSpec own = MakeBaseScene(scene);
    const StartContents placed = TakePlaced(own, own.objects.size());
    own.objects.boxes().resize(own.objects.size() - placed.objects.size());
    const std::shared_ptr<const internal::Landmarks> base = LandmarksOf(own, scene);
    const auto may_come = [&](const std::string& name) {
      return PossibleNames(scene).contains(name);
    };
    for (StartContents contents : PossibleContents(scene)) {
      AppendTo(contents, placed);
      internal::LinkPlaces(base, stated, {contents.objects, contents.kinds, may_come}, found,
                           reported);
    }
  }
  for (const Problem& problem : found.list()) problems.AddProblem(problem);
}

void StartSampler::ValidateBaseRange(const Robot& robot, Problems& problems) {
  if (run_.robot.config.base.kind == BaseKind::kFixed) return;
  const std::shared_ptr<Task> task = MakeTask();
  if (kind_->Contents(run_).empty() && internal::TaskCalls(*task).Objects().empty()) return;
  const BaseRange of_task = SoundBaseRange(*task);
  robocell::ValidateBaseRange(BaseRangeOf(run_.start, of_task), robot, problems,
                              OwnersOfBaseRange(run_.start, *task, run_.task.kind(), of_task));
}

void StartSampler::ValidateRepeats(int scene, Problems& problems) {
  const auto prepared = [&] {
    SceneSpec spec = MakeBaseScene(scene);
    Rng rng = Rng::Stream(static_cast<uint64_t>(run_.seed), "repeated contents", scene);
    AddContents({.scene = scene}, spec, rng);
    return spec;
  };
  const SceneSpec one = prepared(), other = prepared();
  if (ToYaml(one) == ToYaml(other)) return;
  std::string what;
  for (size_t i = 0; what.empty() && i < std::min(one.objects.size(), other.objects.size()); ++i) {
    if (ToYaml(one.objects[i]) != ToYaml(other.objects[i]))
      what = fmt::format(" (object '{}')", one.objects[i].name);
  }
  problems.AddAt(
      "task",
      fmt::format("prepare() of '{}' makes another scene of the same random stream each time"
                  "{}: take all random numbers from its `rng`, so that a seed gives the "
                  "same dataset again",
                  run_.task.kind(), what));
}

}  // namespace robocell
