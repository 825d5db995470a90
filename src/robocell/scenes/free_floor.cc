#include "robocell/scenes/free_floor.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <Eigen/Geometry>

#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scenes/free_rectangles.h"

namespace robocell::internal {
namespace {

constexpr double kCell = 0.05;          // metres
constexpr double kLevelPlane = 0.9998;  // cosine of one degree
constexpr double kSameFloor = 0.05;     // metres between heights of one floor
constexpr double kThreshold = 0.02;     // lower objects are no obstacles, metres
constexpr double kMostHalf = 25;        // half size of the examined floor, metres
constexpr double kRounding = 1e-9;      // metres
constexpr int kMostAreas = 12;          // areas of one floor

// Returns the corners of a free area with its headroom.
std::vector<Eigen::Vector3d> CornersOf(const FloorArea& area) {
  std::vector<Eigen::Vector3d> corners;
  for (const double x : {-area.half_x, area.half_x}) {
    for (const double y : {-area.half_y, area.half_y}) {
      corners.push_back(area.frame_to_world * Eigen::Vector3d(x, y, 0));
      corners.push_back(area.frame_to_world * Eigen::Vector3d(x, y, kHeadroom / 2));
    }
  }
  return corners;
}

// A level surface to stand on.
struct Floor {
  int geom;
  Pose frame_to_world;  // the middle, z up
  double half_x, half_y;
};

std::optional<Floor> FloorOf(const mjModel* m, const mjData* d, int g) {
  if (!IsCollisionGeom(m, g)) return std::nullopt;
  const Pose at = Pose::FromTranslationAndMatrix(d->geom_xpos + 3 * g, d->geom_xmat + 9 * g);
  const Eigen::Matrix3d axes = at.rotation();
  const mjtNum* size = m->geom_size + 3 * g;
  const double yaw = std::atan2(axes(1, 0), axes(0, 0));
  if (axes(2, 2) < kLevelPlane) return std::nullopt;
  const Eigen::Vector3d& middle = at.translation();
  if (m->geom_type[g] == mjGEOM_PLANE) {
    const double endless = std::numeric_limits<double>::infinity();
    return Floor{g, Pose::FromRpy({middle.x(), middle.y(), middle.z()}, {0, 0, yaw}),
                 size[0] > 0 ? size[0] : endless, size[1] > 0 ? size[1] : endless};
  }
  if (m->geom_type[g] != mjGEOM_BOX || 2 * std::min(size[0], size[1]) < kLeastFloor - kRounding)
    return std::nullopt;
  return Floor{g, Pose::FromRpy({middle.x(), middle.y(), middle.z() + size[2]}, {0, 0, yaw}),
               size[0], size[1]};
}

double HeightOf(const Floor& floor) { return floor.frame_to_world.translation().z(); }

bool IsUnder(const Floor& floor, const Floor& other) {
  const Eigen::Vector3d at = floor.frame_to_world.inverse() * other.frame_to_world.translation();
  return std::abs(at.x()) <= floor.half_x && std::abs(at.y()) <= floor.half_y;
}

// Removes tables: faces as high as furniture above the next floor under their middle, else above
// the lowest floor.
std::vector<Floor> WithoutTables(std::vector<Floor> faces) {
  std::ranges::stable_sort(faces, std::less<>(), HeightOf);
  std::vector<Floor> floors;
  for (const Floor& face : faces) {
    const bool is_stage = 2 * std::min(face.half_x, face.half_y) >= kLeastStage - kRounding;
    double ground = floors.empty() ? HeightOf(face) : HeightOf(floors.front());
    for (const Floor& floor : floors) {
      if (IsUnder(floor, face)) ground = std::max(ground, HeightOf(floor));
    }
    const double above = HeightOf(face) - ground;
    if (is_stage || above <= kLowestFurniture || above >= kHighestFurniture) floors.push_back(face);
  }
  return floors;
}

// The geom's name, else its body's.
std::string NameOf(const mjModel* m, const Floor& floor) {
  const std::string geom = ElementName(m, mjOBJ_GEOM, floor.geom);
  return geom.empty() ? ElementName(m, mjOBJ_BODY, m->geom_bodyid[floor.geom]) : geom;
}

// A floor as a grid of cells that are free or not.
class Grid {
 public:
  explicit Grid(const Floor& floor)
      : floor_(floor),
        nx_(static_cast<int>(2 * floor.half_x / kCell)),
        ny_(static_cast<int>(2 * floor.half_y / kCell)),
        taken_(static_cast<size_t>(nx_) * static_cast<size_t>(ny_), false) {}

  // Marks the cells under the box around a geom, by the outline of its corners.
  void Take(const std::vector<Eigen::Vector3d>& corners) {
    std::vector<Eigen::Vector2d> points;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Eigen::Vector3d& corner : corners) {
      const Eigen::Vector3d at = floor_.frame_to_world.inverse() * corner;
      points.emplace_back(at.x(), at.y());
      low = std::min(low, at.z());
      high = std::max(high, at.z());
    }
    if (high < kThreshold || low > kHeadroom) return;
    // Takes cells whose centre is within half a diagonal of the outline.
    const std::vector<Eigen::Vector2d> hull = ConvexHull(std::move(points));
    const double reach = kCell * std::sqrt(0.5);
    Eigen::AlignedBox2d bounds;
    for (const Eigen::Vector2d& point : hull) bounds.extend(point);
    for (int i = CellAt(bounds.min().x() - reach, nx_); i <= CellAt(bounds.max().x() + reach, nx_);
         ++i) {
      for (int j = CellAt(bounds.min().y() - reach, ny_);
           j <= CellAt(bounds.max().y() + reach, ny_); ++j) {
        if (IsNear(hull, Middle(i, j), reach)) taken_[Index(i, j)] = true;
      }
    }
  }

  // Returns the largest free rectangle and marks it; unset if none is large enough.
  std::optional<FloorArea> TakeLargest() {
    const std::optional<CellRectangle> best =
        internal::TakeLargest(taken_, nx_, ny_, static_cast<int>(kLeastSide / kCell));
    if (!best) return std::nullopt;
    const Eigen::Vector2d middle =
        (Middle(best->i, best->j) + Middle(best->i + best->width - 1, best->j + best->height - 1)) /
        2;
    return FloorArea{
        .frame_to_world = floor_.frame_to_world * Pose(Eigen::Vector3d(middle.x(), middle.y(), 0)),
        .half_x = best->width * kCell / 2,
        .half_y = best->height * kCell / 2};
  }

 private:
  size_t Index(int i, int j) const {
    return static_cast<size_t>(j) * static_cast<size_t>(nx_) + static_cast<size_t>(i);
  }
  Eigen::Vector2d Middle(int i, int j) const {
    return {(i + 0.5) * kCell - nx_ * kCell / 2, (j + 0.5) * kCell - ny_ * kCell / 2};
  }
  static int CellAt(double at, int count) {
    return std::clamp(static_cast<int>(std::floor(at / kCell + count / 2.0)), 0, count - 1);
  }
  static bool IsNear(const std::vector<Eigen::Vector2d>& hull, const Eigen::Vector2d& at,
                     double reach) {
    for (size_t i = 0; i < hull.size(); ++i) {
      const Eigen::Vector2d& from = hull[i];
      const Eigen::Vector2d edge = hull[(i + 1) % hull.size()] - from;
      if (edge.norm() < 1e-9) continue;
      const double outside =
          (edge.y() * (at - from).x() - edge.x() * (at - from).y()) / edge.norm();
      if (outside > reach) return false;
    }
    return true;
  }

  Floor floor_;
  int nx_, ny_;
  std::vector<bool> taken_;
};

// An endless floor ends a little beyond the objects on it.
void Bound(Floor& floor, const std::vector<std::vector<Eigen::Vector3d>>& boxes,
           std::span<const Eigen::Vector3d> points) {
  Eigen::AlignedBox2d content;
  const auto extend = [&](std::span<const Eigen::Vector3d> by) {
    for (const Eigen::Vector3d& point : by) {
      const Eigen::Vector3d at = floor.frame_to_world.inverse() * point;
      content.extend(Eigen::Vector2d(at.x(), at.y()));
    }
  };
  for (const auto& corners : boxes) extend(corners);
  extend(points);
  if (content.isEmpty()) content.extend(Eigen::Vector2d(0, 0));
  Eigen::Vector2d low, high;
  for (int axis = 0; axis < 2; ++axis) {
    const double half = axis == 0 ? floor.half_x : floor.half_y;
    const bool is_endless = std::isinf(half);
    low[axis] = std::max(is_endless ? content.min()[axis] - kMargin : -half, -kMostHalf);
    high[axis] = std::min(is_endless ? content.max()[axis] + kMargin : half, kMostHalf);
  }
  const Eigen::Vector2d middle = (low + high) / 2;
  floor.frame_to_world = floor.frame_to_world * Pose(Eigen::Vector3d(middle.x(), middle.y(), 0));
  floor.half_x = std::max(0.0, (high - low).x() / 2);
  floor.half_y = std::max(0.0, (high - low).y() / 2);
}

}  // namespace

std::vector<Eigen::Vector3d> BoxCornersOf(const mjModel* m, const mjData* d, int g) {
  const Pose at = Pose::FromTranslationAndMatrix(d->geom_xpos + 3 * g, d->geom_xmat + 9 * g);
  const mjtNum* box = m->geom_aabb + 6 * g;
  std::vector<Eigen::Vector3d> corners;
  for (int corner = 0; corner < 8; ++corner) {
    Eigen::Vector3d point(box[0], box[1], box[2]);
    for (int axis = 0; axis < 3; ++axis)
      point[axis] += (corner >> axis & 1 ? 1 : -1) * box[3 + axis];
    corners.push_back(at * point);
  }
  return corners;
}

std::vector<bool> MovedBodies(const Scene& scene, std::span<const std::string> more) {
  const mjModel* m = scene.model();
  std::vector<bool> moved(static_cast<size_t>(m->nbody), false);
  const auto mark = [&](const std::string& root) {
    const int id = FindId(m, mjOBJ_BODY, root);
    for (int body = 1; id > 0 && body < m->nbody; ++body) {
      if (IsInSubtree(m, body, id)) moved[static_cast<size_t>(body)] = true;
    }
  };
  for (const RobotRecord& robot : scene.compiled()->robots()) mark(robot.base_body);
  for (const std::string& object : scene.parked_objects())
    mark(scene.compiled()->object(object).root_body);
  for (const std::string& body : more) mark(body);
  return moved;
}

std::vector<FloorArea> FindFreeFloor(const Scene& scene, const std::vector<bool>& ignored,
                                     std::span<const Eigen::Vector3d> points) {
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  std::vector<Floor> faces;
  for (int g = 0; g < m->ngeom; ++g) {
    if (ignored[static_cast<size_t>(m->geom_bodyid[g])]) continue;
    if (m->body_dofnum[m->body_weldid[m->geom_bodyid[g]]] > 0) continue;
    const std::optional<Floor> floor = FloorOf(m, d, g);
    if (floor) faces.push_back(*floor);
  }
  std::vector<FloorArea> areas;
  for (Floor& floor : WithoutTables(std::move(faces))) {
    const double height = HeightOf(floor);
    std::vector<std::vector<Eigen::Vector3d>> boxes;
    for (int g = 0; g < m->ngeom; ++g) {
      const bool is_thing = m->geom_type[g] != mjGEOM_PLANE && IsCollisionGeom(m, g) &&
                            !ignored[static_cast<size_t>(m->geom_bodyid[g])];
      if (is_thing && g != floor.geom) boxes.push_back(BoxCornersOf(m, d, g));
    }
    Bound(floor, boxes, points);
    Grid grid(floor);
    for (const auto& corners : boxes) grid.Take(corners);
    for (const FloorArea& area : areas) {
      const double offset = area.frame_to_world.translation().z() - height;
      if (std::abs(offset) < kSameFloor) grid.Take(CornersOf(area));
    }
    for (int i = 0; i < kMostAreas; ++i) {
      std::optional<FloorArea> area = grid.TakeLargest();
      if (!area) break;
      area->floor = NameOf(m, floor);
      areas.push_back(*std::move(area));
    }
  }
  std::ranges::stable_sort(areas, [](const FloorArea& a, const FloorArea& b) {
    return a.half_x * a.half_y > b.half_x * b.half_y;
  });
  return areas;
}

}  // namespace robocell::internal
