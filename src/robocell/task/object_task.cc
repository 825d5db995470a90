#include "robocell/task/object_task.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/acting_arms.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/referral.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/drawn_objects.h"
#include "robocell/task/held.h"
#include "robocell/task/run_arms.h"

namespace robocell {

namespace {

constexpr size_t kMostBeside = 2;  // objects beside the target

// Returns the name of a drawn object in the scene of a run; number 0 is the target.
std::string NameInRun(size_t i) { return i == 0 ? internal::kTarget : fmt::format("object_{}", i); }

}  // namespace

double Near(double distance) {
  constexpr double kReachScale = 5;  // 1/m
  return 1 - std::tanh(kReachScale * distance);
}

ObjectTask::ObjectTask(ObjectOfTask object)
    : fields_(std::move(object)),
      draws_objects_(fields_.name.empty()),
      all_(fields_.all.value_or(std::vector<std::string>{fields_.name})) {
  if (draws_objects_) all_.clear();
  fields_.kinds = ObjectKindsOf(fields_.kinds);
}

std::vector<std::string> ObjectTask::ChooseKinds(Rng& rng) {
  if (is_prepared_once()) {
    if (!fields_.kinds.empty()) return fields_.kinds;
    std::vector<std::string> kinds = DefaultObjectKinds();
    rng.Shuffle(kinds);
    kinds.resize(std::min(kinds.size(), 1 + kMostBeside));
    return kinds;
  }
  const std::vector<std::string> allowed =
      fields_.kinds.empty() ? DefaultObjectKinds() : fields_.kinds;
  std::vector<std::string> kinds = {turn().Choose(allowed)};
  // The other objects are of other kinds: "pick up the mug" has to mean one object.
  std::vector<std::string> others = allowed;
  std::erase(others, kinds.front());
  rng.Shuffle(others);
  const size_t beside = std::min<size_t>(rng.UniformInt(kMostBeside + 1), others.size());
  kinds.insert(kinds.end(), others.begin(), others.begin() + static_cast<std::ptrdiff_t>(beside));
  return kinds;
}

void ObjectTask::Prepare(SceneSpec& spec, Rng& rng) {
  if (fields_.refer) surroundings_ = Surroundings{annotations().objects, annotations().containers};
  if (!draws_objects_) return;
  const std::vector<std::string> kinds = ChooseKinds(rng);
  if (kinds.empty()) throw ArgumentError("choose_kinds() must return at least the target's kind");
  const auto name = [&](size_t i) {
    return is_prepared_once() ? internal::NameOfDrawn(internal::kTarget, kinds[i], fields_.kinds)
                              : NameInRun(i);
  };
  fields_.name = name(0);
  fields_.word = WordOfKind(kinds.front());
  all_.clear();
  kinds_.clear();
  for (size_t i = 0; i < kinds.size(); ++i) {
    const SceneObject object = MakeCatalogueObject(kinds[i], name(i), rng);
    kinds_[object.name] = kinds[i];
    all_.push_back(object.name);
    spec.objects.push_back(object);
  }
}

void ObjectTask::AddDrawn(SceneSpec& spec, const SceneObject& object, const std::string& kind) {
  const size_t drawn = draws_objects_ ? all_.size() : 0;
  const size_t target = spec.objects.size() - drawn;
  spec.objects.push_back(object);
  for (size_t i = spec.objects.size() - 1; i > target + 1 && drawn > 0; --i)
    std::swap(spec.objects[i], spec.objects[i - 1]);
  all_.insert(all_.begin() + 1, object.name);
  kinds_[object.name] = kind;
}

void ObjectTask::Observed(const std::string& object, const std::string& kind) {
  if (std::ranges::find(all_, object) == all_.end()) all_.push_back(object);
  kinds_[object] = kind;
}

void ObjectTask::ObservedAs(const std::string& part, const std::string& object,
                            const std::string& kind) {
  Observed(object, kind);
  parts_[object] = part;
  stands_for_.emplace(part, object);
}

std::vector<std::string> ObjectTask::objects() const {
  std::vector<std::string> names;
  for (const std::string& object : all_) {
    const auto part = parts_.find(object);
    const std::string& name = part == parts_.end() ? object : part->second;
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  // The objects beside the target follow the drawn ones, as in a run.
  auto after = std::ranges::find_if_not(
      names, [&](const std::string& name) { return stands_for_.contains(name); });
  for (size_t i = 1; i <= kMostBeside && i < candidates_.size(); ++i)
    after = std::next(names.insert(after, NameInRun(i)));
  return names;
}

std::string ObjectTask::object_of(const std::string& name) const {
  const auto object = stands_for_.find(name);
  return object == stands_for_.end() ? name : object->second;
}

std::string ObjectTask::kind_of(const std::string& object) const {
  const std::string name = object_of(object);
  const auto drawn = kinds_.find(name);
  return drawn == kinds_.end() ? name : drawn->second;
}

std::vector<StartContents> ObjectTask::PossibleContents(const std::vector<std::string>& kinds) {
  Rng rng = Rng::Stream(0, "check");
  std::vector<StartContents> possible;
  for (size_t target = 0; target < kinds.size(); ++target) {
    StartContents& contents = possible.emplace_back();
    for (size_t i = 0; i < kinds.size(); ++i) {
      const std::string& kind = kinds[(target + i) % kinds.size()];
      const std::string name = i <= kMostBeside ? NameInRun(i) : kind;
      contents.objects.push_back(MakeCatalogueObject(kind, name, rng));
      contents.kinds.push_back(kind);
    }
  }
  return possible;
}

// Another task of the same fields prepared the scene.
void ObjectTask::FindCandidates(const Scene& scene, const TaskSetting& setting) {
  candidates_.clear();
  for (auto& [name, kind] :
       internal::DrawnObjects(scene, setting, internal::kTarget, fields_.kinds))
    candidates_.push_back(
        {name, kind, BodyHandle(scene, scene.compiled()->object(name).root_body)});
  if (candidates_.empty()) {
    throw ArgumentError(
        fmt::format("{}: the scene has none of the objects that the task draws; name one as "
                    "task.object, or let the task prepare the scene",
                    place_));
  }
  all_.clear();
  for (const Candidate& each : candidates_) ObservedAs(internal::kTarget, each.name, each.kind);
  Choose(0);
}

void ObjectTask::Choose(size_t candidate) {
  const Candidate& target = candidates_.at(candidate);
  chosen_ = candidate;
  fields_.name = target.name;
  fields_.word = WordOfKind(target.kind);
  object_ = target.body;
  Stand(internal::kTarget, target.name);
  size_t beside = 0;
  for (size_t i = 0; i < candidates_.size() && beside < kMostBeside; ++i)
    if (i != candidate) Stand(NameInRun(++beside), candidates_[i].name);
}

void ObjectTask::DrawTarget(Rng& rng) {
  if (!candidates_.empty()) Choose(rng.UniformInt(candidates_.size()));
}

std::vector<std::string> ObjectTask::resting_objects() const {
  if (candidates_.empty()) return {fields_.name};
  std::vector<std::string> names;
  for (const Candidate& each : candidates_) names.push_back(each.name);
  return names;
}

void ObjectTask::RequireMovable(const Scene& scene) const {
  const ObjectRecord& object = scene.compiled()->object(fields_.name);
  if (!object.free_joint) {
    const mjModel* m = scene.model();
    const int root = FindId(m, mjOBJ_BODY, object.root_body);
    if (root >= 0 && m->body_jntnum[root] > 0) {
      throw ArgumentError(
          fmt::format("{}: task.object '{}' moves on the joint '{}' of its root body, so that no "
                      "robot can pick it; choose an object whose root has no joint",
                      place_, fields_.name, ElementName(m, mjOBJ_JOINT, m->body_jntadr[root])));
    }
    throw ArgumentError(fmt::format(
        "{}: task.object '{}' is fixed, so that no robot can pick it; set fixed: false in {}",
        place_, fields_.name, is_run_ ? "its scene" : "root_frame_objects." + fields_.name));
  }
}

// Another task of the same fields prepared the scene, or none did.
ObjectTask::Surroundings ObjectTask::SurroundingsOf(const Scene& scene) const {
  const SceneAnnotations derived = DeriveAnnotations(scene);
  Surroundings found{.words = derived.objects, .containers = {}};
  const mjModel* m = scene.model();
  const auto is_of_task = [&](const std::string& body) {
    return std::ranges::any_of(candidates_, [&](const Candidate& drawn) {
      int id = FindId(m, mjOBJ_BODY, body);
      while (id > drawn.body.id()) id = m->body_parentid[id];
      return id == drawn.body.id();
    });
  };
  for (const Container& container : derived.containers) {
    if (!is_of_task(container.body)) found.containers.push_back(container);
  }
  return found;
}

void ObjectTask::Bind(const Scene& scene, const TaskSetting& setting) {
  place_ = setting.place;
  is_run_ = setting.is_run;
  root_ = scene.root_frame_to_world();
  if (draws_objects_ && (is_prepared_once() || fields_.name.empty() || !candidates_.empty()))
    FindCandidates(scene, setting);
  RequireMovable(scene);
  object_.emplace(scene, scene.compiled()->object(fields_.name).root_body);
  const auto offset = setting.objects.find(fields_.name);
  offset_ =
      offset == setting.objects.end() ? root_.inverse() * object_->pose_in_world() : offset->second;
  if (fields_.refer && !surroundings_) surroundings_ = SurroundingsOf(scene);
  robots_.clear();
  for (const std::string& robot : setting.robots)
    robots_.push_back(Robot::Of(scene.inner(), robot));
}

std::optional<Refusal> ObjectTask::Arrange(Scene& scene, Rng& /*rng*/) {
  constexpr double kMayFall = -std::numeric_limits<double>::infinity();
  const std::string why = WhyOutOfReach(robots_, ObjectInWorld(), kMayFall,
                                        internal::RadiusOf(scene.model(), object_->id()));
  if (why.empty()) return std::nullopt;
  return Refusal{.reason = fmt::format("'{}' is out of reach", fields_.name), .detail = why};
}

std::optional<Refusal> ObjectTask::CheckStart(const Scene& scene) {
  if (!checks_grasps()) return std::nullopt;
  std::optional<Refusal> refused;
  for (const Robot& robot : robots_) {  // one that has a grasp is enough
    auto refusal = grasps_[internal::ActingName(robot)].Check(
        scene, robot, object_->name(), fields_.lift_height,
        [&](PlanningScene& planning, const GraspMotion& motion) {
          return RefuseGrasp(scene, planning, motion);
        });
    if (!refusal) return std::nullopt;
    if (!refused) refused = std::move(refusal);
  }
  return refused;
}

void ObjectTask::Begin(const Scene& scene) {
  if (!object_) {  // by default all robots act
    Bind(scene, {.place = "scene '" + scene.name() + "'", .robots = internal::ActingArms(scene)});
  }
  start_ = root_.inverse() * ObjectInWorld();
  referral_ = fields_.refer ? FindReferral(scene) : "";
}

std::string ObjectTask::FindReferral(const Scene& scene) const {
  std::vector<ReferableObject> objects =
      ReferableObjects(scene, surroundings_->words, surroundings_->containers);
  const auto meant = std::ranges::find(objects, fields_.name, &ReferableObject::object);
  if (meant == objects.end() || robots_.empty()) return "";
  const auto call = [](ReferableObject& object, const std::string& noun) {
    if (noun.empty() || std::ranges::find(object.nouns, noun) != object.nouns.end()) return;
    object.nouns.insert(object.nouns.begin(), noun);
  };
  // The kind of the catalogue is what instructions call a drawn object, and a word of the task's
  // fields fits all objects like the one it was given to.
  const std::string plain = meant->nouns.front();
  for (ReferableObject& object : objects) {
    const auto drawn = kinds_.find(object.object);
    const bool is_alike = std::ranges::find(object.nouns, plain) != object.nouns.end();
    if (drawn != kinds_.end() && drawn->second != drawn->first)
      call(object, WordOfKind(drawn->second));
    if (is_alike) call(object, fields_.word);
  }
  const std::vector<std::string> found =
      ReferralsTo(objects, fields_.name, Viewer::Of(robots_.front().base_in_world()));
  return found.empty() ? "" : found.front();
}

TaskVerdict ObjectTask::Judge(const Scene& scene) {
  const bool success = IsDone(scene);
  const double progress = success ? 1 : Progress();
  return {.reward = progress, .success = success, .progress = progress};
}

std::vector<double> ObjectTask::memory() const {
  std::vector<double> memory = {start_.x(), start_.y(), start_.z()};
  if (!candidates_.empty()) memory.push_back(static_cast<double>(chosen_));
  return memory;
}

void ObjectTask::Recall(std::span<const double> memory) {
  start_ = {memory[0], memory[1], memory[2]};
  if (!candidates_.empty()) Choose(static_cast<size_t>(memory[3]));
}

std::string ObjectTask::WhyNoIndex(std::span<const double> memory, size_t number, const char* what,
                                   size_t count) {
  const double value = memory[number];
  if (value >= 0 && value < static_cast<double>(count) && value == std::floor(value)) return "";
  return fmt::format("number {}, {}, is {:g}; it is a whole number from 0 to {}", number, what,
                     value, count - 1);
}

std::string ObjectTask::WhyNotRecalled(std::span<const double> memory) const {
  for (size_t i = 0; i < 3; ++i) {
    if (std::isfinite(memory[i])) continue;
    return fmt::format("number {}, of the place where the object began, is {:g}; it is finite", i,
                       memory[i]);
  }
  if (candidates_.empty()) return "";
  return WhyNoIndex(memory, 3, "which object is the target", candidates_.size());
}

Pose ObjectTask::Around(const Pose& offset, const Vec2& spread, Rng& rng) {
  const double x = rng.Uniform(-1, 1) * spread[0];
  const double y = rng.Uniform(-1, 1) * spread[1];
  return Pose(Eigen::Vector3d(x, y, 0)) * offset;
}

Pose ObjectTask::Start(Rng& rng) const {
  const Pose at = Around(offset_, fields_.spread, rng);
  const double yaw = fields_.rotate ? rng.Uniform(-internal::kPi, internal::kPi) : 0;
  const Pose turn = Pose::FromRpy(Eigen::Vector3d::Zero(), {0, 0, yaw});
  return {at.translation(), (turn * at).quaternion()};
}

double ObjectTask::Nearness() const {
  const Eigen::Vector3d object = ObjectInWorld();
  double nearest = std::numeric_limits<double>::infinity();
  for (const Robot& robot : robots_)
    nearest = std::min(nearest, (robot.tcp_in_world().translation() - object).norm());
  return Near(nearest);
}

double ObjectTask::Lift() const { return ObjectInWorld().z() - (root_ * start_).z(); }

double ObjectTask::Lifted() const { return std::clamp(Lift() / fields_.lift_height, 0.0, 1.0); }

bool ObjectTask::IsLifted(const Scene& scene) const {
  return Lift() >= fields_.lift_height && internal::IsHeld(scene, object_->name());
}

}  // namespace robocell
