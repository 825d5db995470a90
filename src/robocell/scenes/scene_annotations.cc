#include "robocell/scenes/scene_annotations.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <limits>
#include <set>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/free_floor.h"
#include "robocell/scenes/handle_geoms.h"
#include "robocell/scenes/hollows.h"

namespace robocell {
namespace {

// The annotations derived from one compiled scene.
class Derivation {
 public:
  explicit Derivation(Scene scene)
      : scene_(std::move(scene)), m_(scene_.model()), of_robots_(internal::MovedBodies(scene_)) {}

  SceneAnnotations Result() {
    SceneAnnotations found;
    found.supports = FindSupportFaces(scene_);
    for (int j = 0; j < m_->njnt; ++j) {
      const bool opens = m_->jnt_type[j] == mjJNT_HINGE || m_->jnt_type[j] == mjJNT_SLIDE;
      if (opens && !of_robots_[m_->jnt_bodyid[j]]) found.articulations.push_back(ArticulationOf(j));
    }
    for (int body = 1; body < m_->nbody; ++body) {
      if (of_robots_[body]) continue;
      if (const std::optional<internal::Hollow> hollow = internal::FindHollow(scene_, body))
        found.containers.push_back(ContainerOf(body, *hollow));
    }
    for (const SceneObject& object : scene_.compiled()->spec().objects)
      found.objects.push_back(WordsOf(object));
    for (int light = 0; light < m_->nlight; ++light) found.lights.push_back(LightOf(light));
    found.free_floor = internal::FindFreeFloor(scene_, of_robots_);
    return found;
  }

 private:
  Articulation ArticulationOf(int joint) const {
    const mjData* d = scene_.data();
    const int body = m_->jnt_bodyid[joint];
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    Articulation out;
    out.joint = ElementName(m_, mjOBJ_JOINT, joint);
    out.body = ElementName(m_, mjOBJ_BODY, body);
    out.kind =
        m_->jnt_type[joint] == mjJNT_HINGE ? ArticulationKind::kHinge : ArticulationKind::kSlide;
    out.range = m_->jnt_limited[joint]
                    ? Vec2{m_->jnt_range[2 * joint], m_->jnt_range[2 * joint + 1]}
                    : Vec2{-kInfinite, kInfinite};
    out.start = d->qpos[m_->jnt_qposadr[joint]];
    out.axis = Eigen::Map<const Eigen::Vector3d>(d->xaxis + 3 * joint);
    out.anchor = Eigen::Map<const Eigen::Vector3d>(d->xanchor + 3 * joint);
    for (int g = 0; g < m_->ngeom; ++g) {
      if (MovedJoint(m_->geom_bodyid[g]) == joint && internal::IsHandleGeom(scene_, g))
        out.handle_geoms.push_back(ElementName(m_, mjOBJ_GEOM, g));
    }
    return out;
  }
  // Returns the joint, a hinge or a slide, next to a body on its way to the world; -1 if there is
  // none.
  int MovedJoint(int body) const {
    while (body > 0 && m_->body_jntnum[body] == 0) body = m_->body_parentid[body];
    if (body == 0) return -1;
    const int joint = m_->body_jntadr[body] + m_->body_jntnum[body] - 1;
    const bool opens = m_->jnt_type[joint] == mjJNT_HINGE || m_->jnt_type[joint] == mjJNT_SLIDE;
    return opens ? joint : -1;
  }
  Container ContainerOf(int body, const internal::Hollow& hollow) const {
    const mjData* d = scene_.data();
    const Pose at = Pose::FromTranslationAndMatrix(d->xpos + 3 * body, d->xmat + 9 * body);
    const int joint = MovedJoint(body);
    return {.body = ElementName(m_, mjOBJ_BODY, body),
            .frame_to_world = at * Pose(hollow.middle),
            .half_extents = hollow.half_extents,
            .opening = at.rotation() * hollow.opening,
            .moved_by = joint < 0 ? "" : ElementName(m_, mjOBJ_JOINT, joint)};
  }
  SceneLight LightOf(int light) const {
    const mjData* d = scene_.data();
    return {.name = ElementName(m_, mjOBJ_LIGHT, light),
            .position = Eigen::Map<const Eigen::Vector3d>(d->light_xpos + 3 * light),
            .direction = Eigen::Map<const Eigen::Vector3d>(d->light_xdir + 3 * light),
            .directional = m_->light_type[light] == mjLIGHT_DIRECTIONAL};
  }

  Scene scene_;
  const mjModel* m_;
  std::vector<bool> of_robots_;  // bodies that are no surroundings
};

}  // namespace

SceneAnnotations DeriveAnnotations(const SceneSpec& spec) {
  return DeriveAnnotations(Scene::Build(spec));
}
SceneAnnotations DeriveAnnotations(const Scene& scene) { return Derivation(scene).Result(); }

ObjectWords WordsOf(const SceneObject& object) {
  const std::string category = object.mjcf_path.empty()
                                   ? std::string(ToString(object.shape.value_or(Shape::kBox)))
                                   : std::filesystem::path(object.mjcf_path).stem().string();
  ObjectWords words = {.object = object.name, .category = category, .words = {category}};
  if (!IsObjectKind(object.mjcf_path)) return words;
  const ObjectInfo info = ObjectInfoOf(object.mjcf_path);
  if (!info.colour.empty()) words.words.push_back(info.colour + " " + WordOfKind(object.mjcf_path));
  words.words.insert(words.words.end(), info.synonyms.begin(), info.synonyms.end());
  return words;
}

std::vector<FloorArea> FreeFloorOf(const SceneAnnotations& annotations, const std::string& name) {
  std::vector<FloorArea> areas;
  std::vector<std::string> known;
  const auto add = [&](const std::string& other) {
    if (!other.empty() && std::ranges::find(known, other) == known.end()) known.push_back(other);
  };
  for (const FloorArea& area : annotations.free_floor) {
    add(area.floor);
    add(area.room);
    if (!name.empty() && (area.floor == name || area.room == name)) areas.push_back(area);
  }
  if (areas.empty()) throw NotFoundError(NoSuchName("free floor", "floor or room", name, known));
  std::ranges::stable_sort(areas, std::greater<>(),
                           [](const FloorArea& area) { return area.half_x * area.half_y; });
  return areas;
}

}  // namespace robocell
