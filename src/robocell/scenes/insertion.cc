#include "robocell/scenes/insertion.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/base/units.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scenes/landmarks.h"
#include "robocell/scenes/place_overlap.h"

namespace robocell::internal {
namespace {

constexpr double kOffBottom = 0.001;  // m between an inserted object and the bottom
constexpr double kSameDepth = 1e-3;   // m: parts that are as deep as the deepest one
constexpr int kTurns = 16;            // of an object about the axis of the hole

// Returns the name of the site that is a hole, by its own name or that of what it belongs to.
std::string HoleOf(const Scene& scene, const std::string& name) {
  const mjModel* m = scene.model();
  const auto is_hole = [&](int site) {
    return m->site_type[site] == mjGEOM_BOX || m->site_type[site] == mjGEOM_CYLINDER;
  };
  int found = FindId(m, mjOBJ_SITE, name);
  std::vector<std::string> holes;
  if (found < 0) {
    const int body = RequireObjectOrBody(scene, name);
    for (int site = 0; site < m->nsite; ++site) {
      const std::string site_name = ElementName(m, mjOBJ_SITE, site);
      if (!IsInSubtree(m, m->site_bodyid[site], body) || !site_name.ends_with("hole")) continue;
      holes.push_back(site_name);
      found = site;
    }
    if (holes.size() != 1)
      throw ArgumentError(
          fmt::format("scene '{}': '{}' has {}; name the site that fills the hole, a box or a "
                      "cylinder with its z axis out of the mouth",
                      scene.name(), name,
                      holes.empty() ? "no site whose name ends in 'hole'"
                                    : fmt::format("several holes, {}", ListNames(holes))));
  }
  if (!is_hole(found))
    throw ArgumentError(
        fmt::format("scene '{}': site '{}' is no hole; a hole is a box or a cylinder", scene.name(),
                    ElementName(m, mjOBJ_SITE, found)));
  return ElementName(m, mjOBJ_SITE, found);
}

class Inserted final : public BoundRelation {
 public:
  Inserted(const Scene& scene, const StatedRelation& stated)
      : insertion_(scene, stated.subject, stated.reference), share_(stated.numbers[0]) {}
  bool Holds() const override { return Share() >= share_; }
  // Half for being over the hole, half for the depth.
  double Progress() const override {
    if (Holds()) return 1;
    constexpr double kScale = 5;  // 1/m
    const double over = std::max(0.0, -insertion_.Depth());
    const double near = 1 - std::tanh(kScale * std::hypot(over, insertion_.Aside()));
    return 0.5 * near + 0.5 * std::clamp(Share(), 0.0, 1.0);
  }
  RelationSamples Sample(Rng& /*rng*/, int count) const override {
    return {.poses = insertion_.FreePoses(count), .joint = {}};
  }

 private:
  double Share() const { return insertion_.Depth() / insertion_.full_depth(); }
  Insertion insertion_;
  double share_;
};

}  // namespace

Insertion::Insertion(const Scene& scene, const std::string& object, const std::string& hole)
    : scene_(scene.inner()),
      body_(scene_, ElementName(scene.model(), mjOBJ_BODY, RequireObjectOrBody(scene, object))),
      site_(HoleOf(scene, hole)) {
  if (CollisionGeomsOf(scene.model(), body_.id()).empty())
    throw ArgumentError(
        fmt::format("scene '{}': '{}' has no shape that collides", scene.name(), object));
}

Pose Insertion::mouth() const {
  return scene_.site_pose(site_) * Pose(Eigen::Vector3d(0, 0, hole_depth() / 2));
}

double Insertion::hole_depth() const {
  const mjModel* m = scene_.model();
  const int site = FindId(m, mjOBJ_SITE, site_);
  return 2 * (m->site_type[site] == mjGEOM_BOX ? m->site_size[3 * site + 2]
                                               : m->site_size[3 * site + 1]);
}

double Insertion::full_depth() const {
  const Interval length = BodyExtent(scene_.model(), scene_.data(), body_.id(),
                                     body_.pose_in_world().rotation().col(2));
  return std::min(hole_depth(), length.upper - length.lower);
}

// The middle of the geoms that are as deep as the deepest one.
Insertion::Tip Insertion::DeepestPart() const {
  const mjModel* m = scene_.model();
  const mjData* d = scene_.data();
  const Pose mouth_in_world = mouth();
  const Eigen::Vector3d out = mouth_in_world.rotation().col(2);
  const Interval extent = BodyExtent(m, d, body_.id(), out);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  int count = 0;
  for (const int geom : CollisionGeomsOf(m, body_.id())) {
    if (GeomExtent(m, d, geom, out).lower > extent.lower + kSameDepth) continue;
    middle += Eigen::Vector3d(d->geom_xpos + 3 * geom);
    ++count;
  }
  const Eigen::Vector3d at = mouth_in_world.inverse() * Eigen::Vector3d(middle / count);
  const double rim = mouth_in_world.translation().dot(out);
  const double overlap = std::min(rim, extent.upper) - std::max(rim - hole_depth(), extent.lower);
  return {overlap, at.head<2>()};
}

bool Insertion::Contains(const Eigen::Vector2d& in_mouth) const {
  const mjModel* m = scene_.model();
  const int site = FindId(m, mjOBJ_SITE, site_);
  const mjtNum* size = m->site_size + 3 * site;
  if (m->site_type[site] == mjGEOM_CYLINDER) return in_mouth.norm() <= size[0];
  return std::abs(in_mouth.x()) <= size[0] && std::abs(in_mouth.y()) <= size[1];
}

double Insertion::Depth() const {
  const Tip tip = DeepestPart();
  return tip.along > 0 && !Contains(tip.in_mouth) ? 0 : tip.along;
}

double Insertion::Aside() const { return DeepestPart().in_mouth.norm(); }

Pose Insertion::PoseAt(double yaw, double depth) const {
  const Pose now = body_.pose_in_world();
  const Eigen::Vector3d axis = now.rotation().col(2);
  const double below = now.translation().dot(axis) -
                       BodyExtent(scene_.model(), scene_.data(), body_.id(), axis).lower;
  return mouth() * Pose::FromRpy({0, 0, below - depth}, {0, 0, yaw});
}

std::vector<Pose> Insertion::FreePoses(int count) const {
  PlaceOverlap overlap(scene_, body_.id());
  std::vector<Pose> poses;
  for (int i = 0; i < kTurns && static_cast<int>(poses.size()) < count; ++i) {
    const Pose pose = PoseAt(2 * kPi * i / kTurns, full_depth() - kOffBottom);
    if (overlap.IsFree(pose, 0)) poses.push_back(pose);
  }
  return poses;
}

RelationKind InsertedRelation() {
  return {.reference = RelationReference::kRequired,
          .defaults = {0.8},
          .numbers_text = "the depth as a share of the hole",
          .comparison = ">=",
          .is_share = true,
          .words = "insert the {0} into the {1}",
          .bind = [](const Scene& scene, const StatedRelation& stated) {
            return std::make_unique<Inserted>(scene, stated);
          }};
}

}  // namespace robocell::internal
