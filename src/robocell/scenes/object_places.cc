#include "robocell/scenes/object_places.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <optional>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "robocell/base/units.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/robot/move_group.h"

namespace robocell::internal {
namespace {

constexpr int kTries = 60;
constexpr double kDrop = 0.001;  // metres above the support, from where it settles

struct Disc {
  Eigen::Vector2d at;
  double radius;
};

bool IsFree(const Disc& disc, const std::vector<Disc>& taken) {
  return std::all_of(taken.begin(), taken.end(), [&](const Disc& other) {
    return (disc.at - other.at).norm() > disc.radius + other.radius + kObjectGap;
  });
}

// What hangs higher than `room` is in nobody's way.
bool IsClearOf(const Disc& disc, std::span<const OverSupport> over, double room) {
  return std::ranges::none_of(over, [&](const OverSupport& each) {
    return each.bottom <= room && each.outline.exteriorDistance(disc.at) < disc.radius + kObjectGap;
  });
}

// Returns a free place on the support, in its frame.
std::optional<Disc> FindPlace(const Support& support, double radius, const std::vector<Disc>& taken,
                              std::span<const OverSupport> over, double room, Rng& rng) {
  const double x = support.half_x - kEdgeMargin - radius, y = support.half_y - kEdgeMargin - radius;
  if (x <= 0 || y <= 0) return std::nullopt;
  for (int t = 0; t < kTries; ++t) {
    const double across = rng.Uniform(-y, y), along = rng.Uniform(-x, x);  // in this order
    const Disc disc{{along, across}, radius};
    if (IsFree(disc, taken) && IsClearOf(disc, over, room)) return disc;
  }
  return std::nullopt;
}

}  // namespace

// The engine turns a mesh to the axes of its inertia, which may be tilted: a box along these would
// reach far above a table that is level. The axes of its body are those that somebody chose.
StillBox StillBoxOf(const mjModel* m, const mjData* d, int geom) {
  if (m->geom_type[geom] != mjGEOM_MESH) {
    const mjtNum* box = m->geom_aabb + 6 * geom;
    const Pose pose =
        Pose::FromTranslationAndMatrix(d->geom_xpos + 3 * geom, d->geom_xmat + 9 * geom);
    return {pose * Pose(Eigen::Vector3d(box)), Eigen::Vector3d(box + 3)};
  }
  const int body = m->geom_bodyid[geom];
  const Pose axes = Pose::FromTranslationAndMatrix(d->xpos + 3 * body, d->xmat + 9 * body);
  const Eigen::Matrix3d turn = axes.rotation();
  StillBox box{Pose(), Eigen::Vector3d::Zero()};
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const Interval along = GeomExtent(m, d, geom, turn.col(k));
    middle += turn.col(k) * (along.lower + along.upper) / 2;
    box.half[k] = (along.upper - along.lower) / 2;
  }
  box.frame_to_world = Pose(middle, turn);
  return box;
}

std::vector<OverSupport> FindOver(const Support& support, std::span<const StillBox> boxes) {
  constexpr double kSunk = 0.005;  // metres; what ends there is the support itself
  const Pose world_to_support = support.frame_to_world.inverse();
  const Eigen::AlignedBox2d face(Eigen::Vector2d(-support.half_x, -support.half_y),
                                 Eigen::Vector2d(support.half_x, support.half_y));
  std::vector<OverSupport> over;
  for (const StillBox& box : boxes) {
    const Pose on = world_to_support * box.frame_to_world;
    const Eigen::Vector3d& middle = on.translation();
    const Eigen::Vector3d half = on.rotation().cwiseAbs() * box.half;
    if (middle.z() + half.z() < kSunk) continue;
    const Eigen::AlignedBox2d outline(Eigen::Vector2d((middle - half).head<2>()),
                                      Eigen::Vector2d((middle + half).head<2>()));
    if (outline.intersects(face)) over.push_back({outline, middle.z() - half.z()});
  }
  return over;
}

bool PlaceOn(const Support& support, std::span<const ObjectSize> sizes,
             std::vector<SceneObject>& objects, Rng& rng, std::span<const OverSupport> over) {
  std::vector<Disc> taken;
  std::vector<size_t> loose;
  for (size_t i = 0; i < objects.size(); ++i) {
    if (!KeepsPose(objects[i])) {
      loose.push_back(i);
      continue;
    }
    const Eigen::Vector3d at = (support.frame_to_world.inverse() * objects[i].pose()).translation();
    taken.push_back({at.head<2>(), sizes[i].radius});
  }
  for (const size_t i : loose) {
    const double own = sizes[i].height + sizes[i].top + kGapAbove;
    auto place = FindPlace(support, sizes[i].radius, taken, over, std::max(own, kRoomAbove), rng);
    if (!place && own < kRoomAbove && !over.empty())
      place = FindPlace(support, sizes[i].radius, taken, over, own, rng);
    if (!place) return false;
    taken.push_back(*place);
    const Pose pose = support.frame_to_world *
                      Pose::FromRpy({place->at.x(), place->at.y(), sizes[i].height + kDrop},
                                    {0, 0, rng.Uniform(-kPi, kPi)});
    objects[i].pos = ToVec3(pose.translation());
    objects[i].quat = pose.quaternion();
  }
  return true;
}

}  // namespace robocell::internal
