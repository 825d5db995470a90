#include "robocell/scenes/support.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/free_floor.h"
#include "robocell/scenes/scene_annotations.h"

namespace robocell {
namespace {

const std::string kSite = "table_top";
constexpr double kLevel = 0.9998;     // cosine of one degree
constexpr double kHalfOfFloor = 0.5;  // most of a floor on which a run puts objects, metres
constexpr double kOnSurface = 0.005;  // metres between the site and the face it is on
// The largest motion of a movable support, m, in this many seconds.
constexpr double kSteady = 0.01, kSteadySeconds = 0.5;

std::string Place(const SceneSpec& base) {
  return "scene '" + base.name + "'" + (base.base ? " from '" + *base.base + "'" : "");
}

// Excludes those of parked objects.
std::vector<std::string> SitesInPlace(const Scene& scene) {
  const mjModel* m = scene.model();
  std::vector<std::string> sites = ElementNames(m, mjOBJ_SITE);
  for (const std::string& object : scene.parked_objects()) {
    const int root = FindId(m, mjOBJ_BODY, scene.compiled()->object(object).root_body);
    std::erase_if(sites, [&](const std::string& site) {
      return internal::IsInSubtree(m, m->site_bodyid[FindId(m, mjOBJ_SITE, site)], root);
    });
  }
  return sites;
}

// Returns the site of this name, else the only one that has it behind a prefix; "" if there is
// none.
std::string FindSite(const Scene& scene, const std::string& place) {
  const std::vector<std::string> sites = SitesInPlace(scene);
  std::vector<std::string> prefixed;
  for (const std::string& site : sites) {
    if (site == kSite) return site;
    if (site.ends_with("_" + kSite) || site.ends_with("/" + kSite)) prefixed.push_back(site);
  }
  if (prefixed.size() == 1) return prefixed.front();
  if (prefixed.empty()) return "";
  throw SpecError(
      fmt::format("{}: several sites could mark the support: {}. Name the right one '{}'", place,
                  ListNames(prefixed), kSite));
}

int SiteBody(const Scene& scene, const std::string& site) {
  return scene.model()->site_bodyid[FindId(scene.model(), mjOBJ_SITE, site)];
}

// Returns the box of the site's body with the largest face; -1 without any.
int LargestBox(const mjModel* m, int body) {
  int largest = -1;
  double area = 0;
  for (int g = m->body_geomadr[body]; g < m->body_geomadr[body] + m->body_geomnum[body]; ++g) {
    if (m->geom_type[g] != mjGEOM_BOX) continue;
    const mjtNum* size = m->geom_size + 3 * g;
    const double face = std::max({size[0] * size[1], size[1] * size[2], size[2] * size[0]});
    if (face <= area) continue;
    area = face;
    largest = g;
  }
  return largest;
}

// The face of a box that points along the site's z axis, in the site's frame.
class Face {
 public:
  Face(const mjModel* m, const Pose& site_to_world, const Pose& box_to_world, int geom) {
    const Pose box_to_site = site_to_world.inverse() * box_to_world;
    const Eigen::Matrix3d axes = box_to_site.rotation();
    Eigen::Index up;
    alignment_ = axes.row(2).cwiseAbs().maxCoeff(&up);
    // Uses the box axis that is nearest to the site's x, so that an aligned box is not turned.
    Eigen::Index along = (up + 1) % 3;
    if (std::abs(axes(0, (up + 2) % 3)) > std::abs(axes(0, along))) along = (up + 2) % 3;
    const Eigen::Index across = 3 - up - along;
    const mjtNum* size = m->geom_size + 3 * geom;
    half_x_ = size[along];
    half_y_ = size[across];
    const Eigen::Vector3d x = axes.col(along) * (axes(0, along) < 0 ? -1 : 1);
    yaw_ = std::atan2(x.y(), x.x());
    middle_ = box_to_site.translation();
    height_ = middle_.z() + size[up];
    thickness_ = 2 * size[up];
  }

  // Returns "" if the site lies on the face.
  std::string WhyNotUnderSite(const Pose& site_to_world) const {
    if (site_to_world.rotation()(2, 2) < kLevel) return "its z axis does not point up";
    if (alignment_ < kLevel)
      return "the box is tilted against it; give the box a horizontal upper face";
    const Eigen::Vector3d site = to_site().inverse() * Eigen::Vector3d::Zero();
    if (std::abs(height_) > kOnSurface)
      return fmt::format("it is {:.3f} m {} the box's upper face", std::abs(height_),
                         height_ < 0 ? "above" : "below");
    if (std::abs(site.x()) > half_x_ || std::abs(site.y()) > half_y_)
      return fmt::format("the box's middle is {:.3f} m away, so that it is beside the box",
                         middle_.head<2>().norm());
    return "";
  }

  Pose to_site() const { return Pose::FromRpy({middle_.x(), middle_.y(), 0}, {0, 0, yaw_}); }
  double half_x() const { return half_x_; }
  double half_y() const { return half_y_; }
  double thickness() const { return thickness_; }
  double height() const { return height_; }        // over the site
  double alignment() const { return alignment_; }  // cosine to the site's z

 private:
  Eigen::Vector3d middle_;
  double half_x_ = 0, half_y_ = 0, height_ = 0, thickness_ = 0, yaw_ = 0, alignment_ = 0;
};

// Returns the name of the body with a joint, this one or one that carries it; "" for none.
std::string MovedBody(const mjModel* m, int body) {
  while (body > 0 && m->body_jntnum[body] == 0) body = m->body_parentid[body];
  return body > 0 ? ElementName(m, mjOBJ_BODY, body) : "";
}

// The level upper faces of fixed boxes.
class LevelFaces {
 public:
  explicit LevelFaces(const Scene& scene) : scene_(scene), m_(scene.model()) {
    for (const std::string& object : scene.parked_objects())
      parked_.push_back(FindId(m_, mjOBJ_BODY, scene.compiled()->object(object).root_body));
    for (const RobotRecord& robot : scene.compiled()->robots()) {
      if (const int base = FindId(m_, mjOBJ_BODY, robot.base_body); base > 0)
        robots_.push_back(base);
    }
  }

  // Returns all faces, the preferred one first.
  std::vector<SupportFace> All() const {
    std::vector<std::pair<double, SupportFace>> ranked;
    for (int g = 0; g < m_->ngeom; ++g) {
      const std::optional<Support> face = FaceOf(g);
      if (!face) continue;
      const double height = face->frame_to_world.translation().z();
      const bool furniture =
          height > internal::kLowestFurniture && height < internal::kHighestFurniture;
      // Furniture comes before everything else.
      const double rank = face->half_x * face->half_y + (furniture ? kBeforeAll : 0);
      ranked.emplace_back(rank, SupportFace{.face = *face,
                                            .body = ElementName(m_, mjOBJ_BODY, m_->geom_bodyid[g]),
                                            .free_area = FreeArea(*face)});
    }
    std::ranges::stable_sort(ranked, std::greater<>(), [](const auto& each) { return each.first; });
    std::vector<SupportFace> faces;
    for (auto& [rank, face] : ranked) faces.push_back(std::move(face));
    return faces;
  }
  // Returns the area of a face with free space above, by a grid of rays.
  double FreeArea(const Support& face) const {
    constexpr int kGrid = 8;
    int free = 0;
    for (int i = 0; i < kGrid; ++i) {
      for (int j = 0; j < kGrid; ++j) {
        const Eigen::Vector3d at(face.half_x * (2 * (i + 0.5) / kGrid - 1),
                                 face.half_y * (2 * (j + 0.5) / kGrid - 1), 0);
        free += HasRoom(face.frame_to_world * at);
      }
    }
    return 4 * face.half_x * face.half_y * free / (kGrid * kGrid);
  }

 private:
  static constexpr double kLeastHalf = 0.08;  // half of a face's shorter side
  static constexpr double kRoom = 0.3;        // above its middle, metres
  static constexpr double kBeforeAll = 1e6;

  std::optional<Support> FaceOf(int g) const {
    if (m_->geom_type[g] != mjGEOM_BOX || !internal::IsCollisionGeom(m_, g)) return std::nullopt;
    const int body = m_->geom_bodyid[g];
    if (m_->body_dofnum[m_->body_weldid[body]] > 0 || IsMocap(body)) return std::nullopt;
    if (IsUnder(body, parked_) || IsUnder(body, robots_)) return std::nullopt;
    const mjData* d = scene_.data();
    const Pose box = Pose::FromTranslationAndMatrix(d->geom_xpos + 3 * g, d->geom_xmat + 9 * g);
    const Face face(m_, Pose(box.translation()), box, g);
    if (face.alignment() < kLevel || std::min(face.half_x(), face.half_y()) < kLeastHalf)
      return std::nullopt;
    Pose top = Pose(box.translation()) * face.to_site();
    top = Pose(top.translation() + face.height() * Eigen::Vector3d::UnitZ(), top.quaternion());
    if (!HasRoom(top.translation())) return std::nullopt;
    return Support{top, face.half_x(), face.half_y(), face.thickness(), ""};
  }
  bool IsMocap(int body) const { return m_->body_mocapid[m_->body_rootid[body]] >= 0; }
  bool IsUnder(int body, const std::vector<int>& roots) const {
    return std::ranges::any_of(roots,
                               [&](int root) { return internal::IsInSubtree(m_, body, root); });
  }
  // A robot there moves out of the way.
  bool HasRoom(const Eigen::Vector3d& top) const {
    constexpr double kOn = 1e-4;  // metres past a surface
    const mjtNum up[3] = {0, 0, 1};
    for (double above = kOn; above <= kRoom;) {
      const Eigen::Vector3d from = top + above * Eigen::Vector3d::UnitZ();
      int geom = -1;
      const double way = mj_ray(m_, scene_.data(), from.data(), up, nullptr, 1, -1, &geom, nullptr);
      if (way < 0 || above + way > kRoom) return true;
      if (!IsUnder(m_->geom_bodyid[geom], robots_)) return false;
      above += way + kOn;
    }
    return true;
  }

  const Scene& scene_;
  const mjModel* m_;
  std::vector<int> parked_, robots_;  // bodies
};

// Returns the box face that a site marks.
Support MarkedSupport(const Scene& scene, const std::string& site, const std::string& place) {
  const mjModel* m = scene.model();
  const int box = LargestBox(m, SiteBody(scene, site));
  if (box < 0) throw SpecError(place + " needs a box geom in its body: the surface it is on");
  const Pose site_to_world = scene.site_pose(site);
  const mjData* d = scene.data();
  mjtNum quat[4];
  mju_mat2Quat(quat, d->geom_xmat + 9 * box);
  const Face face(m, site_to_world, Pose::FromWxyz(d->geom_xpos + 3 * box, quat), box);
  if (const std::string why = face.WhyNotUnderSite(site_to_world); !why.empty()) {
    throw SpecError(
        fmt::format("{} marks the upper face of {}, but {}. Put it in the middle of "
                    "that face, z up",
                    place, Describe(m, mjOBJ_GEOM, box), why));
  }
  return {site_to_world * face.to_site(), face.half_x(), face.half_y(), face.thickness(),
          MovedBody(m, m->geom_bodyid[box])};
}

}  // namespace

Support FindSupport(const SceneSpec& base) {
  const Scene scene = Scene::Build(base);
  const std::string site = FindSite(scene, Place(base));
  if (site.empty()) {
    const std::vector<SupportFace> faces = LevelFaces(scene).All();
    if (!faces.empty()) return faces.front().face;
    if (std::vector<Support> floors = FindFloors(scene); !floors.empty()) {
      Support& middle = floors.front();
      middle.half_x = std::min(middle.half_x, kHalfOfFloor);
      middle.half_y = std::min(middle.half_y, kHalfOfFloor);
      return middle;
    }
    throw NotFoundError(
        fmt::format("{}: no support for objects: no fixed box with a level upper face of "
                    "at least 0.16 by 0.16 m and 0.3 m of room above it, and no free floor. Add "
                    "one, or mark a box with a site '{}'",
                    Place(base), kSite));
  }
  return MarkedSupport(scene, site, Place(base) + ": site '" + site + "'");
}

std::vector<Support> FindFloors(const Scene& scene, std::span<const std::string> moved,
                                std::span<const Eigen::Vector3d> points) {
  std::vector<Support> floors;
  for (const FloorArea& area :
       internal::FindFreeFloor(scene, internal::MovedBodies(scene, moved), points))
    floors.push_back({area.frame_to_world, area.half_x, area.half_y, 0, ""});
  return floors;
}

std::vector<SupportFace> FindSupportFaces(const Scene& scene) {
  const LevelFaces level(scene);
  std::vector<SupportFace> faces = level.All();
  const std::string place = "scene '" + scene.name() + "'";
  const std::string site = FindSite(scene, place);
  if (site.empty()) return faces;
  const Support marked = MarkedSupport(scene, site, place + ": site '" + site + "'");
  std::erase_if(faces, [&](const SupportFace& face) {
    const Eigen::Vector3d way =
        face.face.frame_to_world.translation() - marked.frame_to_world.translation();
    return way.norm() < kOnSurface;
  });
  faces.insert(faces.begin(),
               {.face = marked,
                .body = ElementName(scene.model(), mjOBJ_BODY, SiteBody(scene, site)),
                .free_area = level.FreeArea(marked)});
  return faces;
}

void RequireSteady(const SceneSpec& base, const Support& support) {
  if (support.moved_body.empty()) return;
  Scene scene = Scene::Build(base);
  const std::string site = FindSite(scene, Place(base));  // only marked ones can move
  const Eigen::Vector3d before = scene.site_pose(site).translation();
  const StepResult result = scene.StepN(static_cast<int>(kSteadySeconds / scene.timestep()));
  const double way = (scene.site_pose(site).translation() - before).norm();
  if (result.ok() && way <= kSteady) return;
  throw SpecError(fmt::format(
      "{}: site '{}' does not stay where objects are to be put: its body '{}' has a joint, and {}. "
      "Take the joint out, or have the body stand on something",
      Place(base), site, support.moved_body,
      result.ok() ? fmt::format("moves by {:.3f} m in {:g} s", way, kSteadySeconds)
                  : result.message));
}

}  // namespace robocell
