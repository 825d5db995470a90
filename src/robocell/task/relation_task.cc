#include "robocell/task/relation_task.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/acting_arms.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/landmarks.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/furniture.h"
#include "robocell/task/handle_motion.h"
#include "robocell/task/held.h"
#include "robocell/task/held_paths.h"
#include "robocell/task/held_relation.h"
#include "robocell/task/pick_and_place_task.h"
#include "robocell/task/place_motion.h"
#include "robocell/task/push_motion.h"

namespace robocell {
namespace {

constexpr int kPlaces = 24;  // poses of a goal that are tried when a start is checked
constexpr const char* kHoldsAlready = "the goal holds already";
constexpr const char* kNoPlace = "the object cannot be put down at the goal";
constexpr const char* kNoStart = "no free place for the start";
constexpr double kPressed = 2e-4;  // m into the support: relations about contacts hold then
constexpr int kStartPoses = 16;    // poses of a start's relation that are tried

// Returns true if the object is in a hand when the relation holds.
bool IsOfHeldObject(const StatedRelation& stated) {
  return stated.relation == "held" || stated.relation == "handed_over";
}

bool IsJoint(const StatedRelation& stated) {
  return FindRelation(stated.relation).subject == RelationSubject::kJoint;
}

// Returns the body that moves freely with what a goal names, an object, a body, a geom or a site; -1
// if that stays in place.
int FreeBodyOf(const Scene& scene, const std::string& name) {
  const mjModel* m = scene.model();
  int body = internal::FindObjectOrBody(scene, name);
  const int geom = FindId(m, mjOBJ_GEOM, name), site = FindId(m, mjOBJ_SITE, name);
  if (body < 0 && geom >= 0) body = m->geom_bodyid[geom];
  if (body < 0 && site >= 0) body = m->site_bodyid[site];
  if (body <= 0) return -1;
  const int root = m->body_rootid[body];
  const bool is_free = m->body_jntnum[root] == 1 && m->jnt_type[m->body_jntadr[root]] == mjJNT_FREE;
  return is_free ? root : -1;
}

// Returns the root body of the object that a joint belongs to, else the root of its tree.
int RootOfJoint(const Scene& scene, const JointOpening& opening) {
  const mjModel* m = scene.model();
  for (const ObjectRecord& object : scene.compiled()->objects()) {
    const int root = FindId(m, mjOBJ_BODY, object.root_body);
    if (root > 0 && internal::IsInSubtree(m, opening.body_id(), root)) return root;
  }
  return m->body_rootid[opening.body_id()];
}

// Returns the relation of a placement (spec/object_place.h) that a sentence states; unset for
// another relation.
std::optional<ObjectPlace> PlaceOf(const StatedRelation& stated) {
  if (stated.relation == "on") return ObjectPlace{.on_top_of = stated.reference};
  if (stated.relation == "inside") return ObjectPlace{.inside = stated.reference};
  if (stated.relation == "next_to")
    return ObjectPlace{.next_to = stated.reference, .gap = {0, stated.numbers[0]}};
  return std::nullopt;
}

}  // namespace

RelationTask::RelationTask(double hold_seconds) : hold_seconds_(hold_seconds) {
  internal::RegisterTaskRelations();
}

void RelationTask::Prepare(SceneSpec& spec, Rng& rng) {
  names_.clear();
  kinds_.clear();
  AddObjects(spec, rng);
}

SceneObject& RelationTask::Add(SceneSpec& spec, const std::string& name, const std::string& kind,
                               Rng& rng) {
  SceneObject object = internal::IsFurniture(kind)
                           ? internal::PutFurniture(spec, annotations(), name, kind, rng)
                           : PickAndPlaceTask::MakeGoalObject(kind, name, rng);
  spec.objects.push_back(std::move(object));
  Name(name, kind);
  return spec.objects[spec.objects.size() - 1];
}

void RelationTask::Name(const std::string& object, const std::string& kind) {
  if (std::ranges::find(names_, object) == names_.end()) names_.push_back(object);
  kinds_[object] = kind;
}

void RelationTask::Bind(const Scene& scene, const TaskSetting& setting) {
  place_ = setting.place;
  is_run_ = setting.is_run;
  robots_.clear();
  for (const std::string& robot : setting.robots)
    robots_.push_back(Robot::Of(scene.inner(), robot));
  Found(scene, setting);
  BindGoals(scene);
}

void RelationTask::BindGoals(const Scene& scene) {
  goals_.clear();
  released_.clear();
  scene_.emplace(scene.inner());
  for (const std::string& text : StatedGoal()) {
    try {
      const StatedRelation stated = ParseRelation(text);
      goals_.push_back({.stated = stated,
                        .bound = BindRelation(scene, stated),
                        .is_momentary = FindRelation(stated.relation).is_momentary});
    } catch (const NotFoundError& error) {
      throw NotFoundError(fmt::format("{}: goal \"{}\": {}", place_, text, error.what()));
    } catch (const ArgumentError& error) {
      throw ArgumentError(fmt::format("{}: goal \"{}\": {}", place_, text, error.what()));
    }
  }
  // What is to be held is let go for no other goal.
  std::set<int> held, others;
  for (const Goal& goal : goals_) {
    if (IsJoint(goal.stated)) continue;
    const bool is_held = IsOfHeldObject(goal.stated);
    (is_held ? held : others).insert(FreeBodyOf(scene, goal.stated.subject));
    if (!goal.stated.reference.empty()) others.insert(FreeBodyOf(scene, goal.stated.reference));
  }
  for (const int body : others) {
    if (body < 0 || held.contains(body)) continue;
    released_.emplace_back(scene.inner(), ElementName(scene.model(), mjOBJ_BODY, body));
  }
}

Map<ObjectPlace> RelationTask::places() const {
  Map<ObjectPlace> places;
  for (const std::string& text : StatedStart()) {
    const StatedRelation stated = ParseRelation(text);
    if (const auto place = PlaceOf(stated)) places[stated.subject] = *place;
  }
  return places;
}

BaseRange RelationTask::base_range() const {
  return {.distance = {0.3, 0.5}, .height_offset = -0.25, .height_noise = {-0.1, 0.1}};
}

std::optional<Refusal> RelationTask::Arrange(Scene& scene, Rng& rng) {
  if (auto refusal = Draw(scene, rng)) return refusal;
  if (auto refusal = ApplyStart(scene, rng)) return refusal;
  BindGoals(scene);
  std::optional<Refusal> refusal;
  // A robot stands in front of a door that it opens.
  for (const Goal& goal : goals_) {
    if (!is_run_ || !IsJoint(goal.stated) || robots_.empty()) continue;
    const JointOpening opening = JointOpening::Of(scene, goal.stated.subject);
    const double share = goal.stated.relation == "pressed" ? 1 : internal::ShareFor(goal.stated);
    const auto check = [&] {  // one arm is enough
      std::optional<Refusal> refused;
      for (const Robot& robot : robots_) {
        std::optional<Refusal> by_this = internal::CheckJointGoal(scene, robot, goal.stated);
        if (!by_this) return by_this;
        if (!refused) refused = std::move(by_this);
      }
      return refused;
    };
    refusal = internal::StandInFront(scene, robots_.front(), RootOfJoint(scene, opening), opening,
                                     share, check, rng);
    // Another start may draw another joint.
    if (refusal && choices() > 1) refusal->holds_everywhere = false;
    break;
  }
  scene.Forward();
  return refusal;
}

// Puts joints and objects into the states of the start that no placement states.
std::optional<Refusal> RelationTask::ApplyStart(Scene& scene, Rng& rng) {
  moved_.clear();
  for (const std::string& text : StatedStart()) {
    const StatedRelation stated = ParseRelation(text);
    if (PlaceOf(stated)) continue;
    const std::unique_ptr<BoundRelation> bound = BindRelation(scene, stated);
    if (bound->Holds() && !IsJoint(stated)) continue;
    const bool is_joint = IsJoint(stated);
    if (IsOfHeldObject(stated) || stated.relation == "carried") {
      throw ArgumentError(
          fmt::format("{}: start \"{}\": '{}' cannot be a start; write it as a goal", place_, text,
                      stated.relation));
    }
    const RelationSamples samples = bound->Sample(rng, is_joint ? 1 : kStartPoses);
    if (is_joint) {
      if (!samples.joint) continue;
      JointOpening opening = JointOpening::Of(scene, stated.subject);
      opening.Put((*samples.joint - opening.closed()) / (opening.open() - opening.closed()));
      scene.Forward();
      continue;
    }
    const std::string body = ElementName(scene.model(), mjOBJ_BODY,
                                         internal::RequireObjectOrBody(scene, stated.subject));
    bool holds = false;
    for (const Pose& pose : samples.poses) {
      for (const double down : {0.0, kPressed}) {
        if (holds) continue;
        scene.SetBodyPose(body, Pose(Eigen::Vector3d(0, 0, -down)) * pose);
        scene.Forward();
        holds = bound->Holds();
      }
    }
    if (!holds)
      return Refusal{.reason = kNoStart,
                     .detail = fmt::format("start \"{}\": none of {} poses is free", text,
                                           samples.poses.size())};
    moved_.push_back(stated.subject);
  }
  return std::nullopt;
}

std::optional<Refusal> RelationTask::CheckStart(const Scene& scene) {
  const bool done =
      std::ranges::all_of(goals_, [](const Goal& goal) { return goal.bound->Holds(); });
  if (done) return Refusal{.reason = kHoldsAlready, .detail = instruction()};
  for (const Goal& goal : goals_) {
    if (goal.bound->Holds()) continue;
    std::optional<Refusal> refusal =
        CheckGoal(scene, goal);  // later ones depend on what it changes
    // Another start may draw another joint.
    if (refusal && choices() > 1) refusal->holds_everywhere = false;
    return refusal;
  }
  return std::nullopt;
}

std::optional<Refusal> RelationTask::CheckGoal(const Scene& scene, const Goal& goal) {
  std::optional<Refusal> refused;
  for (const Robot& robot : robots_) {
    std::optional<Refusal> refusal;
    if (IsJoint(goal.stated)) {
      refusal = internal::CheckJointGoal(scene, robot, goal.stated);
    } else if (pushes()) {
      Rng rng = Rng::Stream(0, "places of a goal", goal.stated.subject);
      const std::vector<Pose> poses = goal.bound->Sample(rng, 1).poses;
      if (poses.empty()) return Refusal{kNoPlace, "no pose in the region is free"};
      refusal = internal::CheckPush(scene, robot, goal.stated.subject,
                                    poses.front().translation().head<2>());
    } else if (goal.stated.relation != "upright" && goal.stated.relation != "carried") {
      const int body = internal::RequireObjectOrBody(scene, goal.stated.subject);
      Rng rng = Rng::Stream(0, "places of a goal", goal.stated.subject);
      std::vector<Pose> poses = goal.bound->Sample(rng, kPlaces).poses;
      const bool is_moved = internal::HasHeldPaths(goal.stated);
      const bool is_put_down = !IsOfHeldObject(goal.stated);
      if (is_put_down && !is_moved && poses.empty())
        return Refusal{kNoPlace, fmt::format("no pose with \"{}\" is free", TextOf(goal.stated))};
      for (Pose& pose : poses) pose = Pose(PlaceOver(pose.translation()), pose.quaternion());
      const auto refuse = [&](PlanningScene& planning,
                              const GraspMotion& motion) -> std::optional<Refusal> {
        if (!is_put_down) return std::nullopt;
        if (is_moved)
          return internal::CheckHeldPaths(scene, goal.stated, *goal.bound, planning, motion);
        const Pose object = scene.body_pose(ElementName(scene.model(), mjOBJ_BODY, body));
        PlaceMotions motions(planning, motion.grasp.tcp_in_world.inverse() * object, poses,
                             motion.up.back(), {.gap = motion.grasp.width});
        if (motions.Next()) return std::nullopt;
        return Refusal{kNoPlace, motions.Reasons()};
      };
      refusal = grasps_[internal::ActingName(robot)].Check(
          scene, robot, ElementName(scene.model(), mjOBJ_BODY, body), 0.05, refuse, is_moved);
    }
    if (!refusal) return std::nullopt;  // one robot is enough
    if (!refused) refused = std::move(refusal);
  }
  return refused;
}

void RelationTask::Begin(const Scene& scene) {
  if (goals_.empty()) {
    Bind(scene, {.place = "scene '" + scene.name() + "'", .robots = internal::ActingArms(scene)});
  }
  since_ = -1;
  for (Goal& goal : goals_) {
    goal.has_held = false;
    goal.bound->Recall(std::vector<double>(goal.bound->memory().size(), 0));
  }
}

bool RelationTask::IsReleased(const Scene& scene) const {
  return std::ranges::none_of(released_, [&](const BodyHandle& body) {
    return internal::TouchingBody(scene, body.name()).robot;
  });
}

TaskVerdict RelationTask::Judge(const Scene& scene) {
  TaskVerdict verdict{.subtask = static_cast<int>(goals_.size()) - 1};
  double progress = 0;
  bool all = true;
  for (size_t i = 0; i < goals_.size(); ++i) {
    Goal& goal = goals_[i];
    goal.bound->Watch();
    const bool holds = goal.bound->Holds();
    if (goal.is_momentary) goal.has_held = goal.has_held || holds;
    progress += goal.Holds() ? 1 : 0.9 * goal.bound->Progress();
    if (!goal.Holds() && all) verdict.subtask = static_cast<int>(i);
    all = all && goal.Holds();
  }
  all = all && IsReleased(scene);
  if (!all)
    since_ = -1;
  else if (since_ < 0)
    since_ = scene.time();
  constexpr double kRounding = 1e-9;
  verdict.success = all && scene.time() - since_ >= hold_seconds_ - kRounding;
  verdict.progress = progress / static_cast<double>(goals_.size());
  if (!verdict.success) verdict.progress = std::min(verdict.progress, 0.99);
  verdict.reward = verdict.progress;
  return verdict;
}

std::string RelationTask::Word(const std::string& name) const {
  if (const std::string word = WordFor(name); !word.empty()) return word;
  const auto kind = kinds_.find(name);
  std::string word = kind == kinds_.end() ? name : kind->second;
  // A word that several objects share says nothing: their names tell them apart.
  const auto same = std::ranges::count_if(kinds_, [&](const auto& e) { return e.second == word; });
  if (kind != kinds_.end() && same > 1) word = name;
  std::ranges::replace(word, '_', ' ');
  return word;
}

std::string RelationTask::instruction() const {
  std::string text;
  for (const std::string& sentence : subtasks()) text += (text.empty() ? "" : " and ") + sentence;
  return text;
}

std::vector<std::string> RelationTask::subtasks() const {
  std::vector<std::string> names;
  for (const std::string& text : StatedGoal()) {
    const StatedRelation stated = ParseRelation(text);
    names.push_back(WordsOf(stated, Word(stated.subject), Word(stated.reference)));
  }
  return names;
}

std::string RelationTask::kind_of(const std::string& object) const {
  const auto kind = kinds_.find(object);
  return kind == kinds_.end() ? object : kind->second;
}

std::vector<std::string> RelationTask::resting_objects() const { return moved_; }

std::string RelationTask::why_not_done() const {
  for (const Goal& goal : goals_) {
    if (!goal.Holds()) return "not done: " + TextOf(goal.stated);
  }
  return "not let go";
}

std::vector<double> RelationTask::memory() const {
  std::vector<double> memory = {since_, static_cast<double>(chosen())};
  for (const Goal& goal : goals_) memory.push_back(goal.has_held ? 1 : 0);
  for (const Goal& goal : goals_) {
    const std::vector<double> own = goal.bound->memory();
    memory.insert(memory.end(), own.begin(), own.end());
  }
  return memory;
}

std::string RelationTask::WhyNotRecalled(std::span<const double> memory) const {
  if (!std::isfinite(memory[0]))
    return fmt::format("number 0, the time at which the goal began to hold, is {:g}; it is finite",
                       memory[0]);
  for (size_t i = 2; i < memory.size(); ++i) {
    if (memory[i] != 0 && memory[i] != 1)
      return fmt::format("number {}, what a goal remembers, is {:g}; it is 0 or 1", i, memory[i]);
  }
  const double choice = memory[1];
  if (choice >= 0 && choice < static_cast<double>(choices()) && choice == std::floor(choice))
    return "";
  return fmt::format(
      "number 1, what the start has drawn, is {:g}; it is a whole number from 0 to {}", choice,
      choices() - 1);
}

void RelationTask::Recall(std::span<const double> memory) {
  since_ = memory[0];
  Choose(static_cast<size_t>(memory[1]));
  if (scene_) BindGoals(Scene(*scene_));
  size_t next = 2 + goals_.size();
  // The relations of what was chosen may remember more or less than those before.
  if (const size_t own = this->memory().size(); memory.size() != own)
    throw ArgumentError(
        fmt::format("{}: the memory has {} numbers, and the goal of what the start has drawn "
                    "remembers {}; restore a state that this task has saved",
                    place_, memory.size(), own));
  for (size_t i = 0; i < goals_.size(); ++i) {
    goals_[i].has_held = memory[2 + i] != 0;
    const size_t own = goals_[i].bound->memory().size();
    goals_[i].bound->Recall(memory.subspan(next, own));
    next += own;
  }
}

}  // namespace robocell
