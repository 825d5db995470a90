#include "robocell/task/pick_and_place_task.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/drawn_objects.h"
#include "robocell/task/grasp_candidates.h"
#include "robocell/task/held.h"
#include "robocell/task/place_motion.h"
#include "robocell/task/resting_place.h"

namespace robocell {
namespace {

constexpr double kRestSpeed = 0.02;  // m/s
constexpr double kRestTurn = 0.2;    // rad/s
constexpr int kTries = 1000;
constexpr const char* kTray = "tray";
// Reasons of refusals.
const std::string kNotAtGoal = "the object cannot be put down at the goal";
const std::string kNotOnThe = "the object cannot be put down on the ";  // kind of the goal object
constexpr const char* kNoRest = "the object cannot come to rest at the goal";

std::vector<std::string> NamedObjects(const PickAndPlaceTaskConfig& fields) {
  std::vector<std::string> objects;
  if (!fields.object.empty()) objects.push_back(fields.object);
  if (!fields.goal_object.empty()) objects.push_back(fields.goal_object);
  return objects;
}

}  // namespace

std::vector<std::string> PickAndPlaceTask::GoalKindsOf(const PickAndPlaceTaskConfig& task) {
  return task.goals.empty() ? std::vector<std::string>{kTray} : ObjectKindsOf(task.goals.names);
}

std::vector<std::string> PickAndPlaceTask::AllGoalKinds() {
  std::vector<std::string> kinds = ObjectKinds();
  const std::vector<std::string> equipment = assets::BuiltinEquipment();
  kinds.insert(kinds.end(), equipment.begin(), equipment.end());
  return kinds;
}

SceneObject PickAndPlaceTask::MakeGoalObject(const std::string& kind, const std::string& name,
                                             Rng& rng) {
  const std::vector<std::string> equipment = assets::BuiltinEquipment();
  if (std::ranges::find(equipment, kind) != equipment.end())
    return {.name = name, .mjcf_path = kind, .fixed = false};
  const std::vector<std::string> all = AllGoalKinds();
  if (std::ranges::find(all, kind) != all.end()) return MakeCatalogueObject(kind, name, rng);
  throw NotFoundError(NoSuchName("task.goals", "kind", kind, all));
}

PickAndPlaceTask::PickAndPlaceTask(const PickAndPlaceTaskConfig& fields)
    : ObjectTask({.name = fields.object,
                  .lift_height = fields.lift_height,
                  .spread = fields.spread,
                  .rotate = fields.rotate,
                  .refer = fields.refer,
                  .kinds = fields.objects.names,
                  .all = NamedObjects(fields)}),
      task_(fields),
      draws_goal_(!fields.goal && fields.goal_object.empty()),
      goal_word_(fields.goal_object) {}

void PickAndPlaceTask::Prepare(SceneSpec& spec, Rng& rng) {
  ObjectTask::Prepare(spec, rng);
  if (!draws_goal()) {
    if (has_goal_object()) Observed(task_.goal_object, task_.goal_object);
    return;
  }
  const std::vector<std::string> kinds = GoalKindsOf(task_);
  if (is_prepared_once()) {
    for (const std::string& kind : kinds) {
      const std::string name = internal::NameOfDrawn(internal::kGoal, kind, kinds);
      spec.objects.push_back(MakeGoalObject(kind, name, rng));
      Observed(name, kind);
    }
    return;
  }
  goal_word_ = kinds[rng.UniformInt(kinds.size())];
  task_.goal_object = internal::kGoal;
  AddDrawn(spec, MakeGoalObject(goal_word_, internal::kGoal, rng), goal_word_);
}

std::vector<StartContents> PickAndPlaceTask::WithGoals(const std::vector<StartContents>& picks,
                                                       const std::vector<std::string>& goals) {
  Rng rng = Rng::Stream(0, "check");
  std::vector<StartContents> possible;
  for (size_t i = 0; i < std::max(goals.size(), picks.size()); ++i) {
    StartContents& contents = possible.emplace_back(picks[i % picks.size()]);
    const std::ptrdiff_t after_target = contents.objects.empty() ? 0 : 1;
    const std::string& goal = goals[i % goals.size()];
    contents.objects.insert(contents.objects.begin() + after_target,
                            MakeGoalObject(goal, internal::kGoal, rng));
    contents.kinds.insert(contents.kinds.begin() + after_target, goal);
  }
  return possible;
}

// Another task of the same fields prepared the scene.
void PickAndPlaceTask::FindGoals(const Scene& scene, const TaskSetting& setting) {
  goals_.clear();
  for (auto& [name, kind] :
       internal::DrawnObjects(scene, setting, internal::kGoal, GoalKindsOf(task_))) {
    goals_.push_back({name, kind, BodyHandle(scene, scene.compiled()->object(name).root_body)});
    ObservedAs(internal::kGoal, name, kind);
  }
  if (goals_.empty()) {
    throw ArgumentError(
        fmt::format("{}: the scene has no goal object of the task; set task.goal, where the object "
                    "is to be put, or task.goal_object, or let the task prepare the scene",
                    place()));
  }
  ChooseGoal(0);
}

void PickAndPlaceTask::ChooseGoal(size_t candidate) {
  const GoalCandidate& goal = goals_.at(candidate);
  chosen_goal_ = candidate;
  task_.goal_object = goal.name;
  goal_word_ = goal.kind;
  goal_body_ = goal.body;
  Stand(internal::kGoal, goal.name);
}

void PickAndPlaceTask::Bind(const Scene& scene, const TaskSetting& setting) {
  ObjectTask::Bind(scene, setting);
  if (task_.goal && !has_goal_object()) {
    goal_offset_ = Pose(ToEigen(*task_.goal));
    goal_ = goal_offset_.translation();
    return;
  }
  if (draws_goal() && (is_prepared_once() || !has_goal_object() || !goals_.empty()))
    return FindGoals(scene, setting);
  Observed(task_.goal_object, goal_word_);
  const std::string& id = task_.goal_object;
  const ObjectRecord& object = scene.compiled()->object(id);
  goal_body_.emplace(scene, object.root_body);
  const auto offset = setting.objects.find(id);
  goal_offset_ = offset == setting.objects.end() ? root().inverse() * goal_body_->pose_in_world()
                                                 : offset->second;
  if (object.free_joint || task_.goal_spread == Vec2{0, 0}) return;
  throw ArgumentError(
      fmt::format("{}: task.goal_spread moves task.goal_object '{}', which is fixed; set fixed: "
                  "false in {}, or "
                  "leave goal_spread out",
                  place(), id, setting.is_run ? "its scene" : "root_frame_objects." + id));
}

// The stages of the start place what is drawn; the rest is put here. CheckStart compares their
// distance.
BodyPoses PickAndPlaceTask::Starts(Rng& rng) {
  DrawTarget(rng);
  if (!goals_.empty()) ChooseGoal(rng.UniformInt(goals_.size()));
  const bool moves_goal = !draws_goal() && task_.goal_spread != Vec2{0, 0};
  const Pose goal_in_object = has_goal_object() && task_.goal ? Pose(ToEigen(*task_.goal)) : Pose();
  for (int i = 0; i < kTries; ++i) {
    BodyPoses starts;
    Eigen::Vector3d start = Eigen::Vector3d::Zero(), goal = start;
    if (!draws_objects()) {
      const Pose pose = Start(rng);
      start = pose.translation();
      starts.emplace_back(object().name(), root() * pose);
    }
    if (!draws_goal()) {
      const Pose pose = Around(goal_offset_, task_.goal_spread, rng);
      goal = (pose * goal_in_object).translation();
      if (has_goal_object() && moves_goal) starts.emplace_back(goal_body_->name(), root() * pose);
    }
    if (is_named() && (goal - start).head<2>().norm() < task_.goal_distance) continue;
    if (!has_goal_object()) goal_ = goal;
    return starts;
  }
  throw ArgumentError(
      fmt::format("{}: in {} tries '{}' was never {:g} m from its goal; widen task.spread or "
                  "task.goal_spread, or lower task.goal_distance",
                  place(), kTries, task_.object, task_.goal_distance));
}

std::optional<Refusal> PickAndPlaceTask::Arrange(Scene& scene, Rng& rng) {
  if (auto refusal = ObjectTask::Arrange(scene, rng)) return refusal;
  if (!draws_goal()) {
    if (auto refusal = CheckPossible(scene)) return refusal;
  }
  return CheckDrawnGoal(scene);
}

std::optional<Refusal> PickAndPlaceTask::CheckStart(const Scene& scene) {
  if (auto refusal = ObjectTask::CheckStart(scene)) return refusal;
  if (is_named()) return std::nullopt;  // Starts keeps the distance
  Begin(scene);
  const Eigen::Vector3d displacement = GoalInWorld() - ObjectInWorld();
  if (displacement.head<2>().norm() >= task_.goal_distance) return std::nullopt;
  return Refusal{Refusal::kNoFreePlace, "the object lies nearer to its goal than goal_distance"};
}

std::optional<Refusal> PickAndPlaceTask::RefuseGrasp(const Scene& scene, PlanningScene& planning,
                                                     const GraspMotion& motion) {
  Begin(scene);
  const int body = planning.target_body();
  const Pose object = Pose::FromTranslationAndMatrix(planning.data()->xpos + 3 * body,
                                                     planning.data()->xmat + 9 * body);
  const Eigen::Vector3d rest = GoalInWorld() + RiseOverGoal(scene) * Eigen::Vector3d::UnitZ();
  PlaceMotions places(planning, motion.grasp.tcp_in_world.inverse() * object,
                      PosesAbout(PlaceOver(rest), object), motion.up.back(),
                      {.gap = motion.grasp.width});
  if (places.Next()) return std::nullopt;
  return Refusal{has_goal_object() ? kNotOnThe + goal_word_ : kNotAtGoal,
                 places.Reasons() + WhyTooLow(scene)};
}

// Returns the height of the object's root over its lowest point, as it lies now.
double PickAndPlaceTask::HeightOfRoot(const Scene& scene) const {
  double bottom = std::numeric_limits<double>::infinity();
  for (const int g : internal::CollisionGeomsOf(scene.model(), object().id())) {
    bottom = std::min(
        bottom,
        internal::GeomExtent(scene.model(), scene.data(), g, Eigen::Vector3d::UnitZ()).lower);
  }
  return ObjectInWorld().z() - bottom;
}

// Returns how far the object would be inside its support at a goal that is a place.
std::optional<PickAndPlaceTask::GoalInside> PickAndPlaceTask::InsideAtGoal(
    const Scene& scene) const {
  constexpr double kInside = 1e-3;  // m
  if (!task_.goal || has_goal_object()) return std::nullopt;
  const GoalInside heights{
      .root = HeightOfRoot(scene),
      .goal = internal::HeightOverSupport(scene, GoalInWorld(), object().id())};
  if (!std::isfinite(heights.goal) || !std::isfinite(heights.root) ||
      heights.goal > heights.root - kInside)
    return std::nullopt;
  return heights;
}

double PickAndPlaceTask::RiseOverGoal(const Scene& scene) const {
  const std::optional<GoalInside> inside = InsideAtGoal(scene);
  const double rise = inside ? inside->root - inside->goal : 0;
  return rise <= task_.goal_tolerance ? rise : 0;
}

// Returns the end of a message about a goal at which the object would be inside its support; "" for
// other goals.
std::string PickAndPlaceTask::WhyTooLow(const Scene& scene) const {
  const std::optional<GoalInside> inside = InsideAtGoal(scene);
  if (!inside) return "";
  return fmt::format(
      "; task.goal is where the root of the object comes to rest: it is {:.3f} m over what is "
      "under "
      "it, and the root of '{}' rests {:.3f} m over its support",
      inside->goal, object().name(), inside->root);
}

std::vector<std::string> PickAndPlaceTask::resting_objects() const {
  std::vector<std::string> resting = ObjectTask::resting_objects();
  if (!draws_goal() && has_goal_object() && task_.goal_spread != Vec2{0, 0})
    resting.push_back(task_.goal_object);
  return resting;
}

// A goal given as a place is equally high above its support wherever it is drawn, unless the
// support ends there or something lies on it.
std::optional<Refusal> PickAndPlaceTask::CheckDrawnGoal(const Scene& scene) const {
  if (has_goal_object() || task_.goal_spread == Vec2{0, 0}) return std::nullopt;
  const int own = object().id();
  const double meant = internal::HeightOverSupport(scene, root() * goal_offset_.translation(), own);
  const double drawn = internal::HeightOverSupport(scene, GoalInWorld(), own);
  if (!std::isfinite(meant) || std::abs(drawn - meant) <= task_.goal_tolerance) return std::nullopt;
  return Refusal{.reason = "the goal that was drawn is not on what is under task.goal",
                 .detail = std::isfinite(drawn)
                               ? fmt::format("it is {:.2f} m too {}", std::abs(drawn - meant),
                                             drawn > meant ? "high" : "low")
                               : "nothing is under it"};
}

// Returns the possible goals of this start and of others, in the frame of goal_.
std::vector<Eigen::Vector3d> PickAndPlaceTask::PossibleGoals() const {
  std::vector<Eigen::Vector3d> goals = {goal_};
  if (has_goal_object()) return goals;  // the place of the goal object does not matter
  const Vec2& spread = task_.goal_spread;
  for (const int x : {-1, 0, 1}) {
    for (const int y : {-1, 0, 1})
      goals.emplace_back(goal_offset_.translation() +
                         Eigen::Vector3d(x * spread[0], y * spread[1], 0));
  }
  if (spread == Vec2{0, 0}) goals.resize(1);
  return goals;
}

std::string PickAndPlaceTask::GoalText() const {
  return task_.goal ? fmt::format("task.goal [{}]", fmt::join(*task_.goal, ", "))
                    : fmt::format("the goal on top of '{}'", task_.goal_object);
}

std::string PickAndPlaceTask::WhyGoalOutOfReach(const Scene& scene) const {
  const double spread = 2 * std::hypot(task_.goal_spread[0], task_.goal_spread[1]);
  const double slack =
      internal::RadiusOf(scene.model(), object().id()) + task_.goal_tolerance + spread;
  const Eigen::Vector3d at = GoalInWorld();
  return WhyOutOfReach(robots(), at, at.z(), slack);
}

// Drawn objects that are not the target may lie at the goal now, and elsewhere in the next start.
std::string PickAndPlaceTask::WhyNoRest(const Scene& scene, const std::string& object) const {
  const auto body_of = [&](const std::string& name) {
    return FindId(scene.model(), mjOBJ_BODY, scene.compiled()->object(name).root_body);
  };
  std::vector<int> beside;
  for (const std::string& other : all_objects()) {
    if (other != object && other != task_.goal_object) beside.push_back(body_of(other));
  }
  std::vector<internal::RestPlace> places;
  for (const Eigen::Vector3d& at : PossibleGoals()) {
    places.push_back(has_goal_object() ? internal::RestPlace{goal_body_->id(), at}
                                       : internal::RestPlace{0, root() * at});
  }
  return internal::WhyNoRest(scene, body_of(object), places, task_.goal_tolerance, beside);
}

std::optional<Refusal> PickAndPlaceTask::CheckPossible(const Scene& scene) {
  Begin(scene);
  if (is_possible_) return std::nullopt;
  if (const std::string why = WhyGoalOutOfReach(scene); !why.empty()) {
    throw ArgumentError(fmt::format(
        "{}: {} is out of reach: {}. Move the goal or the robot (robot_to_shared_base_frame)",
        place(), GoalText(), why));
  }
  // The goal on top of an object depends on what is put there.
  const std::vector<std::string> targets =
      task_.goal ? ObjectTask::resting_objects() : std::vector<std::string>{fields().name};
  for (const std::string& target : targets) {
    const std::string why = WhyNoRest(scene, target);
    if (why.empty()) continue;
    // The next start of a run has another object.
    if (is_run() && draws_objects())
      return Refusal{.reason = kNoRest, .detail = why, .holds_everywhere = true};
    throw ArgumentError(fmt::format(
        "{}: '{}' cannot come to rest at {}: {}. Give the position of its root at rest there, "
        "within task.goal_tolerance ({:g} m){}{}",
        place(), target, GoalText(), why, task_.goal_tolerance,
        has_goal_object() ? ", in the frame of '" + task_.goal_object + "'" : "",
        draws_objects() ? ", which fits the height of each kind of task.objects" : ""));
  }
  is_possible_ = true;
  return std::nullopt;
}

void PickAndPlaceTask::Begin(const Scene& scene) {
  ObjectTask::Begin(scene);
  was_lifted_ = false;
  if (has_goal_object()) goal_ = task_.goal ? ToEigen(*task_.goal) : TopOfGoalObject(scene);
}

// Returns where the object's root is when the object lies in the middle on top of goal_object, in
// its present orientation.
Eigen::Vector3d PickAndPlaceTask::TopOfGoalObject(const Scene& scene) const {
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  const auto extent = [&](int geom) {
    return internal::GeomExtent(m, d, geom, Eigen::Vector3d::UnitZ());
  };
  double top = -std::numeric_limits<double>::infinity();
  const double height = HeightOfRoot(scene);
  const std::vector<int> geoms = internal::CollisionGeomsOf(m, goal_body_->id());
  for (const int g : geoms) top = std::max(top, extent(g).upper);
  if (!std::isfinite(height) || !std::isfinite(top)) {
    throw ArgumentError(fmt::format(
        "{}: '{}' cannot be put on '{}', since one of them has no shape that collides; set "
        "task.goal, where it is to rest in the frame of '{}'",
        place(), object().name(), goal_body_->name(), goal_body_->name()));
  }
  const Pose goal_object = goal_body_->pose_in_world();
  Eigen::Vector3d at = goal_object.translation();
  at.z() = top + 1;
  const double below = internal::CastRay(m, d, geoms, at, -Eigen::Vector3d::UnitZ()).distance;
  if (std::isfinite(below)) top = at.z() - below;  // a tray's floor is below its rims
  at.z() = top + height;
  return goal_object.inverse() * at;
}

Eigen::Vector3d PickAndPlaceTask::GoalInWorld() const {
  return has_goal_object() ? goal_body_->pose_in_world() * goal_ : root() * goal_;
}

// The object is a free body.
bool PickAndPlaceTask::IsAtRest(const Scene& scene) const {
  const int dof = scene.model()->body_dofadr[object().id()];
  const Eigen::Map<const Eigen::Matrix<double, 6, 1>> v(scene.data()->qvel + dof);
  return v.head<3>().norm() < kRestSpeed && v.tail<3>().norm() < kRestTurn;
}

bool PickAndPlaceTask::IsPutDown(const Scene& scene) const {
  if ((ObjectInWorld() - GoalInWorld()).norm() > task_.goal_tolerance) return false;
  const internal::Touching touching = internal::TouchingBody(scene, object().name());
  return touching.other && !touching.robot && IsAtRest(scene);
}

bool PickAndPlaceTask::IsDone(const Scene& scene) {
  was_lifted_ = was_lifted_ || IsLifted(scene);
  return was_lifted_ && IsPutDown(scene);
}

double PickAndPlaceTask::Progress() const {
  const double carried = was_lifted_ ? Near((ObjectInWorld() - GoalInWorld()).norm()) : 0;
  return 0.25 * Nearness() + 0.25 * (was_lifted_ ? 1 : Lifted()) + 0.5 * carried;
}

std::string PickAndPlaceTask::instruction() const {
  // A kind is put into words; an object of the scene keeps the name that the user gave it.
  const std::string goal = draws_goal_ ? WordOfKind(goal_word_) : goal_word_;
  return fmt::format("pick up {} and put it {}", phrase(),
                     has_goal_object() ? "on the " + goal : "down at the goal");
}

std::vector<Feature> PickAndPlaceTask::signals() const {
  return {internal::PlaceFeature("goal", "Where the object is to be put.")};
}

void PickAndPlaceTask::Observe(const Scene& scene, std::span<double> out) const {
  const Eigen::Vector3d goal = scene.shared_base_frame_to_world().inverse() * GoalInWorld();
  std::copy_n(goal.data(), 3, out.begin());
}

std::vector<double> PickAndPlaceTask::memory() const {
  std::vector<double> memory = ObjectTask::memory();
  memory.insert(memory.end(), {goal_.x(), goal_.y(), goal_.z(), was_lifted_ ? 1.0 : 0.0});
  if (!goals_.empty()) memory.push_back(static_cast<double>(chosen_goal_));
  return memory;
}

std::string PickAndPlaceTask::WhyNotRecalled(std::span<const double> memory) const {
  if (std::string why = ObjectTask::WhyNotRecalled(memory); !why.empty()) return why;
  const size_t first = ObjectTask::memory().size();  // those of the goal, and what was lifted
  for (size_t i = first; i < first + 4; ++i) {
    if (std::isfinite(memory[i])) continue;
    return fmt::format("number {}, of the goal, is {:g}; it is finite", i, memory[i]);
  }
  if (goals_.empty()) return "";
  return WhyNoIndex(memory, first + 4, "which object is the goal", goals_.size());
}

void PickAndPlaceTask::Recall(std::span<const double> memory) {
  ObjectTask::Recall(memory);
  const std::span<const double> own = memory.subspan(ObjectTask::memory().size());
  goal_ = {own[0], own[1], own[2]};
  was_lifted_ = own[3] != 0;
  if (!goals_.empty()) ChooseGoal(static_cast<size_t>(own[4]));
}

}  // namespace robocell
