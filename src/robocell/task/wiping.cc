#include "robocell/task/wiping.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/scenes/landmarks.h"
#include "robocell/task/held.h"
#include "robocell/task/held_paths.h"

namespace robocell::internal {
namespace {

constexpr double kThrough = 0.005;   // m below the region from which the object is looked for ...
constexpr double kNearCell = 0.004;  // ... and over the region up to which it covers a cell
constexpr double kLaneShare = 0.75;  // distance of lanes as a share of the object's width
constexpr double kOverEdge = 0.3;    // share of the object that goes beyond the ends of a lane

int BodyOfRegion(const Scene& scene, const std::string& name) {
  const int geom = FindId(scene.model(), mjOBJ_GEOM, name);
  return geom >= 0 ? scene.model()->geom_bodyid[geom] : RequireObjectOrBody(scene, name);
}

}  // namespace

WipeRegion::WipeRegion(const Scene& scene, const std::string& name)
    : scene_(scene.inner()),
      body_(scene_, ElementName(scene.model(), mjOBJ_BODY, BodyOfRegion(scene, name))) {
  const mjModel* m = scene.model();
  int geom = FindId(m, mjOBJ_GEOM, name);
  const int body = body_.id();
  for (int g = m->body_geomadr[body]; geom < 0 && g < m->body_geomadr[body] + m->body_geomnum[body];
       ++g) {
    const bool is_largest =
        std::all_of(m->geom_rbound + m->body_geomadr[body],
                    m->geom_rbound + m->body_geomadr[body] + m->body_geomnum[body],
                    [&](double other) { return other <= m->geom_rbound[g]; });
    if (is_largest) geom = g;
  }
  const bool is_box = geom >= 0 && m->geom_type[geom] == mjGEOM_BOX;
  if (geom < 0 || (!is_box && m->geom_type[geom] != mjGEOM_CYLINDER))
    throw ArgumentError(
        fmt::format("scene '{}': '{}' is no region to wipe; a region is a geom that is a box or a "
                    "cylinder",
                    scene.name(), name));
  const mjtNum* size = m->geom_size + 3 * geom;
  offset_ = geom - m->body_geomadr[body];
  half_[0] = size[0];
  half_[1] = is_box ? size[1] : size[0];
  height_ = is_box ? size[2] : size[1];
  const int columns = std::max(1, static_cast<int>(std::lround(2 * half_[0] / kWipeCell)));
  const int rows = std::max(1, static_cast<int>(std::lround(2 * half_[1] / kWipeCell)));
  for (int column = 0; column < columns; ++column) {
    for (int row = 0; row < rows; ++row) {
      const Eigen::Vector2d at(half_[0] * (2 * (column + 0.5) / columns - 1),
                               half_[1] * (2 * (row + 0.5) / rows - 1));
      if (is_box || at.norm() <= half_[0]) cells_.push_back(at);
    }
  }
}

Pose WipeRegion::frame() const {
  const mjData* d = scene_.data();
  const int geom = scene_.model()->body_geomadr[body_.id()] + offset_;
  return Pose::FromTranslationAndMatrix(d->geom_xpos + 3 * geom, d->geom_xmat + 9 * geom) *
         Pose(Eigen::Vector3d(0, 0, height_));
}

Wiped::Wiped(const Scene& scene, const StatedRelation& stated)
    : scene_(scene.inner()),
      object_(scene_,
              ElementName(scene.model(), mjOBJ_BODY, RequireObjectOrBody(scene, stated.subject))),
      region_(scene, stated.reference),
      share_(stated.numbers[0]),
      wiped_(region_.cells().size(), 0) {}

bool Wiped::Holds() const { return Progress() >= share_ * (1 - 1e-9); }

double Wiped::Progress() const {
  return std::accumulate(wiped_.begin(), wiped_.end(), 0.0) / static_cast<double>(wiped_.size());
}

RelationSamples Wiped::Sample(Rng& /*rng*/, int /*count*/) const { return {}; }

void Wiped::Watch() {
  const double force = ForceOnOthers(scene_, object_.body().id());
  if (force < kLeastWipeForce || force > kMostWipeForce) return;
  const std::vector<int>& geoms = object_.ids();
  const Pose frame = region_.frame();
  const Eigen::Vector3d up = frame.rotation().col(2);
  for (size_t cell = 0; cell < wiped_.size(); ++cell) {
    if (wiped_[cell] != 0) continue;
    const Eigen::Vector2d& at = region_.cells()[cell];
    const Eigen::Vector3d from = frame * Eigen::Vector3d(at.x(), at.y(), -kThrough);
    if (CastRay(scene_.model(), scene_.data(), geoms, from, up).distance < kThrough + kNearCell)
      wiped_[cell] = 1;
  }
}

void Wiped::Recall(std::span<const double> memory) { wiped_.assign(memory.begin(), memory.end()); }

RelationKind WipedRelation() {
  return {.reference = RelationReference::kRequired,
          .defaults = {0.8},
          .numbers_text = "the share of the region",
          .comparison = ">=",
          .is_share = true,
          .words = "wipe the {1} with the {0}",
          .bind = [](const Scene& scene, const StatedRelation& stated) {
            return std::make_unique<Wiped>(scene, stated);
          }};
}

std::vector<HeldPath> WipePaths(const Scene& scene, const StatedRelation& stated,
                                const Pose& lifted) {
  const WipeRegion region(scene, stated.reference);
  const int body = RequireObjectOrBody(scene, stated.subject);
  const Pose now =
      Pose::FromTranslationAndMatrix(scene.data()->xpos + 3 * body, scene.data()->xmat + 9 * body);
  // The object's extents along its own axes. Its z axis stays that of the region.
  Eigen::Vector3d half, middle;
  double below = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d direction = now.rotation().col(axis);
    const Interval extent = BodyExtent(scene.model(), scene.data(), body, direction);
    const double origin = now.translation().dot(direction);
    half[axis] = (extent.upper - extent.lower) / 2;
    middle[axis] = (extent.upper + extent.lower) / 2 - origin;
    if (axis == 2) below = origin - extent.lower;
  }
  const Pose frame = region.frame();
  const bool is_long_x = region.half_x() >= region.half_y();
  const double along = is_long_x ? region.half_x() : region.half_y();
  const double across = is_long_x ? region.half_y() : region.half_x();
  const double near_yaw = (frame.inverse() * lifted).rpy().z();
  std::vector<HeldPath> paths;
  // The object's longer side lies across the lanes, either way round; or along them.
  for (const bool is_wide : {true, false}) {
    for (const double turn : {0.0, kPi}) {
      const bool y_across = (half.y() >= half.x()) == is_wide;  // of the object
      const double wide = y_across ? half.y() : half.x(), deep = y_across ? half.x() : half.y();
      const double yaw = turn + (is_long_x == y_across ? 0 : kPi / 2);
      const int lanes =
          std::max(1, static_cast<int>(std::ceil(across / (kLaneShare * wide) - 1e-9)));
      const double reach = std::max(0.0, along - (1 - 2 * kOverEdge) * deep);
      const double side = lanes == 1 ? 0 : std::max(0.0, across - (1 - 2 * kOverEdge) * wide);
      const auto at = [&](double u, double v) {
        const Eigen::Vector3d place =
            is_long_x ? Eigen::Vector3d(u, v, 0) : Eigen::Vector3d(v, u, 0);
        const Pose turned = Pose::FromRpy({0, 0, 0}, {0, 0, yaw});
        const Eigen::Vector3d off = turned * Eigen::Vector3d(middle.x(), middle.y(), 0);
        return frame *
               Pose::FromRpy(place - off + Eigen::Vector3d(0, 0, below + kOverWiped), {0, 0, yaw});
      };
      HeldPath path;
      for (int lane = 0; lane < lanes; ++lane) {
        const double v = lanes == 1 ? 0 : side * (2.0 * lane / (lanes - 1) - 1);
        const double from = lane % 2 == 0 ? -reach : reach;
        if (path.empty())
          path.push_back(at(from, v));
        else
          AppendStraight(path, at(from, v));
        AppendStraight(path, at(-from, v));
      }
      paths.push_back(path);
      paths.emplace_back(path.rbegin(), path.rend());
    }
  }
  std::ranges::stable_sort(paths, {}, [&](const HeldPath& path) {
    const double yaw = (frame.inverse() * path.front()).rpy().z() - near_yaw;
    return std::abs(std::remainder(yaw, 2 * kPi));
  });
  return paths;
}

}  // namespace robocell::internal
