#include "robocell/task/pick_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/task/pick_and_place_sampler.h"
#include "robocell/task/pick_task.h"
#include "robocell/task/reach_advice.h"
#include "robocell/task/task_kind.h"

namespace robocell {
namespace {

constexpr int kMostDistractors = 2;
constexpr const char* kTarget = "target";  // its name in the scene
constexpr int kMostGrasps = 4;             // in reach, at least one of which has to be usable

std::string NameOfDistractor(size_t i) { return fmt::format("object_{}", i); }

PickRun RequirePickRun(const RunConfig& run) {
  if (const auto pick = PickRunOf(run.task)) return *pick;
  throw SpecError(
      fmt::format("run '{}': its starts are asked from the sampler of pick tasks, and "
                  "its task is '{}'",
                  run.run, run.task.kind()));
}

}  // namespace

PickTaskSampler::PickTaskSampler(const RunConfig& run)
    : StartSampler(run), pick_(RequirePickRun(run)) {}

// Kinds take turns in a Latin square of scenes and episodes: each of K kinds comes once in any K
// episodes of a scene that start at a multiple of K, and once in the same episode of K such scenes,
// however many of both a run has. Each square draws its order anew: base placements take turns too,
// and with one order for all, each kind would only be seen from its own part of the range.
std::string PickTaskSampler::KindOfTurn(std::vector<std::string> kinds,
                                        const SampleRequest& request) const {
  const size_t count = kinds.size();
  const auto scene = static_cast<size_t>(request.scene);
  const auto episode = static_cast<size_t>(request.episode);
  Rng rng = Rng::Stream(static_cast<uint64_t>(run().seed), "kinds of a square", scene / count,
                        episode / count);
  rng.Shuffle(kinds);
  return kinds[(scene % count + episode % count) % count];
}

std::vector<std::string> PickTaskSampler::ChooseKinds(const SampleRequest& request, Rng& rng) {
  const std::vector<std::string> all = ObjectKinds();
  const std::vector<std::string>& allowed = pick_.objects.empty() ? all : pick_.objects.names;
  std::vector<std::string> kinds = {KindOfTurn(allowed, request)};
  // The other objects are of other kinds: "pick up the mug" has to mean one object.
  std::vector<std::string> others = allowed;
  std::erase(others, kinds.front());
  rng.Shuffle(others);
  const size_t distractors = std::min<size_t>(rng.UniformInt(kMostDistractors + 1), others.size());
  kinds.insert(kinds.end(), others.begin(),
               others.begin() + static_cast<std::ptrdiff_t>(distractors));
  return kinds;
}

StartContents PickTaskSampler::AddContents(const SampleRequest& request, SceneSpec& spec,
                                           Rng& rng) {
  StartContents contents{.objects = {}, .kinds = ChooseKinds(request, rng)};
  for (size_t i = 0; i < contents.kinds.size(); ++i) {
    const std::string name = i == 0 ? kTarget : NameOfDistractor(i);
    contents.objects.push_back(MakeCatalogueObject(contents.kinds[i], name, rng));
    spec.objects.push_back(contents.objects.back());
  }
  return contents;
}

bool PickTaskSampler::MayHaveObject(const std::string& name) const {
  const std::vector<std::string> kinds = ObjectKinds();
  if (std::ranges::find(kinds, name) != kinds.end()) return true;
  for (size_t i = 1; i <= kMostDistractors; ++i) {
    if (name == NameOfDistractor(i)) return true;
  }
  return false;
}

// Distractors take all kinds in turns; more of them than one start has are called as their kind.
std::vector<StartContents> PickTaskSampler::PossibleContents(int /*scene_index*/) {
  const std::vector<std::string> kinds =
      pick_.objects.empty() ? ObjectKinds() : pick_.objects.names;
  Rng rng = Rng::Stream(0, "check");
  std::vector<StartContents> possible;
  for (size_t target = 0; target < kinds.size(); ++target) {
    StartContents& contents = possible.emplace_back();
    for (size_t i = 0; i < kinds.size(); ++i) {
      const std::string& kind = kinds[(target + i) % kinds.size()];
      const std::string name = i == 0                  ? kTarget
                               : i <= kMostDistractors ? NameOfDistractor(i)
                                                       : kind;
      contents.objects.push_back(MakeCatalogueObject(kind, name, rng));
      contents.kinds.push_back(kind);
    }
  }
  return possible;
}

std::optional<Refusal> PickTaskSampler::ValidateBasePose(Scene& scene, Robot& robot,
                                                         const std::string& target_body) {
  if (auto refusal = StartSampler::ValidateBasePose(scene, robot, target_body)) return refusal;
  if (auto refusal = ValidateGrasps(scene, robot, target_body))
    return std::move(*refusal).MadeBy(Refusal::kTaskStage);
  return std::nullopt;
}

// Checks the same grasps as the PickPlanner, but not the path. A robot with a custom gripper comes
// with an expert of its own, which checks them itself.
std::optional<Refusal> PickTaskSampler::ValidateGrasps(const Scene& scene, const Robot& robot,
                                                       const std::string& target_body) {
  if (!robot.has_gripper() || !GripperShape::Supports(robot.gripper())) return std::nullopt;
  if (!shape()) shape() = GripperShape::Of(robot.config(), run().options, scene.timestep());
  PlanningScene planning(scene, robot, target_body, shape());
  std::vector<GraspCandidate> candidates =
      FindGrasps(planning.model(), planning.data(), planning.target_body(), planning.shape(),
                 robot.tcp_in_world());
  if (candidates.empty())
    return Refusal{Refusal::kNoGrasp,
                   "the object is too large, too small or too flat for the gripper: " +
                       SizesForGrasp(planning.model(), planning.data(), planning.target_body(),
                                     planning.shape())};
  const std::vector<double> home = robot.arm().joint_pos();
  GraspMotions motions(planning, std::move(candidates), JointVector(std::span<const double>(home)),
                       GraspMotionsToLift(pick_.lift_height));
  std::optional<Refusal> of_no_use;
  for (int i = 0; i < kMostGrasps; ++i) {
    const std::optional<GraspMotion> motion = motions.Next();
    if (!motion) break;
    of_no_use = ValidateGrasp(scene, planning, *motion);
    if (!of_no_use) return std::nullopt;
    planning.Update();
  }
  if (of_no_use) return of_no_use;
  return Refusal{
      motions.MostCollide() ? Refusal::kGraspsInCollision : Refusal::kNoReachableBasePose,
      "grasps: " + motions.Reasons()};
}

std::shared_ptr<Task> PickTaskSampler::MakeTask(const std::string& target, const std::string& kind,
                                                const std::vector<std::string>& objects) {
  return std::make_shared<PickTask>(target, kind, objects, pick_.lift_height);
}

namespace {

// The common part of the kinds pick and pick_and_place.
template <class Config, class T, class Sampler>
class KindOfPick : public TaskKindOf<Config, T> {
 public:
  std::shared_ptr<TaskSampler> MakeSampler(const RunConfig& run) const override {
    return std::make_shared<Sampler>(run);
  }
  std::string expert() const override { return Config::kKind; }
  bool is_built_in() const override { return true; }
  void ValidateRun(const RunConfig& run, Problems& problems) const override {
    ValidateKinds("task.objects", PickRunOf(run.task)->objects, ObjectKinds(), problems);
  }
  // Returns one object of each kind that may be drawn, named by its kind.
  std::vector<SceneObject> Contents(const RunConfig& run) const override {
    const NameList objects = PickRunOf(run.task)->objects;
    Rng rng = Rng::Stream(0, "check");
    std::vector<SceneObject> contents;
    for (const std::string& kind : objects.empty() ? ObjectKinds() : objects.names)
      contents.push_back(MakeCatalogueObject(kind, kind, rng));
    return contents;
  }
  std::string ReachAdvice(const RunConfig& run) const override {
    return robocell::internal::ReachAdvice(run);
  }

 protected:
  static void ValidateKinds(const char* field, const NameList& chosen,
                            const std::vector<std::string>& known, Problems& problems) {
    Problems::Scope scope(problems, field);
    for (size_t i = 0; i < chosen.size(); ++i) {
      if (std::ranges::find(known, chosen[i]) != known.end()) continue;
      Problems::Scope item(problems, i);
      problems.Add(NoSuchName("", "kind of object", chosen[i], known));
    }
  }
};

using PickKind = KindOfPick<PickTaskConfig, PickTask, PickTaskSampler>;

class PickAndPlaceKind final
    : public KindOfPick<PickAndPlaceTaskConfig, PickAndPlaceTask, internal::PickAndPlaceSampler> {
 public:
  void ValidateRun(const RunConfig& run, Problems& problems) const override {
    KindOfPick::ValidateRun(run, problems);
    ValidateKinds("task.goals", run.task.As<PickAndPlaceTaskConfig>().goals,
                  internal::AllGoalKinds(), problems);
  }
  std::vector<SceneObject> Contents(const RunConfig& run) const override {
    std::vector<SceneObject> contents = KindOfPick::Contents(run);
    Rng rng = Rng::Stream(0, "check");
    for (const std::string& kind : internal::GoalKindsOf(run.task.As<PickAndPlaceTaskConfig>())) {
      const auto same = [&](const SceneObject& object) { return object.name == kind; };
      if (std::ranges::none_of(contents, same))
        contents.push_back(internal::MakeGoalObject(kind, kind, rng));
    }
    return contents;
  }
};

}  // namespace

std::shared_ptr<const TaskKind> MakePickKind() { return std::make_shared<PickKind>(); }

std::shared_ptr<const TaskKind> MakePickAndPlaceKind() {
  return std::make_shared<PickAndPlaceKind>();
}

}  // namespace robocell
