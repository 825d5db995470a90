#include "robocell/task/relation_tasks.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/base/units.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/landmarks.h"
#include "robocell/spec/validate.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/colours.h"
#include "robocell/task/drawn_objects.h"
#include "robocell/task/handle_motion.h"
#include "robocell/task/pick_and_place_task.h"

namespace robocell {
namespace {

using internal::kTarget;

constexpr const char* kReference = "reference";
constexpr const char* kRegion = "region";
constexpr const char* kBlock = "block";
constexpr double kMostOffWay = 0.9;  // rad between the push and the direction away from the robot

// Returns the kind of an object by its model or shape.
std::string KindOf(const SceneObject& object) {
  if (object.shape) return std::string(ToString(*object.shape));
  return std::filesystem::path(object.mjcf_path).stem().string();
}

std::string KindInScene(const Scene& scene, const std::string& name) {
  for (const SceneObject& object : scene.spec().objects) {
    if (object.name == name) return KindOf(object);
  }
  return name;
}

// Splits "red=box"; a kind alone is its own name.
std::pair<std::string, std::string> NameAndKind(const std::string& text) {
  const size_t at = text.find('=');
  if (at == std::string::npos) return {text, text};
  return {text.substr(0, at), text.substr(at + 1)};
}

// Throws SpecError for fields that a file could not have either.
template <class Config>
const Config& Checked(const Config& fields) {
  RequireValid(fields, fmt::format("task '{}'", Config::kKind));
  return fields;
}

}  // namespace

RelationsTask::RelationsTask(const RelationsTaskConfig& fields)
    : RelationTask(fields.hold_seconds), task_(Checked(fields)) {
  for (const std::string& text : task_.objects) {
    const auto [name, kind] = NameAndKind(text);
    Name(name, kind);
  }
}

void RelationsTask::AddObjects(SceneSpec& spec, Rng& rng) {
  // The first object of the goal is the one beside which the robot stands.
  std::vector<std::pair<std::string, std::string>> objects;
  for (const std::string& text : task_.objects) objects.push_back(NameAndKind(text));
  const std::string first = ParseRelation(task_.goal.names.front()).subject;
  std::ranges::stable_sort(objects, [&](const auto& a, const auto& b) {
    const auto is_first = [&](const std::string& name) {
      return first == name || first.starts_with(name + "_");
    };
    return is_first(a.first) && !is_first(b.first);
  });
  for (const auto& [name, kind] : objects) {
    const std::vector<std::string> kinds = ObjectKindsOf({kind});
    Add(spec, name, kinds.size() == 1 ? kinds[0] : kinds[rng.UniformInt(kinds.size())], rng);
  }
}

void RelationsTask::Found(const Scene& scene, const TaskSetting& /*setting*/) {
  std::vector<std::string> own;
  for (const std::string& text : task_.goal) own.push_back(ParseRelation(text).subject);
  for (const std::string& text : task_.objects) own.push_back(NameAndKind(text).first);
  for (const std::string& name : own) {
    for (const SceneObject& object : scene.spec().objects) {
      if (object.name == name) Name(name, KindOf(object));
    }
  }
}

std::string RelationsTask::instruction() const {
  return task_.instruction.empty() ? RelationTask::instruction() : task_.instruction;
}

StackTask::StackTask(const StackTaskConfig& fields) : task_(Checked(fields)) {}

std::vector<std::string> StackTask::NamesOf(int cubes) {
  Checked(StackTaskConfig{.cubes = cubes});
  std::vector<std::string> names;
  for (int i = 0; i < cubes; ++i)
    names.push_back(fmt::format("{}_cube", internal::kNamedColours[static_cast<size_t>(i)].word));
  return names;
}

// The cube that is picked up first comes first.
void StackTask::AddObjects(SceneSpec& spec, Rng& /*rng*/) {
  const std::vector<std::string> names = NamesOf(task_.cubes);
  for (const size_t i : {size_t{1}, size_t{0}, size_t{2}, size_t{3}, size_t{4}, size_t{5}}) {
    if (i >= names.size()) continue;
    const double half = task_.edge / 2;
    SceneObject cube{.name = names[i],
                     .shape = Shape::kBox,
                     .size = Vec3{half, half, half},
                     .rgba = internal::kNamedColours[i].rgba,
                     .mass = 1000 * task_.edge * task_.edge * task_.edge,
                     .friction = Vec3{1, 0.02, 0.001},
                     .condim = Condim::kTorsional};
    spec.objects.push_back(std::move(cube));
    Name(names[i], "cube");
  }
}

void StackTask::Found(const Scene& scene, const TaskSetting& /*setting*/) {
  const std::vector<std::string> names = NamesOf(task_.cubes);
  for (const size_t i : {size_t{1}, size_t{0}, size_t{2}, size_t{3}, size_t{4}, size_t{5}}) {
    if (i >= names.size()) continue;
    scene.compiled()->object(names[i]);  // NotFoundError with the names
    Name(names[i], "cube");
  }
}

std::vector<std::string> StackTask::StatedGoal() const {
  const std::vector<std::string> names = NamesOf(task_.cubes);
  std::vector<std::string> goal;
  for (size_t i = 1; i < names.size(); ++i) goal.push_back(names[i] + " on " + names[i - 1]);
  return goal;
}

std::string StackTask::WordFor(const std::string& name) const {
  std::string word = name;
  std::ranges::replace(word, '_', ' ');
  return word;
}

PlaceNextToTask::PlaceNextToTask(const PlaceNextToTaskConfig& fields) : task_(Checked(fields)) {}

void PlaceNextToTask::AddObjects(SceneSpec& spec, Rng& rng) {
  const std::vector<std::string> kinds = KindsToDraw(task_.objects);
  const std::vector<std::string> references = KindsToDraw(task_.references);
  const std::string kind =
      is_prepared_once() ? kinds[rng.UniformInt(kinds.size())] : turn().Choose(kinds);
  // "Next to the mug" has to mean one object.
  std::vector<std::string> others = references;
  if (others.size() > 1) std::erase(others, kind);
  const std::string other = others[rng.UniformInt(others.size())];
  Add(spec, kTarget, kind, rng);
  Add(spec, kReference, other, rng);
}

void PlaceNextToTask::Found(const Scene& scene, const TaskSetting& /*setting*/) {
  for (const char* name : {kTarget, kReference}) {
    scene.compiled()->object(name);
    Name(name, KindInScene(scene, name));
  }
}

std::vector<std::string> PlaceNextToTask::StatedGoal() const {
  return {fmt::format("{} next_to {} {}", kTarget, kReference, task_.gap)};
}

JointTask::JointTask(const OpenTaskConfig& fields)
    : relation_("open"),
      object_(Checked(fields).object),
      joint_(fields.joint),
      kinds_(ObjectKindsOf(fields.objects.names)),
      draws_(fields.object.empty()),
      share_(fields.opening),
      start_(fields.start_opening) {}
JointTask::JointTask(const CloseTaskConfig& fields)
    : relation_("closed"),
      object_(Checked(fields).object),
      joint_(fields.joint),
      kinds_(ObjectKindsOf(fields.objects.names)),
      draws_(fields.object.empty()),
      share_(fields.opening),
      start_(fields.start_opening) {}
JointTask::JointTask(const PressTaskConfig& fields)
    : RelationTask(0),
      relation_("pressed"),
      object_(Checked(fields).object),
      joint_(fields.joint),
      kinds_(ObjectKindsOf(fields.objects.names)),
      draws_(fields.object.empty()),
      share_(fields.depth) {}

std::vector<std::string> JointTask::DefaultKinds(const std::string& relation) {
  if (relation == "pressed") return {"button_panel"};
  return {"drawer_unit", "cupboard", "lid_box"};
}

BaseRange JointTask::base_range() const {
  // Buttons are pressed from above, and handles are in front of what they are on.
  const Vec2 distance = relation_ == "pressed" ? Vec2{0.4, 0.55} : Vec2{0.5, 0.65};
  return {.distance = distance, .height_offset = -0.25, .height_noise = {-0.1, 0.1}};
}

void JointTask::AddObjects(SceneSpec& spec, Rng& rng) {
  if (!draws_) return;
  const std::vector<std::string> kinds = kinds_.empty() ? DefaultKinds(relation_) : kinds_;
  const std::string kind =
      is_prepared_once() ? kinds[rng.UniformInt(kinds.size())] : turn().Choose(kinds);
  object_ = kTarget;
  Add(spec, object_, kind, rng);
}

void JointTask::Found(const Scene& scene, const TaskSetting& /*setting*/) {
  if (draws_) object_ = kTarget;
  Name(object_, KindInScene(scene, object_));
  const mjModel* m = scene.model();
  const int root = FindId(m, mjOBJ_BODY, scene.compiled()->object(object_).root_body);
  std::vector<std::string> all;
  joints_.clear();
  for (int j = 0; j < m->njnt; ++j) {
    const bool opens = m->jnt_type[j] == mjJNT_HINGE || m->jnt_type[j] == mjJNT_SLIDE;
    if (!opens || !internal::IsInSubtree(m, m->jnt_bodyid[j], root)) continue;
    const std::string name = ElementName(m, mjOBJ_JOINT, j);
    const bool has_prefix = name.starts_with(object_ + "_");
    all.push_back(has_prefix ? name.substr(object_.size() + 1) : name);
    if (!joint_.empty() && name != joint_ && name != SceneObjectElementName(object_, joint_))
      continue;
    // Of several joints those with a handle are opened, and slides without one pressed.
    const bool presses = relation_ == "pressed", is_hinge = m->jnt_type[j] == mjJNT_HINGE;
    if (joint_.empty()) {
      const JointOpening opening = JointOpening::Of(scene, name);
      const bool has_handle = internal::FindHandle(scene, opening).has_value();
      if (presses ? has_handle || is_hinge
                  : !has_handle || internal::TurnsOnTheSpot(scene, opening))
        continue;
    }
    joints_.push_back(name);
  }
  chosen_ = 0;
  if (!joints_.empty()) return;
  if (!joint_.empty())
    throw NotFoundError(NoSuchName(place() + " / object '" + object_ + "'", "joint", joint_, all));
  throw ArgumentError(
      fmt::format("{}: object '{}' has no joint that can be {}: {}", place(), object_, relation_,
                  relation_ == "pressed"
                      ? "none slides a body without a handle"
                      : "none moves a geom that is named handle or knob, but on its own axis"));
}

std::optional<Refusal> JointTask::Draw(Scene& scene, Rng& rng) {
  chosen_ = rng.UniformInt(joints_.size());
  for (const std::string& each : joints_) JointOpening::Of(scene, each).Put(0);
  JointOpening::Of(scene, joint()).Put(rng.Uniform(start_[0], start_[1]));
  scene.PosesChanged();
  scene.SyncPoses();
  return std::nullopt;
}

std::vector<std::string> JointTask::StatedGoal() const {
  if (joints_.empty()) return {};
  // TextOf quotes names with spaces.
  return {TextOf({.subject = joint(), .relation = relation_, .numbers = {share_}})};
}

// "target_drawer_slide" is the drawer of the chest; "target_red_button" the red button.
std::string JointTask::WordFor(const std::string& name) const {
  if (name != joint()) return "";
  std::string word = name.starts_with(object_ + "_") ? name.substr(object_.size() + 1) : name;
  for (const char* end : {"_slide", "_hinge", "_joint"}) {
    if (word.ends_with(end)) word.resize(word.size() - std::string(end).size());
  }
  std::ranges::replace(word, '_', ' ');
  return word;
}

std::vector<Feature> JointTask::signals() const {
  return {{.column = {.name = "opening",
                      .shape = {1},
                      .units = "1",
                      .frame = "",
                      .names = {"opening"},
                      .description = "How far the joint of the goal is open, as a share of its "
                                     "range."},
           .role = FeatureRole::kPrivileged,
           .lower = {-1},
           .upper = {2}}};
}

void JointTask::Observe(const Scene& scene, std::span<double> out) const {
  out[0] = std::clamp(JointOpening::Of(scene, joint()).share(), -1.0, 2.0);
}

PushTask::PushTask(const PushTaskConfig& fields) : RelationTask(0.1), task_(Checked(fields)) {}

void PushTask::AddObjects(SceneSpec& spec, Rng& rng) {
  if (task_.objects.empty()) {
    const double half = rng.Uniform(0.022, 0.032);
    spec.objects.push_back(
        {.name = kTarget,
         .shape = Shape::kBox,
         .size = Vec3{half, half, rng.Uniform(0.018, 0.024)},
         .rgba = internal::kNamedColours[rng.UniformInt(internal::kNamedColours.size())].rgba,
         .mass = 0.15,
         .friction = Vec3{0.6, 0.02, 0.001},
         .condim = Condim::kTorsional});
    Name(kTarget, kBlock);
  } else {
    const std::vector<std::string> kinds = KindsToDraw(task_.objects);
    Add(spec, kTarget,
        is_prepared_once() ? kinds[rng.UniformInt(kinds.size())] : turn().Choose(kinds), rng);
  }
  spec.objects.push_back({.name = kRegion, .mjcf_path = "region", .pos = Vec3{}});
  Name(kRegion, kRegion);
}

void PushTask::Found(const Scene& scene, const TaskSetting& /*setting*/) {
  for (const char* name : {kTarget, kRegion}) scene.compiled()->object(name);
  Name(kTarget, task_.objects.empty() ? kBlock : KindInScene(scene, kTarget));
  Name(kRegion, kRegion);
}

std::vector<std::string> PushTask::StatedGoal() const {
  return {fmt::format("{} in_region {}", kTarget, kRegion)};
}

std::string PushTask::WordFor(const std::string& name) const {
  return name == kRegion ? "marked region" : "";
}

// The region lies beyond the object, seen from the robot, on what the object lies on.
std::optional<Refusal> PushTask::Draw(Scene& scene, Rng& rng) {
  const ObjectRecord& target = scene.compiled()->object(kTarget);
  const Eigen::Vector3d at = scene.body_pose(target.root_body).translation();
  Eigen::Vector3d from = scene.root_frame_to_world().translation();
  if (!robots().empty()) from = robots().front().base_in_world().translation();
  const Eigen::Vector2d out = (at - from).head<2>();
  const double angle = std::atan2(out.y(), out.x()) + rng.Uniform(-kMostOffWay, kMostOffWay);
  const double distance = rng.Uniform(task_.distance[0], task_.distance[1]);
  const Eigen::Vector3d middle =
      at + distance * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
  const internal::Landmarks marks(scene, {});
  double low = at.z();
  const int body = FindId(scene.model(), mjOBJ_BODY, target.root_body);
  for (const int geom : internal::CollisionGeomsOf(scene.model(), body))
    low = std::min(
        low,
        internal::GeomExtent(scene.model(), scene.data(), geom, Eigen::Vector3d::UnitZ()).lower);
  scene.SetBodyPose(scene.compiled()->object(kRegion).root_body,
                    Pose(Eigen::Vector3d(middle.x(), middle.y(), low + 0.001)));
  // What carries the object has to carry it there too.
  std::vector<int> others;
  for (int geom = 0; geom < scene.model()->ngeom; ++geom) {
    if (internal::IsCollisionGeom(scene.model(), geom) &&
        !internal::IsInSubtree(scene.model(), scene.model()->geom_bodyid[geom], body))
      others.push_back(geom);
  }
  const double reach = internal::RadiusOf(scene.model(), body);
  const Eigen::Vector2d ahead(std::cos(angle), std::sin(angle)), aside(-ahead.y(), ahead.x());
  for (const Eigen::Vector2d& step : {ahead, aside, Eigen::Vector2d(-aside)}) {
    const Eigen::Vector3d above(middle.x() + reach * step.x(), middle.y() + reach * step.y(),
                                low + 0.02);
    const internal::RayHit hit =
        internal::CastRay(scene.model(), scene.data(), others, above, -Eigen::Vector3d::UnitZ());
    if (!(hit.distance > 0.01 && hit.distance < 0.03))
      return Refusal{.reason = "no free place for the region",
                     .detail = "beyond the object its support ends, or something is in the way"};
  }
  return std::nullopt;
}

}  // namespace robocell
