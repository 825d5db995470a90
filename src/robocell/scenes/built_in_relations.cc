#include "robocell/scenes/built_in_relations.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/base/units.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/body_handle.h"
#include "robocell/scenes/hollows.h"
#include "robocell/scenes/insertion.h"
#include "robocell/scenes/joint_opening.h"
#include "robocell/scenes/landmarks.h"
#include "robocell/scenes/place_overlap.h"
#include "robocell/scenes/spatial_relation.h"

namespace robocell::internal {
namespace {

constexpr double kHollowGap = 0.003;   // m between a sampled object and the walls of a hollow
constexpr double kLevelFloor = 0.98;   // cosine of the tilt of a floor
constexpr double kRegionShare = 0.6;   // of a region that samples lie in, if there is room
constexpr double kWholeRegion = 0.95;  // ... else; less than all, so that the relation surely holds

// An object of a scene whose poses are sampled.
class Subject {
 public:
  Subject(const Scene& scene, const std::string& name)
      : scene_(scene.inner()),
        body_(scene_, ElementName(scene.model(), mjOBJ_BODY, RequireObjectOrBody(scene, name))) {
    if (CollisionGeomsOf(scene.model(), body_.id()).empty())
      throw ArgumentError(
          fmt::format("scene '{}': '{}' has no shape that collides, so that it has "
                      "no place in a relation",
                      scene.name(), name));
  }

  const Scene& scene() const { return scene_; }
  int id() const { return body_.id(); }
  Pose pose() const { return body_.pose_in_world(); }
  Eigen::Vector3d middle() const {
    return Eigen::Vector3d(scene_.data()->subtree_com + 3 * body_.id());
  }
  Interval ExtentAlong(const Eigen::Vector3d& direction) const {
    Interval all{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const int g : CollisionGeomsOf(scene_.model(), body_.id())) {
      const Interval extent = GeomExtent(scene_.model(), scene_.data(), g, direction);
      all.lower = std::min(all.lower, extent.lower);
      all.upper = std::max(all.upper, extent.upper);
    }
    return all;
  }
  double lowest() const { return ExtentAlong(Eigen::Vector3d::UnitZ()).lower; }
  // Returns the largest distance of its outline from its root, seen from above.
  double Radius() const {
    double most = 0;
    for (int i = 0; i < 16; ++i) {
      const double angle = kPi * i / 8;
      const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
      most = std::max(most, ExtentAlong(out).upper - pose().translation().dot(out));
    }
    return most;
  }
  // Returns the pose in which its root is over a point, it stands on a height and is turned about
  // the vertical from now.
  Pose StandingOver(const Eigen::Vector2d& at, double height, double yaw) const {
    const Pose now = pose();
    const Eigen::Vector3d place(at.x(), at.y(), height + now.translation().z() - lowest());
    return {place, (Turn(yaw) * now).quaternion()};
  }
  // The same with its centre of mass over the point.
  Pose CentredOver(const Eigen::Vector2d& at, double height, double yaw) const {
    const Eigen::Vector3d off = Turn(yaw) * Eigen::Vector3d(middle() - pose().translation());
    return StandingOver(at - off.head<2>(), height, yaw);
  }
  static Pose Turn(double yaw) { return Pose::FromRpy({0, 0, 0}, {0, 0, yaw}); }

 private:
  Scene scene_;
  BodyHandle body_;
};

// Draws poses until `count` of them are free of what is there already; fewer where there is little
// room. draw(i): the i-th pose.
constexpr int kDrawsPerPose = 4;
template <class Draw>
RelationSamples DrawFree(const Subject& subject, int count, Draw&& draw) {
  RelationSamples samples;
  PlaceOverlap overlap(subject.scene(), subject.id());
  for (int i = 0; i < kDrawsPerPose * count && static_cast<int>(samples.poses.size()) < count;
       ++i) {
    const Pose pose = draw(i);
    if (overlap.IsFree(pose)) samples.poses.push_back(pose);
  }
  return samples;
}

// Draws poses that stand on level areas, by turns.
RelationSamples StandingOn(const Subject& subject, const std::vector<LevelArea>& areas,
                           double margin, Rng& rng, int count) {
  if (areas.empty()) return {};
  const double radius = subject.Radius() + margin;
  return DrawFree(subject, count, [&](int i) {
    const LevelArea& area = areas[static_cast<size_t>(i) % areas.size()];
    // An object that is wider than a top stands in its middle.
    const double x = std::max(0.0, area.half_x - radius), y = std::max(0.0, area.half_y - radius);
    const double across = rng.Uniform(-x, x), along = rng.Uniform(-y, y);
    const Eigen::Vector3d at = area.frame_to_world * Eigen::Vector3d(across, along, 0);
    return subject.StandingOver(at.head<2>(), at.z(), rng.Uniform(-kPi, kPi));
  });
}

// Returns the level floor of a hollow as its body is now; unset where the hollow is tilted, or open
// downwards.
std::optional<LevelArea> FloorOf(const Scene& scene, const HollowOfBody& found) {
  const mjData* d = scene.data();
  const Pose body =
      Pose::FromTranslationAndMatrix(d->xpos + 3 * found.body, d->xmat + 9 * found.body);
  const Eigen::Matrix3d axes = body.rotation();
  Eigen::Index up = 0;
  if (axes.row(2).cwiseAbs().maxCoeff(&up) < kLevelFloor) return std::nullopt;
  if ((axes * found.hollow.opening).z() < -kLevelFloor) return std::nullopt;
  const auto x = static_cast<size_t>((up + 1) % 3), y = static_cast<size_t>((up + 2) % 3);
  const Eigen::Vector3d side = axes.col(static_cast<Eigen::Index>(x));
  Eigen::Vector3d floor = body * found.hollow.middle;
  floor.z() -= found.hollow.half_extents[static_cast<size_t>(up)];
  return LevelArea{Pose::FromRpy(floor, {0, 0, std::atan2(side.y(), side.x())}),
                   found.hollow.half_extents[x], found.hollow.half_extents[y]};
}

class On final : public BoundRelation {
 public:
  On(const Scene& scene, const StatedRelation& stated)
      : subject_(scene, stated.subject),
        reference_(stated.reference),
        holds_(scene.inner(), stated.subject, Relation::kOnTopOf, stated.reference) {}
  bool Holds() const override { return holds_.Holds(); }
  RelationSamples Sample(Rng& rng, int count) const override {
    const Landmarks marks(subject_.scene(), {});
    return StandingOn(subject_, marks.Tops(reference_), 0, rng, count);
  }

 private:
  Subject subject_;
  std::string reference_;
  SpatialRelation holds_;
};

class Inside final : public BoundRelation {
 public:
  Inside(const Scene& scene, const StatedRelation& stated)
      : subject_(scene, stated.subject),
        reference_(scene, stated.reference),
        holds_(scene.inner(), stated.subject, Relation::kInside, stated.reference) {}
  bool Holds() const override { return holds_.Holds(); }
  RelationSamples Sample(Rng& rng, int count) const override {
    const Scene& scene = subject_.scene();
    std::vector<LevelArea> floors;
    for (const HollowOfBody& found : FindHollows(scene, reference_.id())) {
      if (const auto floor = FloorOf(scene, found)) floors.push_back(*floor);
    }
    return StandingOn(subject_, floors, kHollowGap, rng, count);
  }

 private:
  Subject subject_, reference_;
  SpatialRelation holds_;
};

class NextTo final : public BoundRelation {
 public:
  NextTo(const Scene& scene, const StatedRelation& stated)
      : subject_(scene, stated.subject),
        reference_(scene, stated.reference),
        most_gap_(stated.numbers[0]),
        holds_(scene.inner(), stated.subject, Relation::kNextTo, stated.reference, most_gap_) {}
  bool Holds() const override { return holds_.Holds(); }
  // On what the reference stands on.
  RelationSamples Sample(Rng& rng, int count) const override {
    const double first = rng.Uniform(-kPi, kPi);
    return DrawFree(subject_, count, [&](int i) {
      const double angle = first + 2 * kPi * i / count, yaw = rng.Uniform(-kPi, kPi);
      const double gap = most_gap_ * rng.Uniform(0.3, 0.8);
      const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
      const Eigen::Vector3d from = subject_.middle();
      // The extent of the turned object is that of the object along the direction turned back.
      const Eigen::Vector3d back = Subject::Turn(-yaw) * out;
      const double own = from.dot(back) - subject_.ExtentAlong(back).lower;
      const double reach = reference_.ExtentAlong(out).upper - reference_.middle().dot(out);
      const Eigen::Vector3d at = reference_.middle() + (reach + gap + own) * out;
      return subject_.CentredOver(at.head<2>(), reference_.lowest(), yaw);
    });
  }

 private:
  Subject subject_, reference_;
  double most_gap_;
  SpatialRelation holds_;
};

// The outline of a site, a geom or an object, or a circle in the root frame.
class Region {
 public:
  Region(const Scene& scene, const StatedRelation& stated) : scene_(scene.inner()) {
    if (stated.reference.empty()) {
      frame_ = scene.root_frame_to_world() *
               Pose(Eigen::Vector3d(stated.numbers[0], stated.numbers[1], 0));
      half_ = {stated.numbers[2], stated.numbers[2]};
      return;
    }
    name_ = stated.reference;
    const mjModel* m = scene.model();
    if (const int site = FindId(m, mjOBJ_SITE, name_); site >= 0) {
      type_ = mjOBJ_SITE;
      SetOutline(m->site_type[site], m->site_size + 3 * site);
      return;
    }
    int geom = FindId(m, mjOBJ_GEOM, name_);
    if (geom < 0) {
      const int body = RequireObjectOrBody(scene, name_);
      for (int g = 0; g < m->ngeom; ++g) {
        if (m->geom_bodyid[g] == body && (geom < 0 || m->geom_rbound[g] > m->geom_rbound[geom]))
          geom = g;
      }
      if (geom < 0) {
        throw ArgumentError(fmt::format("scene '{}': '{}' has no geom whose outline is a region",
                                        scene.name(), name_));
      }
      body_ = ElementName(m, mjOBJ_BODY, body);
      offset_ = geom - m->body_geomadr[body];
    }
    type_ = mjOBJ_GEOM;
    SetOutline(m->geom_type[geom], m->geom_size + 3 * geom);
  }

  Pose frame() const {
    const mjModel* m = scene_.model();
    const mjData* d = scene_.data();
    if (type_ == mjOBJ_UNKNOWN) return frame_;
    if (type_ == mjOBJ_SITE) {
      const int site = FindId(m, mjOBJ_SITE, name_);
      return Pose::FromTranslationAndMatrix(d->site_xpos + 3 * site, d->site_xmat + 9 * site);
    }
    const int geom = body_.empty() ? FindId(m, mjOBJ_GEOM, name_)
                                   : m->body_geomadr[FindId(m, mjOBJ_BODY, body_)] + offset_;
    return Pose::FromTranslationAndMatrix(d->geom_xpos + 3 * geom, d->geom_xmat + 9 * geom);
  }
  // Returns 0 in the middle, 1 on the outline, more outside.
  double ShareOf(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d at = frame().inverse() * point;
    const double x = at.x() / half_[0], y = at.y() / half_[1];
    return is_round_ ? std::hypot(x, y) : std::max(std::abs(x), std::abs(y));
  }
  double half() const { return std::min(half_[0], half_[1]); }
  // Returns a point at random, within a share of the region.
  Eigen::Vector3d Draw(double share, Rng& rng) const {
    const double angle = rng.Uniform(-kPi, kPi), radius = share * std::sqrt(rng.Uniform());
    return frame() * Eigen::Vector3d(half_[0] * radius * std::cos(angle),
                                     half_[1] * radius * std::sin(angle), 0);
  }

 private:
  void SetOutline(int type, const mjtNum* size) {
    const bool is_box = type == mjGEOM_BOX;
    if (!is_box && type != mjGEOM_CYLINDER && type != mjGEOM_SPHERE && type != mjGEOM_ELLIPSOID) {
      throw ArgumentError(fmt::format(
          "scene '{}': '{}' is no region; a region is a site or geom that is a box, a cylinder, a "
          "sphere or an ellipsoid",
          scene_.name(), name_));
    }
    is_round_ = !is_box;
    half_ = {size[0], is_box || type == mjGEOM_ELLIPSOID ? size[1] : size[0]};
  }

  Scene scene_;
  std::string name_, body_;  // body_: the object whose geom number offset_ is the region
  int offset_ = 0;
  mjtObj type_ = mjOBJ_UNKNOWN;
  Pose frame_;
  std::array<double, 2> half_ = {0, 0};
  bool is_round_ = true;
};

class InRegion final : public BoundRelation {
 public:
  InRegion(const Scene& scene, const StatedRelation& stated)
      : subject_(scene, stated.subject), region_(scene, stated) {}
  bool Holds() const override { return region_.ShareOf(subject_.middle()) <= 1; }
  double Progress() const override {
    if (Holds()) return 1;
    constexpr double kScale = 5;  // 1/m
    const double away = region_.half() * (region_.ShareOf(subject_.middle()) - 1);
    return 1 - std::tanh(kScale * away);
  }
  // On what the object stands on now. The first pose is the middle of the region, if that is free.
  RelationSamples Sample(Rng& rng, int count) const override {
    return DrawFree(subject_, count, [&](int i) {
      const bool is_tight = i >= kDrawsPerPose / 2 * count;  // about half of the draws failed
      const double share = is_tight ? kWholeRegion : kRegionShare;
      const Eigen::Vector3d at = region_.Draw(i == 0 ? 0 : share, rng);
      return subject_.CentredOver(at.head<2>(), subject_.lowest(),
                                  i == 0 ? 0 : rng.Uniform(-kPi, kPi));
    });
  }

 private:
  Subject subject_;
  Region region_;
};

class IsUpright final : public BoundRelation {
 public:
  IsUpright(const Scene& scene, const StatedRelation& stated)
      : subject_(scene, stated.subject), most_(stated.numbers[0]) {}
  bool Holds() const override { return Tilt() <= most_; }
  double Progress() const override { return Holds() ? 1 : 1 - Tilt() / kPi; }
  // Where it is, as high as it is long.
  RelationSamples Sample(Rng& rng, int count) const override {
    const Pose now = subject_.pose();
    const double lowest = subject_.lowest();
    // Its extent below the root along its own axis.
    const double below = now.translation().dot(Axis()) - subject_.ExtentAlong(Axis()).lower;
    const Eigen::Vector3d at(now.translation().x(), now.translation().y(), lowest + below);
    return DrawFree(subject_, count, [&](int) {
      return Pose::FromRpy(at, {0, 0, rng.Uniform(-kPi, kPi)});
    });
  }

 private:
  Eigen::Vector3d Axis() const { return subject_.pose().rotation().col(2); }
  double Tilt() const { return std::acos(std::clamp(Axis().z(), -1.0, 1.0)); }
  Subject subject_;
  double most_;
};

// Open by a share at least, or at most.
class OpenBy final : public BoundRelation {
 public:
  OpenBy(const Scene& scene, const StatedRelation& stated, bool at_least)
      : opening_(JointOpening::Of(scene, stated.subject)),
        share_(stated.numbers[0]),
        at_least_(at_least) {}
  bool Holds() const override {
    constexpr double kRounding = 1e-9;
    return at_least_ ? opening_.share() >= share_ - kRounding
                     : opening_.share() <= share_ + kRounding;
  }
  double Progress() const override {
    if (Holds()) return 1;
    const double way =
        at_least_ ? opening_.share() / share_ : (1 - opening_.share()) / (1 - share_);
    return std::clamp(way, 0.0, 1.0);
  }
  RelationSamples Sample(Rng& rng, int /*count*/) const override {
    const double share = at_least_ ? rng.Uniform(share_, 1) : rng.Uniform(0, share_);
    return {.poses = {}, .joint = opening_.PositionAt(share)};
  }

 private:
  JointOpening opening_;
  double share_;
  bool at_least_;
};

template <class T>
RelationKind KindOf(RelationKind kind) {
  kind.bind = [](const Scene& scene, const StatedRelation& stated) {
    return std::make_unique<T>(scene, stated);
  };
  return kind;
}

RelationKind KindOfOpening(bool at_least, double share, bool is_momentary,
                           const std::string& words) {
  return {.subject = RelationSubject::kJoint,
          .defaults = {share},
          .numbers_text = "a share of its range",
          .comparison = at_least ? ">=" : "<=",
          .is_momentary = is_momentary,
          .words = words,
          .bind = [at_least](const Scene& scene, const StatedRelation& stated) {
            return std::make_unique<OpenBy>(scene, stated, at_least);
          }};
}

}  // namespace

std::map<std::string, RelationKind> BuiltInRelations() {
  using enum RelationReference;
  return {
      {"on", KindOf<On>({.reference = kRequired, .words = "put the {0} on the {1}"})},
      {"inside", KindOf<Inside>({.reference = kRequired, .words = "put the {0} inside the {1}"})},
      {"next_to", KindOf<NextTo>({.reference = kRequired,
                                  .defaults = {0.05},
                                  .numbers_text = "the largest gap in metres",
                                  .comparison = "<=",
                                  .words = "put the {0} next to the {1}"})},
      {"inserted", InsertedRelation()},
      {"in_region", KindOf<InRegion>({.reference = kOrNumbers,
                                      .numbers_instead = 3,
                                      .numbers_text = "x y radius",
                                      .words = "move the {0} to the {1}"})},
      {"upright", KindOf<IsUpright>({.defaults = {0.2},
                                     .numbers_text = "the largest tilt in rad",
                                     .comparison = "<=",
                                     .words = "set the {0} upright"})},
      {"open", KindOfOpening(true, 0.3, false, "open the {0}")},
      {"closed", KindOfOpening(false, 0.15, false, "close the {0}")},
      {"pressed", KindOfOpening(true, 0.7, true, "press the {0}")},
  };
}

}  // namespace robocell::internal
