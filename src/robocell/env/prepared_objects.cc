#include "robocell/env/prepared_objects.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "robocell/assets/resolve.h"
#include "robocell/base/suggestions.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/scenes/object_places.h"
#include "robocell/scenes/place_links.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/spec_bytes.h"
#include "robocell/task/task_calls.h"

namespace robocell::internal {
namespace {

constexpr int kDraws = 60;                  // of places, until all are in reach
constexpr double kRounding = 1e-9;          // of a pose, rad and m
const Eigen::Vector3d kAside(50, 50, -50);  // where objects wait during the search for supports

std::set<std::string> NamesOfConfig(const EnvConfig& config) {
  std::set<std::string> names;
  for (const auto* objects : {&config.root_frame_objects, &config.world_frame_objects}) {
    for (const auto& [id, object] : objects->entries()) names.insert(id);
  }
  for (const auto& [robot, objects] : config.robot_frame_objects.entries()) {
    for (const auto& [id, object] : objects->entries()) names.insert(id);
  }
  return names;
}

// The scene without the objects, which keep their names: they are parked.
SceneSpec Without(SceneSpec spec, const std::vector<SceneObject>& objects) {
  for (SceneObject& object : spec.objects) {
    const auto same = [&](const SceneObject& other) { return other.name == object.name; };
    if (std::ranges::any_of(objects, same)) object.parked = true;
  }
  return spec;
}

// Copies of an environment are of one scene.
std::shared_ptr<const Landmarks> SharedLandmarks(const SceneSpec& spec) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<const Landmarks>> known;
  const std::lock_guard lock(mutex);
  std::erase_if(known, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<const Landmarks>& kept = known[SpecBytes(spec)];
  std::shared_ptr<const Landmarks> landmarks = kept.lock();
  if (!landmarks) kept = landmarks = LandmarksOf(spec);
  return landmarks;
}

// Entries for objects that cannot move, which are problems, are left out.
StatedPlaces OfFreeObjects(StatedPlaces stated, const Scene& scene, Problems& problems) {
  Map<ObjectPlace> kept;
  for (const auto& entry : stated.places.entries()) {
    const std::string& key = entry.first;
    const auto& place = entry.second;
    const auto& objects = scene.spec().objects;
    const bool is_known = std::any_of(objects.boxes().begin(), objects.boxes().end(),
                                      [&](const auto& box) { return box->name == key; });
    if (!is_known || scene.compiled()->object(key).free_joint) {
      kept[key] = *place;
      continue;
    }
    const Problems::Scope scope(problems, stated.path);
    const std::string why = "it is a fixed object, which stays where its pose is";
    stated.hook.empty() ? problems.AddAt(key, why)
                        : problems.Add(fmt::format("{}: '{}': {}", stated.hook, key, why));
  }
  stated.places = std::move(kept);
  return stated;
}

// Returns the part of a support in a square around a point; unset if they are apart.
std::optional<Support> PatchAround(const Support& support, const Eigen::Vector3d& point,
                                   double half) {
  const Eigen::Vector3d at = support.frame_to_world.inverse() * point;
  const auto cut = [&](double middle, double extent) {
    return std::pair{std::max(-extent, middle - half), std::min(extent, middle + half)};
  };
  const auto [left, right] = cut(at.x(), support.half_x);
  const auto [near, far] = cut(at.y(), support.half_y);
  if (left >= right || near >= far) return std::nullopt;
  Support patch = support;
  patch.frame_to_world =
      support.frame_to_world * Pose(Eigen::Vector3d((left + right) / 2, (near + far) / 2, 0));
  patch.half_x = (right - left) / 2;
  patch.half_y = (far - near) / 2;
  return patch;
}

}  // namespace

PreparedObjects::PreparedObjects(const Scene& scene, const EnvConfig& config, Task* task)
    : scene_(scene),
      task_(task),
      place_("environment '" + config.name + "'"),
      locations_(config.locations) {
  if (task) RequireObjects(config, *task);
  FindObjects(config);
  loose_ = added_;
  Relate(config);
  ObjectSizes sizes;
  sizes_.resize(objects_.size());
  for (size_t i = 0; i < objects_.size(); ++i) {
    const bool is_added = std::ranges::find(added_, i) != added_.end();
    if (!related_ && !is_added) continue;
    ResolveModel(objects_[i]);
    sizes_[i] = sizes.Of(objects_[i]);
    if (const std::string why = WhyTooLarge(objects_[i], sizes_[i]); is_added && !why.empty()) {
      throw SpecError(fmt::format(
          "environment '{}': task '{}': prepare() added an object that cannot be handled: {}",
          config.name, config.task ? config.task->kind() : "", why));
    }
  }
  if (!added_.empty()) FindSupports(config, task);
}

void PreparedObjects::RequireObjects(const EnvConfig& config, Task& task) const {
  const std::set<std::string> known = NamesOfConfig(config);
  std::vector<SceneObject> prepared;
  for (const SceneObject& object : scene_.spec().objects) {
    if (!known.contains(object.name)) prepared.push_back(object);
  }
  TaskCalls(task).RequireObjects(scene_, prepared);
}

void PreparedObjects::FindObjects(const EnvConfig& config) {
  const std::set<std::string> known = NamesOfConfig(config);
  for (SceneObject object : scene_.spec().objects) {
    const ObjectRecord& record = scene_.compiled()->object(object.name);
    if (IsFixed(object) || object.parked || !record.free_joint) continue;
    const bool is_loose = !known.contains(object.name) && !object.has_pose();
    const Pose compiled = scene_.body_pose(record.root_body);
    object.attach_to = {};
    ForgetPose(object);
    if (is_loose) {
      added_.push_back(objects_.size());
    } else {
      object.pos = ToVec3(compiled.translation());
      object.quat = compiled.quaternion();
    }
    objects_.push_back(object);
    bodies_.push_back(record.root_body);
    compiled_.push_back(compiled);
  }
}

void PreparedObjects::ResolveModel(SceneObject& object) const {
  if (!object.mjcf_path.empty())
    object.mjcf_path = assets::Resolve(object.mjcf_path, scene_.spec().source_dir);
}

// `places` of the configuration come before those of the task.
void PreparedObjects::Relate(const EnvConfig& config) {
  Problems problems(locations_);
  const auto add = [&](StatedPlaces places) {
    if (!places.places.empty())
      stated_.push_back(OfFreeObjects(std::move(places), scene_, problems));
  };
  add({.places = config.places, .path = "places"});
  if (task_) add({.places = TaskCalls(*task_).Places(), .path = "task", .hook = "places()"});
  problems.Throw(place_);
  if (stated_.empty()) return;
  placed_ = objects_;
  const std::set<std::string> of_config = NamesOfConfig(config);
  for (SceneObject& object : placed_) {
    const bool is_of_task = task_ && !of_config.contains(object.name);
    const std::string& kind =
        kinds_.emplace_back(is_of_task ? TaskCalls(*task_).KindOf(object.name) : object.name);
    ResolveModel(object);
    const auto says = [&](const StatedPlaces& each) {
      return each.places.contains(object.name) || each.places.contains(kind);
    };
    // A place takes the place of a pose.
    if (std::ranges::any_of(stated_, says)) ForgetPose(object);
  }
  landmarks_ = SharedLandmarks(Without(scene_.spec(), objects_));
  RelateParts(PresentParts());
}

std::vector<std::string> PreparedObjects::PresentParts() const {
  std::vector<std::string> parts(objects_.size());
  if (!task_) return parts;
  for (const std::string& name : TaskCalls(*task_).Objects()) {
    const std::string object = TaskCalls(*task_).ObjectOf(name);
    for (size_t i = 0; i < objects_.size() && object != name; ++i) {
      if (objects_[i].name == object) parts[i] = name;
    }
  }
  return parts;
}

// Resolves the relations of starts in which these names stand for the objects.
void PreparedObjects::RelateParts(std::vector<std::string> parts) {
  if (related_ && parts == parts_) return;
  Problems problems(locations_);
  const auto may_come = [](const std::string&) { return false; };
  std::vector<PlaceLink> links =
      LinkPlaces(landmarks_, stated_, {placed_, kinds_, may_come, parts}, problems);
  problems.Throw(place_);
  parts_ = std::move(parts);
  related_.emplace(std::move(links));
  loose_ = added_;
  std::erase_if(loose_, [&](size_t i) { return IsRelated(i); });
}

void PreparedObjects::FindSupports(const EnvConfig& config, Task* task) {
  std::vector<Robot> robots;
  for (const std::string& name : config.robots.keys()) {
    if (const Robot robot = Robot::Of(scene_, name); robot.has_arm()) robots.push_back(robot);
  }
  const std::vector<Support> supports = SupportsAround(robots);
  const BaseRange wanted = task ? SoundBaseRange(*task) : BaseRange();
  for (const Robot& robot : robots) {
    for (Place& place : PlacesOf(robot, supports, wanted)) places_.push_back(std::move(place));
  }
}

// Returns level faces, and after them the free floor, in the scene without the objects that are
// drawn.
std::vector<Support> PreparedObjects::SupportsAround(const std::vector<Robot>& robots) const {
  Scene scene = scene_;
  std::vector<std::string> drawn;
  for (size_t i = 0; i < bodies_.size(); ++i) {
    if (!IsLoose(i) && !IsRelated(i)) continue;
    drawn.push_back(bodies_[i]);
    scene.SetBodyPose(bodies_[i], Pose(kAside));
  }
  std::vector<Eigen::Vector3d> reached;
  for (const Robot& robot : robots) {
    const double reach = kReachShare * robot.reach();
    for (const double x : {-reach, reach}) {
      for (const double y : {-reach, reach})
        reached.push_back(robot.base_in_world().translation() + Eigen::Vector3d(x, y, 0));
    }
  }
  std::vector<Support> supports;
  for (const SupportFace& found : FindSupportFaces(scene)) supports.push_back(found.face);
  for (const Support& floor : FindFloors(scene, drawn, reached)) supports.push_back(floor);
  for (size_t i = 0; i < bodies_.size(); ++i) {
    if (IsLoose(i) || IsRelated(i)) scene.SetBodyPose(bodies_[i], compiled_[i]);
  }
  return supports;
}

bool PreparedObjects::IsLoose(size_t i) const {
  return std::ranges::find(loose_, i) != loose_.end();
}

// Returns places on the first support with enough space; at the distance from the base that the
// task specifies if that is possible, else anywhere in reach.
std::vector<PreparedObjects::Place> PreparedObjects::PlacesOf(const Robot& robot,
                                                              const std::vector<Support>& supports,
                                                              const BaseRange& wanted) const {
  const Eigen::Vector3d base = robot.base_in_world().translation();
  const double reach = kReachShare * robot.reach();
  const BaseRange anywhere{.distance = {0, reach}};
  for (const Support& support : supports) {
    for (const BaseRange& range : {wanted, anywhere}) {
      const double half = std::min(reach, range.distance[1] + kObjectGap);
      const std::optional<Support> patch = PatchAround(support, base, half);
      if (!patch) continue;
      const Place place{robot, *patch, range};
      Rng rng = Rng::Stream(0, "prepared places");
      std::vector<SceneObject> tried = objects_;
      if (PutLoose(place, tried, rng)) return {place};
    }
  }
  return {};
}

// Sets the poses of those that need a support and have no pose.
bool PreparedObjects::PutLoose(const Place& place, std::vector<SceneObject>& objects,
                               Rng& rng) const {
  const Pose base = place.robot.base_in_world();
  const double reach = kReachShare * place.robot.reach();
  std::vector<SceneObject> given;
  std::vector<ObjectSize> sizes;
  for (const size_t i : loose_) {
    given.push_back(objects[i]);
    sizes.push_back(sizes_[i]);
  }
  for (int t = 0; t < kDraws; ++t) {
    std::vector<SceneObject> drawn = given;
    if (!PlaceOn(place.patch, sizes, drawn, rng)) continue;
    bool fits = true;
    for (size_t i = 0; i < drawn.size() && fits; ++i) {
      if (given[i].has_pose()) continue;
      const Eigen::Vector3d displacement = drawn[i].pose().translation() - base.translation();
      const double distance = displacement.head<2>().norm();
      fits = displacement.norm() <= reach;
      if (i == 0) {
        fits = fits && distance >= place.distance.distance[0] &&
               distance <= place.distance.distance[1];
      }
    }
    if (!fits) continue;
    for (size_t i = 0; i < drawn.size(); ++i) objects[loose_[i]] = drawn[i];
    return true;
  }
  return false;
}

// All objects, where `starts` puts them.
std::vector<SceneObject> PreparedObjects::ObjectsAt(const BodyPoses& starts) const {
  std::vector<SceneObject> objects = objects_;
  for (size_t i = 0; i < objects.size(); ++i) {
    for (const auto& [body, pose] : starts) {
      if (body != bodies_[i]) continue;
      objects[i].pos = ToVec3(pose.translation());
      objects[i].euler = {};
      objects[i].quat = pose.quaternion();
    }
  }
  return objects;
}

PreparedObjects::Drawn PreparedObjects::Draw(BodyPoses& starts, Rng& rng) {
  if (related_) RelateParts(PresentParts());
  std::erase_if(starts, [&](const auto& start) {
    const auto body = std::ranges::find(bodies_, start.first);
    return body != bodies_.end() && IsRelated(static_cast<size_t>(body - bodies_.begin()));
  });
  const std::vector<SceneObject> before = ObjectsAt(starts);
  std::vector<SceneObject> objects = before;
  std::optional<LevelArea> ground;  // ground of those on a support
  if (std::ranges::any_of(loose_, [&](size_t i) { return !before[i].has_pose(); })) {
    if (places_.empty()) return {};
    const Place& place = places_[rng.UniformInt(places_.size())];
    if (!PutLoose(place, objects, rng)) return {};
    ground = place.patch.area();
  }
  if (related_) {
    std::vector<LevelArea> grounds;
    for (size_t i = 0; i < objects.size(); ++i) {
      const Eigen::Vector3d at = objects[i].pose().translation();
      const bool is_on_support = IsLoose(i) && !before[i].has_pose();
      grounds.push_back(is_on_support ? *ground
                                      : landmarks_->GroundUnder(at - sizes_[i].height *
                                                                         Eigen::Vector3d::UnitZ()));
    }
    if (auto why_not = related_->Put(grounds, sizes_, objects, rng))
      return {.added = {}, .why_not = *std::move(why_not)};
  }
  Drawn drawn;
  for (size_t i = 0; i < objects.size(); ++i) {
    const bool is_drawn = IsRelated(i) || (IsLoose(i) && !before[i].has_pose());
    if (is_drawn) drawn.added.emplace_back(bodies_[i], objects[i].pose());
  }
  starts.insert(starts.end(), drawn.added.begin(), drawn.added.end());
  return drawn;
}

std::vector<std::string> PreparedObjects::names() const {
  std::vector<std::string> names;
  for (size_t i = 0; i < objects_.size(); ++i) {
    if (IsLoose(i) || IsRelated(i)) names.push_back(objects_[i].name);
  }
  return names;
}

bool IsSamePlace(const Pose& a, const Pose& b) { return a.is_close(b, kRounding, kRounding); }

std::vector<std::string> PreparedObjects::names_on_support() const {
  std::vector<std::string> names;
  for (const size_t i : loose_) names.push_back(objects_[i].name);
  return names;
}

std::vector<std::string> PreparedObjects::Unplaced() const {
  std::vector<std::string> unplaced;
  for (const size_t i : loose_) {
    if (IsSamePlace(scene_.body_pose(bodies_[i]), compiled_[i]))
      unplaced.push_back(objects_[i].name);
  }
  return unplaced;
}

std::vector<std::string> PreparedObjects::PlacedHere(const BodyPoses& added) const {
  std::vector<std::string> placed;
  for (size_t i = 0; i < objects_.size(); ++i) {
    for (const auto& [body, pose] : added) {
      if (body == bodies_[i] && IsSamePlace(scene_.body_pose(body), pose))
        placed.push_back(objects_[i].name);
    }
  }
  return placed;
}

std::string PreparedObjects::Advice() const {
  return fmt::format(
      "prepare() added {} without saying where, and nothing level within reach of the robots has "
      "room for them. Set `add_floor: true`, put a box with `fixed: true` in reach "
      "(root_frame_objects), or place them in the task's prepare() or starts()",
      ListNames(names_on_support()));
}

}  // namespace robocell::internal
