#include "robocell/scenes/spatial_relation.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/body_handle.h"
#include "robocell/scenes/hollows.h"
#include "robocell/scenes/landmarks.h"

namespace robocell {
namespace {

constexpr double kBelowRim = 0.005;    // metres by which an object inside reaches below the rim
constexpr double kBelowFloor = 0.005;  // depth by which contacts may press into a hollow's floor
constexpr double kFromAbove = 0.5;     // least cosine between a contact's normal and the vertical

std::string BodyNameOf(const Scene& scene, const std::string& name) {
  return ElementName(scene.model(), mjOBJ_BODY, internal::RequireObjectOrBody(scene, name));
}

// A hollow of one of the reference's bodies.
struct HollowOf {
  BodyHandle body;
  internal::Hollow hollow;
};

}  // namespace

struct SpatialRelation::Impl {
  Scene scene;
  BodyHandle object, reference;
  Relation relation;
  double most_gap;
  std::vector<HollowOf> hollows;
  struct AtRest {
    uint64_t generation;
    std::array<Pose, 2> poses;
    bool is_on_top;
  };
  mutable std::optional<AtRest> at_rest = {};

  // An object that is taller than a tray is in it all the same: it reaches below the rim, with its
  // centre over the hollow.
  bool IsInside() const {
    const Eigen::Vector3d middle(scene.data()->subtree_com + 3 * object.id());
    return std::ranges::any_of(hollows, [&](const HollowOf& each) {
      const Pose body = each.body.pose_in_world();
      const Eigen::Vector3d at = body.inverse() * middle - each.hollow.middle;
      const Eigen::Vector3d& opening = each.hollow.opening;
      double depth = 0;  // half
      for (int axis = 0; axis < 3; ++axis) {
        const double half = each.hollow.half_extents[static_cast<size_t>(axis)];
        if (std::abs(opening[axis]) > 0.5)
          depth = half;
        else if (std::abs(at[axis]) > half)
          return false;
      }
      const Eigen::Vector3d out = body.rotation() * opening;
      const double lowest = ExtentOf(object.id(), out).lower - (body * each.hollow.middle).dot(out);
      return lowest < depth - std::min(kBelowRim, depth) && lowest > -depth - kBelowFloor;
    });
  }

  bool IsOnTop() const { return AreAtRest() ? WasOnTop() : IsOnTop(scene.data()); }

  // The engine has no contacts between what sleeps and what does not move.
  bool AreAtRest() const {
    if (!(scene.model()->opt.enableflags & mjENBL_SLEEP)) return false;
    const int* awake = scene.data()->body_awake;
    return awake[object.id()] != mjS_AWAKE && awake[reference.id()] != mjS_AWAKE;
  }

  // Finds the contacts of the two once for each place where they are at rest.
  bool WasOnTop() const {
    const std::array<Pose, 2> poses = {object.pose_in_world(), reference.pose_in_world()};
    if (!at_rest || at_rest->generation != scene.generation() || at_rest->poses != poses) {
      mjModel view = *scene.model();  // shallow
      view.opt.enableflags &= ~mjENBL_SLEEP;
      const DataPtr data = MakeData(&view);
      mj_copyState(&view, scene.data(), data.get(), mjSTATE_INTEGRATION);
      internal::Guarded("SpatialRelation", data.get(), [&] {
        mj_kinematics(&view, data.get());
        mj_comPos(&view, data.get());
        mj_collision(&view, data.get());
      });
      at_rest = AtRest{scene.generation(), poses, IsOnTop(data.get())};
    }
    return at_rest->is_on_top;
  }

  // Finds contacts between the two whose normal, from the reference to the object, points up.
  bool IsOnTop(const mjData* d) const {
    const mjModel* m = scene.model();
    for (int c = 0; c < d->ncon; ++c) {
      const mjContact& contact = d->contact[c];
      if (contact.exclude != 0 || contact.geom[0] < 0 || contact.geom[1] < 0) continue;
      const int a = m->geom_bodyid[contact.geom[0]], b = m->geom_bodyid[contact.geom[1]];
      const double up = contact.frame[2];  // normal from a to b
      if (internal::IsInSubtree(m, a, reference.id()) && internal::IsInSubtree(m, b, object.id()) &&
          up > kFromAbove)
        return true;
      if (internal::IsInSubtree(m, b, reference.id()) && internal::IsInSubtree(m, a, object.id()) &&
          -up > kFromAbove)
        return true;
    }
    return false;
  }

  bool IsNextTo() const {
    if (IsInside() || IsOnTop()) return false;
    const Eigen::Vector3d from(scene.data()->subtree_com + 3 * reference.id());
    const Eigen::Vector3d to(scene.data()->subtree_com + 3 * object.id());
    Eigen::Vector3d direction = to - from;
    direction.z() = 0;
    if (direction.norm() < mjMINVAL) return false;
    direction.normalize();
    const Interval near = ExtentOf(reference.id(), direction),
                   far = ExtentOf(object.id(), direction);
    if (far.lower - near.upper > most_gap) return false;
    // Requires that they are beside each other, not one high above the other.
    const Interval low = ExtentOf(reference.id(), Eigen::Vector3d::UnitZ());
    const Interval high = ExtentOf(object.id(), Eigen::Vector3d::UnitZ());
    return low.lower < high.upper && high.lower < low.upper;
  }

  Interval ExtentOf(int body, const Eigen::Vector3d& direction) const {
    Interval all{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const int g : internal::CollisionGeomsOf(scene.model(), body)) {
      const Interval extent = internal::GeomExtent(scene.model(), scene.data(), g, direction);
      all.lower = std::min(all.lower, extent.lower);
      all.upper = std::max(all.upper, extent.upper);
    }
    return all;
  }
};

SpatialRelation::SpatialRelation(const Scene& scene, const std::string& object, Relation relation,
                                 const std::string& reference, double most_gap)
    : impl_(new Impl{.scene = scene,
                     .object = BodyHandle(scene, BodyNameOf(scene, object)),
                     .reference = BodyHandle(scene, BodyNameOf(scene, reference)),
                     .relation = relation,
                     .most_gap = most_gap,
                     .hollows = {}}) {
  if (!(most_gap >= 0) || !std::isfinite(most_gap)) {
    throw ArgumentError(
        fmt::format("SpatialRelation: most_gap is {:g} m, it cannot be negative", most_gap));
  }
  const mjModel* m = scene.model();
  for (const auto& [name, body] :
       {std::pair(object, impl_->object.id()), std::pair(reference, impl_->reference.id())}) {
    if (internal::CollisionGeomsOf(m, body).empty()) {
      throw ArgumentError(fmt::format(
          "SpatialRelation: '{}' has no shape that collides, so that nothing can be {} it", name,
          ToString(relation)));
    }
  }
  if (relation == Relation::kOnTopOf) return;
  for (const internal::HollowOfBody& found : internal::FindHollows(scene, impl_->reference.id()))
    impl_->hollows.push_back(
        {BodyHandle(scene, ElementName(m, mjOBJ_BODY, found.body)), found.hollow});
  if (relation == Relation::kInside && impl_->hollows.empty()) {
    throw ArgumentError(
        fmt::format("SpatialRelation: '{}' has no hollow, so that '{}' cannot be inside it",
                    reference, object));
  }
}

SpatialRelation::~SpatialRelation() = default;
SpatialRelation::SpatialRelation(SpatialRelation&&) noexcept = default;
SpatialRelation& SpatialRelation::operator=(SpatialRelation&&) noexcept = default;

const Scene& SpatialRelation::scene() const { return impl_->scene; }

bool SpatialRelation::Holds() const {
  switch (impl_->relation) {
    case Relation::kOnTopOf:
      return impl_->IsOnTop();
    case Relation::kInside:
      return impl_->IsInside();
    case Relation::kNextTo:
      break;
  }
  return impl_->IsNextTo();
}

}  // namespace robocell
