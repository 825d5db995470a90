#include "robocell/scenes/related_places.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/base/units.h"
#include "robocell/scenes/hollows.h"
#include "robocell/scenes/object_places.h"
#include "robocell/scenes/settle.h"
#include "robocell/scenes/spatial_relation.h"

namespace robocell::internal {
namespace {

using Link = RelatedPlaces::Link;

constexpr int kRelatedTries = 60;
constexpr double kRelatedDrop = 0.001;  // metres above the place, from where it settles
constexpr double kWallGap = 0.003;      // metres between an object and the walls of a hollow
constexpr double kBeside = 0.005;       // metres between objects that are not next to each other

// --- What a start says ---------------------------------------------------------------------------

// An object by its name, else the first of that kind.
std::optional<size_t> Called(const std::string& name, const std::vector<SceneObject>& objects,
                             const std::vector<std::string>& kinds) {
  for (size_t i = 0; i < objects.size(); ++i) {
    if (objects[i].name == name) return i;
  }
  const auto kind = std::ranges::find(kinds, name);
  if (kind == kinds.end()) return std::nullopt;
  return static_cast<size_t>(kind - kinds.begin());
}

std::vector<std::string> NamesOf(const std::vector<SceneObject>& objects,
                                 const std::vector<std::string>& kinds) {
  std::vector<std::string> names;
  for (const SceneObject& object : objects) names.push_back(object.name);
  for (const std::string& kind : kinds) {
    if (std::ranges::find(names, kind) == names.end()) names.push_back(kind);
  }
  return names;
}

void RequireKnownKeys(const Map<ObjectPlace>& places, const std::vector<SceneObject>& objects,
                      const std::vector<std::string>& kinds, const NamePredicate& may_come) {
  for (const std::string& key : places.keys()) {
    if (Called(key, objects, kinds) || may_come(key)) continue;
    throw SpecError(NoSuchName("start.places", "object", key, NamesOf(objects, kinds)));
  }
}

std::string TextOf(const Link& link, const std::vector<SceneObject>& objects) {
  return fmt::format("'{}' {} '{}'", objects[link.object].name, ToString(link.place.relation()),
                     link.place.reference());
}

// Each after those that it refers to.
std::vector<Link> InOrder(std::vector<Link> links, const std::vector<SceneObject>& objects) {
  std::vector<Link> ordered;
  while (!links.empty()) {
    const auto waits = [&](const Link& link) {
      return std::ranges::any_of(links, [&](const Link& l) { return link.other == l.object; });
    };
    const auto next = std::ranges::find_if_not(links, waits);
    if (next == links.end()) {
      std::vector<std::string> circle;
      for (const Link& link : links) circle.push_back(TextOf(link, objects));
      throw SpecError(
          fmt::format("start.places: these run in a circle: {}. Let one of them lie on "
                      "the support, without a place of its own",
                      fmt::join(circle, ", ")));
    }
    ordered.push_back(std::move(*next));
    links.erase(next);
  }
  return ordered;
}

// An object as it stands alone at the origin.
std::shared_ptr<const Landmarks> Alone(SceneObject object) {
  object.fixed = true;
  object.pos = {0, 0, 0};
  object.euler = {};
  object.quat = kIdentityQuat;
  object.reset_root_pose = true;
  SceneSpec spec{.name = "'" + object.name + "' alone",
                 .timestep = 0.002,
                 .add_floor = false,
                 .add_skybox = false};
  spec.objects.push_back(std::move(object));
  return LandmarksOf(spec);
}

void RequirePlace(const Link& link, const std::string& where) {
  const std::string& name = link.place.reference();
  if (link.place.relation() == Relation::kOnTopOf && link.marks->Tops(link.mark).empty()) {
    throw SpecError(
        fmt::format("{}: nothing can lie on '{}', which has no shape that collides", where, name));
  }
  if (link.place.relation() == Relation::kInside && link.marks->Floors(link.mark).empty()) {
    throw SpecError(
        fmt::format("{}: '{}' has no hollow with a level floor. Say on_top_of, or let "
                    "the source of the scene name a container (annotations)",
                    where, name));
  }
}

// --- Where they lie ------------------------------------------------------------------------------

// The room that an object takes: an upright cylinder.
struct Room {
  size_t object;
  Eigen::Vector2d at;
  double radius, bottom, top;
};

Room RoomOf(size_t i, const SceneObject& object, const ObjectSize& size) {
  const double bottom = object.pos[2] - size.height;
  return {i, {object.pos[0], object.pos[1]}, size.radius, bottom, bottom + 2 * size.height};
}

bool Overlap(const Room& a, const Room& b) {
  const bool same_height = a.bottom < b.top && b.bottom < a.top;
  return same_height && (a.at - b.at).norm() < a.radius + b.radius + kBeside;
}

void Stand(SceneObject& object, const ObjectSize& size, const Eigen::Vector3d& at, Rng& rng) {
  object.pos = {at.x(), at.y(), at.z() + size.height + kRelatedDrop};
  object.quat = Pose::FromRpy({0, 0, 0}, {0, 0, rng.Uniform(-kPi, kPi)}).quaternion();
}

// Where an object with a place can lie, as the things that it refers to lie now.
class Spots {
 public:
  // `ground`: what its reference stands on, for places next to it.
  Spots(const Link& link, const Pose& reference_to_world, const LevelSpot& ground)
      : link_(link), at_(reference_to_world), ground_(ground) {
    if (link.place.relation() == Relation::kOnTopOf) spots_ = link.marks->Tops(link.mark);
    if (link.place.relation() == Relation::kInside) spots_ = link.marks->Floors(link.mark);
    for (LevelSpot& spot : spots_) spot.frame_to_world = at_ * spot.frame_to_world;
  }

  // Whether the object is too wide for all of them.
  bool TooNarrow(double radius) const {
    return link_.place.relation() == Relation::kInside &&
           std::ranges::none_of(spots_, [&](const LevelSpot& spot) {
             return std::min(spot.half_x, spot.half_y) >= radius + kWallGap;
           });
  }

  // A point to stand on, and the face that it is on.
  std::pair<Eigen::Vector3d, LevelSpot> Draw(double radius, Rng& rng) const {
    if (link_.place.relation() == Relation::kNextTo) return {Beside(radius, rng), ground_};
    std::vector<const LevelSpot*> wide;
    const double margin = radius + (link_.place.relation() == Relation::kInside ? kWallGap : 0);
    for (const LevelSpot& spot : spots_) {
      if (std::min(spot.half_x, spot.half_y) >= margin) wide.push_back(&spot);
    }
    // What is wider than a top can still stand in its middle.
    const LevelSpot& spot = wide.empty() ? spots_.front() : *wide[rng.UniformInt(wide.size())];
    const double x = std::max(0.0, spot.half_x - margin), y = std::max(0.0, spot.half_y - margin);
    const double across = rng.Uniform(-y, y), along = rng.Uniform(-x, x);  // in this order
    return {spot.frame_to_world * Eigen::Vector3d(along, across, 0), spot};
  }

  bool IsOnGround(const Eigen::Vector3d& at, double radius) const {
    const Eigen::Vector3d there = ground_.frame_to_world.inverse() * at;
    return std::abs(there.x()) + radius <= ground_.half_x &&
           std::abs(there.y()) + radius <= ground_.half_y;
  }

 private:
  // On the ground, in a direction of its own.
  Eigen::Vector3d Beside(double radius, Rng& rng) const {
    const double angle = rng.Uniform(-kPi, kPi);
    const double gap = rng.Uniform(link_.place.gap[0], link_.place.gap[1]);
    const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
    const Eigen::Vector3d of_reference = at_.rotation().transpose() * out;
    const double reach = link_.marks->ReachAlong(link_.mark, of_reference);
    Eigen::Vector3d at = at_ * link_.marks->Origin(link_.mark) + (reach + gap + radius) * out;
    at.z() = ground_.frame_to_world.translation().z();
    return at;
  }

  const Link& link_;
  Pose at_;
  LevelSpot ground_;
  std::vector<LevelSpot> spots_;
};

}  // namespace

std::shared_ptr<const Landmarks> LandmarksOf(const SceneSpec& scene,
                                             const std::optional<SceneAnnotations>& known) {
  SceneAnnotations annotations = DeriveAnnotations(scene);
  if (known && !known->supports.empty()) annotations.supports = known->supports;
  if (known && !known->containers.empty()) annotations.containers = known->containers;
  return std::make_shared<const Landmarks>(Scene::Build(scene), std::move(annotations));
}

RelatedPlaces::RelatedPlaces(std::shared_ptr<const Landmarks> base, const Map<ObjectPlace>& places,
                             const std::vector<SceneObject>& objects,
                             const std::vector<std::string>& kinds, const NamePredicate& may_come) {
  RequireKnownKeys(places, objects, kinds, may_come);
  std::vector<std::shared_ptr<const Landmarks>> alone(objects.size());
  std::vector<Link> links;
  for (size_t i = 0; i < objects.size(); ++i) {
    const ObjectPlace* place = places.find(objects[i].name);
    if (!place) place = places.find(kinds[i]);
    if (!place) continue;
    const std::string where = fmt::format("start.places.{}", objects[i].name);
    if (IsFixed(objects[i]))
      throw SpecError(where + ": it is a fixed object, which stays where its pose is");
    const std::string& reference = place->reference();
    Link link{.object = i, .place = *place, .other = Called(reference, objects, kinds)};
    if (link.other == i) throw SpecError(where + ": it cannot have its place by itself");
    if (link.other) {
      if (!alone[*link.other]) alone[*link.other] = Alone(objects[*link.other]);
      link.marks = alone[*link.other];
      link.mark = objects[*link.other].name;
    } else if (base->Has(reference)) {
      link.marks = base;
      link.mark = reference;
    } else if (!may_come(reference)) {
      std::vector<std::string> known = NamesOf(objects, kinds);
      const std::vector<std::string> bodies = base->Names();
      known.insert(known.end(), bodies.begin(), bodies.end());
      throw SpecError(NoSuchName(where, "object or body", reference, known));
    }
    if (link.marks) RequirePlace(link, where);
    links.push_back(std::move(link));
  }
  links_ = InOrder(std::move(links), objects);
}

bool RelatedPlaces::IsRelated(size_t object) const {
  return std::ranges::any_of(links_, [&](const Link& link) { return link.object == object; });
}

std::optional<std::string> RelatedPlaces::Put(const Support& support,
                                              std::span<const ObjectSize> sizes,
                                              std::vector<SceneObject>& objects, Rng& rng) const {
  const LevelSpot on_support{support.frame_to_world, support.half_x, support.half_y};
  std::vector<LevelSpot> grounds(objects.size(), on_support);
  std::vector<Room> taken;
  for (size_t i = 0; i < objects.size(); ++i) {
    if (!IsRelated(i)) taken.push_back(RoomOf(i, objects[i], sizes[i]));
  }
  for (const Link& link : links_) {
    const size_t i = link.object;
    if (!link.marks) return fmt::format("there is no '{}' in this start", link.place.reference());
    const LevelSpot ground = link.other ? grounds[*link.other] : link.marks->Ground(link.mark);
    const Spots spots(link, link.other ? objects[*link.other].pose() : Pose(), ground);
    if (spots.TooNarrow(sizes[i].radius)) {
      return fmt::format("{}: the object, {:.3f} m wide, does not fit into the hollow",
                         TextOf(link, objects), 2 * sizes[i].radius);
    }
    bool found = false;
    for (int t = 0; t < kRelatedTries && !found; ++t) {
      const auto [at, face] = spots.Draw(sizes[i].radius, rng);
      Stand(objects[i], sizes[i], at, rng);
      const bool is_beside = link.place.relation() == Relation::kNextTo;
      if (is_beside && !spots.IsOnGround(at, sizes[i].radius)) continue;
      const Room room = RoomOf(i, objects[i], sizes[i]);
      found = std::ranges::none_of(taken, [&](const Room& other) {
        return other.object != link.other && Overlap(room, other);
      });
      if (!found) continue;
      taken.push_back(room);
      grounds[i] = face;
    }
    if (!found) return fmt::format("there is no free place for {}", TextOf(link, objects));
  }
  return std::nullopt;
}

std::optional<std::string> RelatedPlaces::WhyNotKept(
    const Scene& scene, const std::vector<SceneObject>& objects) const {
  for (const Link& link : links_) {
    const std::string reference = link.other ? objects[*link.other].name : link.place.reference();
    const Relation relation = link.place.relation();
    // A source of scenes may know of hollows that the geometry does not have.
    if (relation == Relation::kInside &&
        FindHollows(scene, RequireObjectOrBody(scene, reference)).empty())
      continue;
    const double most_gap = link.place.gap[1] + kMostSettling;
    if (!SpatialRelation(scene, objects[link.object].name, relation, reference, most_gap).Holds())
      return fmt::format("{}: it did not stay there", TextOf(link, objects));
  }
  return std::nullopt;
}

}  // namespace robocell::internal
