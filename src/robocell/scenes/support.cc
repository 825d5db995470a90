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
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/free_floor.h"
#include "robocell/scenes/scene_annotations.h"

namespace robocell {
namespace {

constexpr double kLevel = 0.9998;     // cosine of one degree
constexpr double kHalfOfFloor = 0.5;  // most of a floor on which a run puts objects, metres

std::string Place(const SceneSpec& base) {
  return "scene '" + base.name + "'" + (base.base ? " from '" + *base.base + "'" : "");
}

// The face of a box that points up, in the world.
class UpperFace {
 public:
  UpperFace(const mjModel* m, const mjData* d, int geom) {
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> axes(d->geom_xmat +
                                                                              9 * geom);
    Eigen::Index up;
    alignment_ = axes.row(2).cwiseAbs().maxCoeff(&up);
    // Uses the box axis that is nearest to the world's x, so that an aligned box is not turned.
    Eigen::Index along = (up + 1) % 3;
    if (std::abs(axes(0, (up + 2) % 3)) > std::abs(axes(0, along))) along = (up + 2) % 3;
    const Eigen::Index across = 3 - up - along;
    const mjtNum* size = m->geom_size + 3 * geom;
    const Eigen::Vector3d x = axes.col(along) * (axes(0, along) < 0 ? -1 : 1);
    const Eigen::Vector3d middle(d->geom_xpos + 3 * geom);
    face_ = {.frame_to_world = Pose::FromRpy(middle + size[up] * Eigen::Vector3d::UnitZ(),
                                             {0, 0, std::atan2(x.y(), x.x())}),
             .half_x = size[along],
             .half_y = size[across],
             .thickness = 2 * size[up]};
  }

  bool is_level() const { return alignment_ >= kLevel; }
  const Support& face() const { return face_; }

 private:
  Support face_;
  double alignment_ = 0;  // cosine to the world's z
};

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
        free += HasRoom(face.frame_to_world * at, true);
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
    const UpperFace upper(m_, scene_.data(), g);
    const Support& face = upper.face();
    if (!upper.is_level() || std::min(face.half_x, face.half_y) < kLeastHalf) return std::nullopt;
    if (!HasRoom(face.frame_to_world.translation(), false)) return std::nullopt;
    return face;
  }
  bool IsMocap(int body) const { return m_->body_mocapid[m_->body_rootid[body]] >= 0; }
  bool IsUnder(int body, const std::vector<int>& roots) const {
    return std::ranges::any_of(roots,
                               [&](int root) { return internal::IsInSubtree(m_, body, root); });
  }
  bool IsFree(int body) const {
    const int root = m_->body_rootid[body];
    return m_->body_jntnum[root] > 0 && m_->jnt_type[m_->body_jntadr[root]] == mjJNT_FREE;
  }
  // A robot there moves out of the way. `with_free`: free objects, which lie there, count.
  bool HasRoom(const Eigen::Vector3d& top, bool with_free) const {
    constexpr double kOn = 1e-4;  // metres past a surface
    const mjtNum up[3] = {0, 0, 1};
    for (double above = kOn; above <= kRoom;) {
      const Eigen::Vector3d from = top + above * Eigen::Vector3d::UnitZ();
      int geom = -1;
      const double distance =
          mj_ray(m_, scene_.data(), from.data(), up, nullptr, 1, -1, &geom, nullptr);
      if (distance < 0 || above + distance > kRoom) return true;
      const int body = m_->geom_bodyid[geom];
      if (!IsUnder(body, robots_) && (with_free || !IsFree(body))) return false;
      above += distance + kOn;
    }
    return true;
  }

  const Scene& scene_;
  const mjModel* m_;
  std::vector<int> parked_, robots_;  // bodies
};

}  // namespace

Support FindSupport(const SceneSpec& base) {
  const Scene scene = Scene::Build(base);
  const std::vector<SupportFace> faces = LevelFaces(scene).All();
  if (!faces.empty()) return faces.front().face;
  if (std::vector<Support> floors = FindFloors(scene); !floors.empty()) {
    Support& middle = floors.front();
    middle.half_x = std::min(middle.half_x, kHalfOfFloor);
    middle.half_y = std::min(middle.half_y, kHalfOfFloor);
    return middle;
  }
  throw NotFoundError(
      fmt::format("{}: no support for objects: no fixed box with a level upper face of at least "
                  "0.16 by 0.16 m and 0.3 m of room above it, and no free floor. Add one, or "
                  "annotate supports in a scene source of your own",
                  Place(base)));
}

std::vector<Support> FindFloors(const Scene& scene, std::span<const std::string> moved,
                                std::span<const Eigen::Vector3d> points) {
  std::vector<Support> floors;
  for (const FloorArea& area :
       internal::FindFreeFloor(scene, internal::MovedBodies(scene, moved), points))
    floors.push_back({area.frame_to_world, area.half_x, area.half_y, 0});
  return floors;
}

std::vector<SupportFace> FindSupportFaces(const Scene& scene) { return LevelFaces(scene).All(); }

}  // namespace robocell
