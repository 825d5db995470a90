#include "robocell/task/pouring.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/math/rotation.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/body_handle.h"
#include "robocell/scenes/landmarks.h"

namespace robocell::internal {
namespace {

constexpr double kPourMargin = 0.03;                        // m between the two vessels
constexpr double kMostPourTilt = 2.3;                       // rad
constexpr double kTiltStep = 0.04;                          // rad
constexpr int kPourDirections = 16;                         // about the vertical
constexpr double kPourTurns[] = {0, -0.8, 0.8, -1.6, 1.6};  // rad, of the vessel on the way

class PouredInto final : public BoundRelation {
 public:
  PouredInto(const Scene& scene, const StatedRelation& stated)
      : vessel_(scene, stated.reference), share_(stated.numbers[0]) {
    for (const std::string& grain : GrainsOf(scene, stated.subject))
      grains_.emplace_back(scene.inner(), scene.compiled()->object(grain).root_body);
    if (grains_.empty())
      throw ArgumentError(fmt::format(
          "scene '{}': '{}' has nothing to pour: no free object is named {}_grain or "
          "{}_grain_0, {}_grain_1 etc.",
          scene.name(), stated.subject, stated.subject, stated.subject, stated.subject));
  }
  bool Holds() const override { return Progress() >= share_ - 1e-9; }
  double Progress() const override {
    const auto inside = std::ranges::count_if(grains_, [&](const BodyHandle& grain) {
      return vessel_.Contains(grain.pose_in_world().translation());
    });
    return static_cast<double>(inside) / static_cast<double>(grains_.size());
  }
  RelationSamples Sample(Rng& /*rng*/, int /*count*/) const override { return {}; }

 private:
  Vessel vessel_;
  std::vector<BodyHandle> grains_;
  double share_;
};

}  // namespace

namespace {

// Returns true for "cup_grain" and "cup_grain_12" of the vessel "cup".
bool IsGrainOf(const std::string& vessel, std::string_view name) {
  const std::string stem = vessel + "_grain";
  if (!name.starts_with(stem)) return false;
  name.remove_prefix(stem.size());
  if (name.empty()) return true;
  if (!name.starts_with('_') || name.size() < 2) return false;
  return std::ranges::all_of(name.substr(1), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::vector<std::string> GrainsOf(const Scene& scene, const std::string& vessel) {
  std::vector<std::string> grains;
  for (const ObjectRecord& object : scene.compiled()->objects()) {
    if (object.free_joint && IsGrainOf(vessel, object.name)) grains.push_back(object.name);
  }
  return grains;
}

Vessel::Vessel(const Scene& scene, const std::string& name)
    : scene_(scene.inner()),
      geoms_(scene_, ElementName(scene.model(), mjOBJ_BODY, RequireObjectOrBody(scene, name))) {
  const std::optional<Hollow> hollow = FindHollow(scene, geoms_.body().id());
  if (!hollow || hollow->opening.z() < 0.5)
    throw ArgumentError(
        fmt::format("scene '{}': '{}' has no hollow that is open upwards", scene.name(), name));
  hollow_ = *hollow;
}

bool Vessel::Contains(const Eigen::Vector3d& point) const {
  const Pose body = pose();
  const Eigen::Vector3d at = body.inverse() * point - hollow_.middle;
  if (std::abs(at.z()) > hollow_.half_extents[2]) return false;
  // Within the walls: a ray to the side hits one from inside.
  const Eigen::Vector3d middle =
      body * Eigen::Vector3d(hollow_.middle + Eigen::Vector3d(0, 0, at.z()));
  const Eigen::Vector3d out = point - middle;
  const double distance = out.norm();
  if (distance < 1e-9) return true;
  return CastRay(scene_.model(), scene_.data(), geoms_.ids(), middle, out / distance).distance >
         distance;
}

Eigen::Vector3d Vessel::mouth() const {
  return hollow_.middle + Eigen::Vector3d(0, 0, hollow_.half_extents[2]);
}

Eigen::Vector3d Vessel::bottom() const {
  return hollow_.middle - Eigen::Vector3d(0, 0, hollow_.half_extents[2]);
}

double Vessel::radius() const { return std::min(hollow_.half_extents[0], hollow_.half_extents[1]); }

RelationKind PouredIntoRelation() {
  return {.reference = RelationReference::kRequired,
          .defaults = {0.8},
          .numbers_text = "the share of the grains",
          .comparison = ">=",
          .is_share = true,
          .words = "pour what is in the {0} into the {1}",
          .bind = [](const Scene& scene, const StatedRelation& stated) {
            return std::make_unique<PouredInto>(scene, stated);
          }};
}

std::vector<HeldPath> PourPaths(const Scene& scene, const StatedRelation& stated,
                                const Pose& lifted) {
  const Vessel from(scene, stated.subject), into(scene, stated.reference);
  const int body = RequireObjectOrBody(scene, stated.subject);
  const Pose now = from.pose();
  double radius = 0;
  for (int axis : {0, 1}) {
    const Eigen::Vector3d direction = now.rotation().col(axis);
    const Interval extent = BodyExtent(scene.model(), scene.data(), body, direction);
    const double origin = now.translation().dot(direction);
    radius = std::max({radius, extent.upper - origin, origin - extent.lower});
  }
  const Eigen::Vector3d own_up = now.rotation().col(2);
  const Interval tall = BodyExtent(scene.model(), scene.data(), body, own_up);
  const Eigen::Vector3d mouth = from.mouth();
  const double length = mouth.z() + now.translation().dot(own_up) - tall.lower;
  const Eigen::Vector3d target = into.pose() * into.mouth();
  std::vector<HeldPath> paths;
  for (const double turn : kPourTurns) {
    for (int i = 0; i < kPourDirections; ++i) {
      const double azimuth = 2 * kPi * i / kPourDirections;
      const Eigen::Vector3d ahead(std::cos(azimuth), std::sin(azimuth), 0);
      const Eigen::Vector3d axis = Eigen::Vector3d::UnitZ().cross(ahead);
      const Quaternion turned = (Pose::FromRpy({0, 0, 0}, {0, 0, turn}) * lifted).quaternion();
      const auto tilted = [&](double tilt) {
        const double low = std::max(length * std::cos(tilt) + radius * std::sin(tilt),
                                    from.radius() * std::sin(tilt));
        const Eigen::Vector3d place =
            target - 0.5 * from.radius() * ahead + (kPourMargin + low) * Eigen::Vector3d::UnitZ();
        const Pose rotation = Pose::FromRotvec(Eigen::Vector3d::Zero(), tilt * axis) *
                              Pose(Eigen::Vector3d::Zero(), turned);
        return Pose(place - rotation * mouth, rotation.quaternion());
      };
      const Pose over = tilted(0);
      // Up first, then across.
      HeldPath path = {lifted};
      if (over.translation().z() > lifted.translation().z()) {
        Eigen::Vector3d up = lifted.translation();
        up.z() = over.translation().z();
        AppendStraight(path, Pose(up, lifted.quaternion()));
      }
      AppendStraight(path, over);
      const int steps = static_cast<int>(std::ceil(kMostPourTilt / kTiltStep));
      for (int k = 1; k <= steps; ++k) path.push_back(tilted(kMostPourTilt * k / steps));
      paths.push_back(std::move(path));
    }
  }
  return paths;
}

}  // namespace robocell::internal
