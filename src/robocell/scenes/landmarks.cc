#include "robocell/scenes/landmarks.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <Eigen/Geometry>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {
namespace {

constexpr double kNearlyLevel = 0.985;  // cosine of ten degrees
constexpr double kSameTop = 0.002;      // metres between heights of one level top
constexpr double kGroundGap = 0.02;     // metres by which an object may be above its ground
constexpr double kFloorHalf = 2;        // metres; half size of an endless floor around an object
constexpr int kTopGrid = 5;

double Area(const LevelArea& spot) { return spot.half_x * spot.half_y; }

void LargestFirst(std::vector<LevelArea>& spots) {
  std::ranges::stable_sort(spots, std::greater<>(), Area);
}

// Sets the lowest face of a hollow; returns false if none is level.
bool FloorOf(const Container& container, LevelArea& spot) {
  const Eigen::Matrix3d axes = container.frame_to_world.rotation();
  Eigen::Index up;
  if (axes.row(2).cwiseAbs().maxCoeff(&up) < kNearlyLevel) return false;
  const Eigen::Index along = (up + 1) % 3, across = (up + 2) % 3;
  const Eigen::Vector3d x = axes.col(along);
  const double yaw = std::atan2(x.y(), x.x());
  const Eigen::Vector3d floor = container.frame_to_world.translation() -
                                container.half_extents[up] * Eigen::Vector3d::UnitZ();
  spot = {Pose::FromRpy({floor.x(), floor.y(), floor.z()}, {0, 0, yaw}),
          container.half_extents[along], container.half_extents[across]};
  return true;
}

bool IsOver(const LevelArea& spot, const Eigen::Vector3d& at) {
  const Eigen::Vector3d in_spot = spot.frame_to_world.inverse() * at;
  return std::abs(in_spot.x()) <= spot.half_x && std::abs(in_spot.y()) <= spot.half_y;
}

}  // namespace

int FindObjectOrBody(const Scene& scene, const std::string& name) {
  const mjModel* m = scene.model();
  for (const SceneObject& object : scene.compiled()->spec().objects) {
    if (object.name == name) return FindId(m, mjOBJ_BODY, scene.compiled()->object(name).root_body);
  }
  const int body = FindId(m, mjOBJ_BODY, name);
  return body > 0 ? body : -1;
}

int RequireObjectOrBody(const Scene& scene, const std::string& name) {
  const int body = FindObjectOrBody(scene, name);
  if (body >= 0) return body;
  throw NotFoundError(NoSuchName("scene '" + scene.name() + "'", "object or body", name,
                                 NamesOfObjectsAndBodies(scene)));
}

std::vector<std::string> NamesOfObjectsAndBodies(const Scene& scene) {
  std::vector<std::string> names;
  for (const SceneObject& object : scene.compiled()->spec().objects) names.push_back(object.name);
  for (const std::string& body : ElementNames(scene.model(), mjOBJ_BODY)) {
    if (body != "world" && std::ranges::find(names, body) == names.end()) names.push_back(body);
  }
  return names;
}

Landmarks::Landmarks(Scene scene, SceneAnnotations annotations)
    : scene_(std::move(scene)), annotations_(std::move(annotations)) {}

bool Landmarks::IsPartOf(const std::string& part, int body) const {
  const int id = FindId(scene_.model(), mjOBJ_BODY, part);
  return id >= 0 && IsInSubtree(scene_.model(), id, body);
}

std::vector<LevelArea> Landmarks::Tops(const std::string& name) const {
  const int body = RequireBody(name);
  std::vector<LevelArea> tops;
  for (const SupportFace& support : annotations_.supports) {
    if (IsPartOf(support.body, body)) tops.push_back(support.face.area());
  }
  if (tops.empty()) return MiddleOfTop(body);
  LargestFirst(tops);
  return tops;
}

std::vector<LevelArea> Landmarks::Floors(const std::string& name) const {
  const int body = RequireBody(name);
  std::vector<LevelArea> floors;
  for (const Container& container : annotations_.containers) {
    LevelArea spot;
    if (IsPartOf(container.body, body) && FloorOf(container, spot)) floors.push_back(spot);
  }
  LargestFirst(floors);
  return floors;
}

// Measures by rays from above, because a tray's floor is below its rims. Returns the largest part
// of its bounding rectangle around the origin that is as high as its middle.
std::vector<LevelArea> Landmarks::MiddleOfTop(int body) const {
  const mjModel* m = scene_.model();
  const mjData* d = scene_.data();
  const std::vector<int> geoms = CollisionGeomsOf(m, body);
  const Pose at = Pose::FromTranslationAndMatrix(d->xpos + 3 * body, d->xmat + 9 * body);
  const double yaw = std::atan2(at.rotation()(1, 0), at.rotation()(0, 0));
  const Eigen::Matrix3d axes = Pose::FromRpy({0, 0, 0}, {0, 0, yaw}).rotation();
  Eigen::AlignedBox3d bounds;  // along these axes
  for (const int g : geoms) {
    Eigen::Vector3d low, high;
    for (int axis = 0; axis < 3; ++axis) {
      const Interval extent = GeomExtent(m, d, g, axes.col(axis));
      low[axis] = extent.lower;
      high[axis] = extent.upper;
    }
    if (low.allFinite() && high.allFinite()) bounds.extend(low).extend(high);
  }
  if (bounds.isEmpty()) return {};
  const auto height = [&](double x, double y) {
    Eigen::Vector3d from = axes * Eigen::Vector3d(x, y, 0);
    from.z() = bounds.max().z() + 1;
    return from.z() - CastRay(m, d, geoms, from, -Eigen::Vector3d::UnitZ()).distance;
  };
  const Eigen::Vector3d middle = bounds.center(), half = bounds.sizes() / 2;
  const double top = height(middle.x(), middle.y());
  if (!std::isfinite(top)) return {};
  // Rays that miss end infinitely deep.
  const auto level_within = [&](double share) {
    for (int i = 0; i < kTopGrid * kTopGrid; ++i) {
      const int column = i % kTopGrid, row = i / kTopGrid;
      const double x = middle.x() + share * half.x() * (2.0 * column / (kTopGrid - 1) - 1);
      const double y = middle.y() + share * half.y() * (2.0 * row / (kTopGrid - 1) - 1);
      if (!(std::abs(height(x, y) - top) < kSameTop)) return false;
    }
    return true;
  };
  double level = 0;
  for (const double share : {0.2, 0.4, 0.6, 0.8, 0.99}) {
    if (!level_within(share)) break;
    level = share;
  }
  const Eigen::Vector3d in_world = axes * Eigen::Vector3d(middle.x(), middle.y(), 0);
  return {{Pose::FromRpy({in_world.x(), in_world.y(), top}, {0, 0, yaw}), level * half.x(),
           level * half.y()}};
}

double Landmarks::LowestOf(int body) const {
  const mjModel* m = scene_.model();
  double lowest = std::numeric_limits<double>::infinity();
  for (const int g : CollisionGeomsOf(m, body)) {
    lowest = std::min(lowest, GeomExtent(m, scene_.data(), g, Eigen::Vector3d::UnitZ()).lower);
  }
  return lowest;
}

LevelArea Landmarks::Ground(const std::string& name) const {
  const int body = RequireBody(name);
  const double lowest = LowestOf(body);
  Eigen::Vector3d at = Origin(name);
  if (!std::isfinite(lowest)) return {Pose(at), 0, 0};
  at.z() = lowest;
  return NextUnder(at, body);
}

LevelArea Landmarks::NextUnder(const Eigen::Vector3d& at, int without) const {
  const mjModel* m = scene_.model();
  const mjData* d = scene_.data();
  const auto counts = [&](const std::string& part) {
    return without < 0 || !IsPartOf(part, without);
  };
  LevelArea ground{Pose(at), 0, 0};
  double highest = -std::numeric_limits<double>::infinity();
  const auto take = [&](const LevelArea& spot) {
    const double height = spot.frame_to_world.translation().z();
    if (height < highest || height > at.z() + kGroundGap || !IsOver(spot, at)) return;
    highest = height;
    ground = spot;
  };
  for (const SupportFace& support : annotations_.supports) {
    if (counts(support.body)) take(support.face.area());
  }
  for (const Container& container : annotations_.containers) {
    LevelArea spot;
    if (counts(container.body) && FloorOf(container, spot)) take(spot);
  }
  for (int g = 0; g < m->ngeom; ++g) {
    if (m->geom_type[g] != mjGEOM_PLANE || !IsCollisionGeom(m, g)) continue;
    if (d->geom_xmat[9 * g + 8] < kNearlyLevel) continue;  // a wall
    const Eigen::Vector3d below(at.x(), at.y(), d->geom_xpos[3 * g + 2]);
    const mjtNum* half = m->geom_size + 3 * g;  // 0 for endless
    if (half[0] <= 0 || half[1] <= 0)
      take({Pose(below), kFloorHalf, kFloorHalf});
    else
      take({Pose::FromTranslationAndMatrix(d->geom_xpos + 3 * g, d->geom_xmat + 9 * g), half[0],
            half[1]});
  }
  return ground;
}

Eigen::Vector3d Landmarks::Origin(const std::string& name) const {
  return Eigen::Map<const Eigen::Vector3d>(scene_.data()->xpos + 3 * RequireBody(name));
}

double Landmarks::ReachAlong(const std::string& name, const Eigen::Vector3d& direction) const {
  const int body = RequireBody(name);
  double reach = 0;
  for (const int g : CollisionGeomsOf(scene_.model(), body)) {
    reach = std::max(reach, GeomExtent(scene_.model(), scene_.data(), g, direction).upper -
                                Origin(name).dot(direction));
  }
  return reach;
}

}  // namespace robocell::internal
