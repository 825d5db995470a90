#include "robocell/task/pick_and_place_sampler.h"

#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/task/place_motion.h"

namespace robocell::internal {
namespace {

constexpr const char* kGoal = "goal";  // its name in the scene
constexpr const char* kTray = "tray";

}  // namespace

std::vector<std::string> GoalKindsOf(const PickAndPlaceTaskConfig& task) {
  return task.goals.empty() ? std::vector<std::string>{kTray} : task.goals.names;
}

std::vector<std::string> AllGoalKinds() {
  std::vector<std::string> kinds = ObjectKinds();
  const std::vector<std::string> equipment = assets::BuiltinEquipment();
  kinds.insert(kinds.end(), equipment.begin(), equipment.end());
  return kinds;
}

SceneObject MakeGoalObject(const std::string& kind, const std::string& name, Rng& rng) {
  const std::vector<std::string> equipment = assets::BuiltinEquipment();
  if (std::ranges::find(equipment, kind) != equipment.end())
    return {.name = name, .mjcf_path = kind, .fixed = false};
  const std::vector<std::string> all = AllGoalKinds();
  if (std::ranges::find(all, kind) != all.end()) return MakeCatalogueObject(kind, name, rng);
  throw NotFoundError(NoSuchName("task.goals", "kind", kind, all));
}

PickAndPlaceSampler::PickAndPlaceSampler(const RunConfig& run)
    : PickTaskSampler(run), task_(run.task.As<PickAndPlaceTaskConfig>()) {}

// Adds the target, the goal, and the other objects.
StartContents PickAndPlaceSampler::AddContents(const SampleRequest& request, SceneSpec& spec,
                                               Rng& rng) {
  StartContents contents = PickTaskSampler::AddContents(request, spec, rng);
  const std::vector<std::string> kinds = GoalKindsOf(task_);
  goal_kind_ = kinds[rng.UniformInt(kinds.size())];
  const SceneObject goal = MakeGoalObject(goal_kind_, kGoal, rng);
  const size_t first = spec.objects.size() - contents.objects.size();
  spec.objects.push_back(goal);
  contents.objects.insert(contents.objects.begin() + 1, goal);
  contents.kinds.insert(contents.kinds.begin() + 1, goal_kind_);
  for (size_t i = 0; i < contents.objects.size(); ++i)
    spec.objects[first + i] = contents.objects[i];
  return contents;
}

bool PickAndPlaceSampler::MayHaveObject(const std::string& name) const {
  const std::vector<std::string> goals = GoalKindsOf(task_);
  return PickTaskSampler::MayHaveObject(name) || std::ranges::find(goals, name) != goals.end();
}

std::vector<StartContents> PickAndPlaceSampler::PossibleContents(int scene_index) {
  const std::vector<std::string> goals = GoalKindsOf(task_);
  const std::vector<StartContents> picks = PickTaskSampler::PossibleContents(scene_index);
  Rng rng = Rng::Stream(0, "check");
  std::vector<StartContents> possible;
  for (size_t i = 0; i < std::max(goals.size(), picks.size()); ++i) {
    StartContents& contents = possible.emplace_back(picks[i % picks.size()]);
    const std::string& goal = goals[i % goals.size()];
    contents.objects.insert(contents.objects.begin() + 1, MakeGoalObject(goal, kGoal, rng));
    contents.kinds.insert(contents.kinds.begin() + 1, goal);
  }
  return possible;
}

std::shared_ptr<Task> PickAndPlaceSampler::MakeTask(const std::string& target,
                                                    const std::string& kind,
                                                    const std::vector<std::string>& objects) {
  made_task_ =
      std::make_shared<PickAndPlaceTask>(task_, PickAndPlaceTask::Objects{.object = target,
                                                                          .kind = kind,
                                                                          .goal_object = kGoal,
                                                                          .goal_kind = goal_kind_,
                                                                          .all = objects});
  return made_task_;
}

std::optional<Refusal> PickAndPlaceSampler::ValidateBasePose(Scene& scene, Robot& robot,
                                                             const std::string& target_body) {
  if (auto refusal = PickTaskSampler::ValidateBasePose(scene, robot, target_body)) return refusal;
  made_task_->Begin(scene);
  const Eigen::Vector3d way =
      made_task_->GoalInWorld() - scene.body_pose(target_body).translation();
  if (way.head<2>().norm() >= task_.goal_distance) return std::nullopt;
  return Refusal{Refusal::kNoFreePlace, "the object lies nearer to its goal than goal_distance"}
      .MadeBy(Refusal::kTaskStage);
}

std::optional<Refusal> PickAndPlaceSampler::ValidateGrasp(const Scene& scene,
                                                          PlanningScene& planning,
                                                          const GraspMotion& motion) {
  made_task_->Begin(scene);
  const int body = planning.target_body();
  const Pose object = Pose::FromTranslationAndMatrix(planning.data()->xpos + 3 * body,
                                                     planning.data()->xmat + 9 * body);
  PlaceMotions places(planning, motion.grasp.tcp_in_world.inverse() * object,
                      PosesAbout(PlaceOver(made_task_->GoalInWorld()), object), motion.up.back(),
                      {.gap = motion.grasp.width});
  if (places.Next()) return std::nullopt;
  return Refusal{Refusal::kNoWayToPlace, places.Reasons()};
}

}  // namespace robocell::internal
