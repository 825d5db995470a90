#include "robocell/scenes/related_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robocell/base/units.h"
#include "robocell/scenes/hollows.h"
#include "robocell/scenes/settle.h"
#include "robocell/scenes/spatial_relation.h"

namespace robocell::internal {
namespace {

constexpr int kRelatedTries = 60;
constexpr double kRelatedDrop = 0.001;  // metres above the place, from where it settles
constexpr double kWallGap = 0.003;      // metres between an object and the walls of a hollow
constexpr double kBeside = 0.005;       // metres between objects that are not next to each other

// The space that an object takes up: an upright cylinder.
struct Room {
  size_t object;
  Eigen::Vector2d at;
  double radius, bottom, top;
};

Room RoomOf(size_t i, const SceneObject& object, const ObjectSize& size) {
  const Eigen::Vector3d at = object.pose().translation();
  return {i, at.head<2>(), size.radius, at.z() - size.height, at.z() + size.top};
}

bool Overlap(const Room& a, const Room& b) {
  const bool same_height = a.bottom < b.top && b.bottom < a.top;
  return same_height && (a.at - b.at).norm() < a.radius + b.radius + kBeside;
}

// The places for an object relative to the present poses of its references.
class Spots {
 public:
  // `ground`: the support of its reference, for places next to it.
  Spots(const PlaceLink& link, const Pose& reference_to_world, const LevelArea& ground)
      : link_(link), at_(reference_to_world), ground_(ground) {
    if (link.place.relation() == Relation::kOnTopOf) spots_ = link.marks->Tops(link.mark);
    if (link.place.relation() == Relation::kInside) spots_ = link.marks->Floors(link.mark);
    for (LevelArea& spot : spots_) spot.frame_to_world = at_ * spot.frame_to_world;
  }

  // Returns true if the object is too wide for all of them.
  bool TooNarrow(double radius) const {
    return link_.place.relation() == Relation::kInside &&
           std::ranges::none_of(spots_, [&](const LevelArea& spot) {
             return std::min(spot.half_x, spot.half_y) >= radius + kWallGap;
           });
  }

  // Returns a point for the object turned by `yaw`, and the face that it is on.
  std::pair<Eigen::Vector3d, LevelArea> Draw(double radius, double yaw, Rng& rng) const {
    if (link_.place.relation() == Relation::kNextTo) return {Beside(yaw, rng), ground_};
    std::vector<const LevelArea*> wide;
    const double margin = radius + (link_.place.relation() == Relation::kInside ? kWallGap : 0);
    for (const LevelArea& spot : spots_) {
      if (std::min(spot.half_x, spot.half_y) >= margin) wide.push_back(&spot);
    }
    // An object that is wider than a top can still stand in its middle.
    const LevelArea& spot = wide.empty() ? spots_.front() : *wide[rng.UniformInt(wide.size())];
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
  // Returns a point on the ground, with the gap between the two outlines along a direction.
  Eigen::Vector3d Beside(double yaw, Rng& rng) const {
    const double angle = rng.Uniform(-kPi, kPi);
    const double gap = rng.Uniform(link_.place.gap[0], link_.place.gap[1]);
    const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
    const double reach = link_.marks->ReachAlong(link_.mark, at_.rotation().transpose() * out);
    const Eigen::Matrix3d turned = Pose::FromRpy({0, 0, 0}, {0, 0, yaw}).rotation();
    const double own_reach =
        link_.own->ReachAlong(link_.own->Names().front(), -(turned.transpose() * out));
    Eigen::Vector3d at = at_ * link_.marks->Origin(link_.mark) + (reach + gap + own_reach) * out;
    at.z() = ground_.frame_to_world.translation().z();
    return at;
  }

  const PlaceLink& link_;
  Pose at_;
  LevelArea ground_;
  std::vector<LevelArea> spots_;
};

}  // namespace

const PlaceLink* RelatedPlaces::LinkOf(size_t object) const {
  const auto link = std::ranges::find(links_, object, &PlaceLink::object);
  return link == links_.end() ? nullptr : &*link;
}

bool RelatedPlaces::IsRelated(size_t object) const { return LinkOf(object) != nullptr; }

// Returns true if it lies on or in an object, or in the object that contains that one, so that
// their spaces overlap.
bool RelatedPlaces::RestsOn(const PlaceLink& link, size_t object) const {
  for (const PlaceLink* at = &link; at && at->other; at = LinkOf(*at->other)) {
    if (*at->other == object) return true;
  }
  return false;
}

std::optional<std::string> RelatedPlaces::Put(const Support& support,
                                              std::span<const ObjectSize> sizes,
                                              std::vector<SceneObject>& objects, Rng& rng) const {
  return Put(std::vector<LevelArea>(objects.size(), support.area()), sizes, objects, rng);
}

std::optional<std::string> RelatedPlaces::Put(std::vector<LevelArea> grounds,
                                              std::span<const ObjectSize> sizes,
                                              std::vector<SceneObject>& objects, Rng& rng) const {
  std::vector<Room> taken;
  for (size_t i = 0; i < objects.size(); ++i) {
    if (!IsRelated(i)) taken.push_back(RoomOf(i, objects[i], sizes[i]));
  }
  for (const PlaceLink& link : links_) {
    const size_t i = link.object;
    if (!link.marks)
      return fmt::format("there is no other '{}' in this start", link.place.reference());
    const LevelArea ground = link.other ? grounds[*link.other] : link.marks->Ground(link.mark);
    const Spots spots(link, link.other ? objects[*link.other].pose() : Pose(), ground);
    if (spots.TooNarrow(sizes[i].radius)) {
      return fmt::format("{}: the object, {:.3f} m wide, does not fit into the hollow",
                         TextOf(link, objects), 2 * sizes[i].radius);
    }
    bool found = false;
    for (int t = 0; t < kRelatedTries && !found; ++t) {
      const double yaw = rng.Uniform(-kPi, kPi);
      const auto [at, face] = spots.Draw(sizes[i].radius, yaw, rng);
      objects[i].pos = Vec3{at.x(), at.y(), at.z() + sizes[i].height + kRelatedDrop};
      objects[i].quat = Pose::FromRpy({0, 0, 0}, {0, 0, yaw}).quaternion();
      const bool is_beside = link.place.relation() == Relation::kNextTo;
      if (is_beside && !spots.IsOnGround(at, sizes[i].radius)) continue;
      const Room room = RoomOf(i, objects[i], sizes[i]);
      found = std::ranges::none_of(taken, [&](const Room& other) {
        return !RestsOn(link, other.object) && Overlap(room, other);
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
  for (const PlaceLink& link : links_) {
    const std::string& reference = link.mark;
    const Relation relation = link.place.relation();
    // A source of scenes may declare hollows that the geometry does not have.
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
