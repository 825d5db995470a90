#include "robocell/env/prepared_objects.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "robocell/base/suggestions.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/scenes/object_places.h"
#include "robocell/scenes/scene_annotations.h"

namespace robocell::internal {
namespace {

constexpr int kDraws = 60;                  // of places, until all are in reach
constexpr double kSamePlace = 1e-9;         // metres
constexpr double kLevel = 0.9998;           // cosine of one degree
const Eigen::Vector3d kAside(50, 50, -50);  // where objects wait while supports are looked for

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

bool HasOwnPose(const SceneObject& object) {
  return !object.pose().is_close(Pose(), kSamePlace, kSamePlace);
}

// Floors: level planes, as far as the robot reaches around its base.
void AddFloors(const Scene& scene, const Eigen::Vector3d& around, double reach,
               std::vector<Support>& supports) {
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  for (int g = 0; g < m->ngeom; ++g) {
    if (m->geom_type[g] != mjGEOM_PLANE || !IsCollisionGeom(m, g)) continue;
    const Pose plane = Pose::FromTranslationAndMatrix(d->geom_xpos + 3 * g, d->geom_xmat + 9 * g);
    if (plane.rotation()(2, 2) < kLevel) continue;
    const auto half = [&](int axis) {  // planes of size 0 have no end
      const double size = m->geom_size[3 * g + axis];
      return size > 0 ? size : std::abs((plane.inverse() * around)[axis]) + reach;
    };
    supports.push_back({plane, half(0), half(1), 0, ""});
  }
}

// What of a support lies in a square around a point; nothing when they are apart.
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

PreparedObjects::PreparedObjects(const Scene& scene, const EnvConfig& config, const Task& task)
    : scene_(scene) {
  const std::set<std::string> known = NamesOfConfig(config);
  ObjectSizes sizes;
  for (const SceneObject& object : scene_.spec().objects) {
    const bool is_prepared = !known.contains(object.name) && !IsFixed(object) && !object.parked;
    if (!is_prepared || HasOwnPose(object)) continue;
    const ObjectRecord& record = scene_.compiled()->object(object.name);
    if (!record.free_joint) continue;
    objects_.push_back(object);
    bodies_.push_back(record.root_body);
    compiled_.push_back(scene_.body_pose(record.root_body));
  }
  if (objects_.empty()) return;
  for (const SceneObject& object : objects_) sizes_.push_back(sizes.Of(object));
  for (const std::string& body : bodies_) scene_.SetBodyPose(body, Pose(kAside));
  std::vector<Support> supports;
  for (const SupportFace& found : FindSupportFaces(scene_)) supports.push_back(found.face);
  for (size_t i = 0; i < bodies_.size(); ++i) scene_.SetBodyPose(bodies_[i], compiled_[i]);
  for (const std::string& name : config.robots.keys()) {
    const Robot robot = Robot::Of(scene_, name);
    if (!robot.has_arm()) continue;
    for (Place& place : PlacesOf(robot, supports, task.base_range()))
      places_.push_back(std::move(place));
  }
}

// The first support on which there is room; as far from the base as the task asks for if that is
// possible, else anywhere in reach.
std::vector<PreparedObjects::Place> PreparedObjects::PlacesOf(const Robot& robot,
                                                              const std::vector<Support>& supports,
                                                              const BaseRange& wanted) const {
  const Eigen::Vector3d base = robot.base_in_world().translation();
  const double reach = kReachShare * robot.reach();
  std::vector<Support> all = supports;
  AddFloors(scene_, base, reach, all);
  const BaseRange anywhere{.distance = {0, reach}};
  for (const Support& support : all) {
    for (const BaseRange& range : {wanted, anywhere}) {
      const double half = std::min(reach, range.distance[1] + kObjectGap);
      const std::optional<Support> patch = PatchAround(support, base, half);
      if (!patch) continue;
      const Place place{robot, *patch, range};
      Rng rng = Rng::Stream(0, "prepared places");
      BodyPoses tried;
      if (TryPlaces(place, tried, rng)) return {place};
    }
  }
  return {};
}

bool PreparedObjects::TryPlaces(const Place& place, BodyPoses& starts, Rng& rng) const {
  const Pose base = place.robot.base_in_world();
  const double reach = kReachShare * place.robot.reach();
  std::vector<SceneObject> objects = objects_;
  std::vector<bool> is_placed(objects.size(), false);
  for (size_t i = 0; i < objects.size(); ++i) {
    for (const auto& [body, pose] : starts) {
      if (body != bodies_[i]) continue;
      is_placed[i] = true;
      objects[i].fixed = true;  // the others keep clear of it
      objects[i].pos = ToVec3(pose.translation());
      objects[i].quat = pose.quaternion();
    }
  }
  for (int t = 0; t < kDraws; ++t) {
    if (!PlaceOn(place.patch, sizes_, objects, rng)) continue;
    bool fits = true;
    for (size_t i = 0; i < objects.size() && fits; ++i) {
      const Eigen::Vector3d way = objects[i].pose().translation() - base.translation();
      const double distance = way.head<2>().norm();
      fits = is_placed[i] || way.norm() <= reach;
      if (i == 0 && !is_placed[i]) {
        fits = fits && distance >= place.distance.distance[0] &&
               distance <= place.distance.distance[1];
      }
    }
    if (!fits) continue;
    for (size_t i = 0; i < objects.size(); ++i) {
      if (!is_placed[i]) starts.emplace_back(bodies_[i], objects[i].pose());
    }
    return true;
  }
  return false;
}

std::vector<std::string> PreparedObjects::names() const {
  std::vector<std::string> names;
  for (const SceneObject& object : objects_) names.push_back(object.name);
  return names;
}

void PreparedObjects::AddPlaces(BodyPoses& starts, Rng& rng) const {
  if (!has_support()) return;
  TryPlaces(places_[rng.UniformInt(places_.size())], starts, rng);
}

std::vector<std::string> PreparedObjects::Unplaced() const {
  std::vector<std::string> unplaced;
  for (size_t i = 0; i < objects_.size(); ++i) {
    if (scene_.body_pose(bodies_[i]).is_close(compiled_[i], kSamePlace, kSamePlace))
      unplaced.push_back(objects_[i].name);
  }
  return unplaced;
}

std::vector<std::string> PreparedObjects::PlacedHere(const BodyPoses& starts) const {
  std::vector<std::string> placed;
  for (size_t i = 0; i < objects_.size(); ++i) {
    for (const auto& [body, pose] : starts) {
      if (body == bodies_[i] && scene_.body_pose(body).is_close(pose, kSamePlace, kSamePlace))
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
      ListNames(names()));
}

}  // namespace robocell::internal
