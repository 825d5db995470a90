#include "robocell/scenes/houses/furnished_house.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include "robocell/base/units.h"
#include "robocell/scenes/houses/furniture.h"
#include "robocell/scenes/houses/house_metadata.h"
#include "robocell/scenes/houses/house_objects.h"

namespace robocell::internal {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Box2 = Eigen::AlignedBox2d;

constexpr double kWallGap = 0.01;      // between furniture and the wall behind it
constexpr double kFrontSpace = 0.6;    // free floor in front of furniture
constexpr double kDoorSpace = 0.95;    // for the leaf of a door, and to walk through
constexpr double kWindowSpace = 0.5;   // in front of windows, without high furniture
constexpr double kBesideGap = 0.002;   // between units of a kitchen
constexpr double kObjectSpace = 0.05;  // between objects
constexpr double kDrop = 0.0005;       // of objects above their slot, before they settle
constexpr double kHeadroom = 0.01;     // above objects in containers
constexpr int kTries = 24;
constexpr int kMostInSlot = 3;
constexpr double kHigh = kWindowSill;  // furniture from this height on hides a window

// One of the four walls of a room, with its inside to the left of its direction.
struct Side {
  Vector2d start, along, inward;
  double length;
  double yaw;  // of furniture with its back there
};

std::array<Side, 4> SidesOf(const Box2& room) {
  const Vector2d &a = room.min(), &b = room.max();
  const double x = (b - a).x(), y = (b - a).y();
  return {Side{a, Vector2d::UnitX(), Vector2d::UnitY(), x, 0},
          Side{{b.x(), a.y()}, Vector2d::UnitY(), -Vector2d::UnitX(), y, kPi / 2},
          Side{b, -Vector2d::UnitX(), -Vector2d::UnitY(), x, kPi},
          Side{{a.x(), b.y()}, -Vector2d::UnitY(), Vector2d::UnitX(), y, -kPi / 2}};
}

Box2 BoxOf(const Vector2d& one, const Vector2d& other) {
  Box2 box(one);
  return box.extend(other);
}

// Overlaps of less than a millimetre are contacts.
bool Overlap(const Box2& a, const Box2& b) {
  constexpr double kTouch = 1e-3;
  return (a.intersection(b).sizes().array() > kTouch).all();
}

std::vector<Box2> WindowAreas(const FloorPlan& plan, size_t room) {
  std::vector<Box2> areas;
  for (const PlanWall& wall : plan.walls) {
    const bool below = wall.below == static_cast<int>(room),
               above = wall.above == static_cast<int>(room);
    if (!below && !above) continue;
    for (const PlanOpening& opening : wall.openings) {
      if (opening.is_door) continue;
      const Vector2d inward = wall.up() * (above ? 1 : -1);
      areas.push_back(BoxOf(wall.at(opening.at - opening.width / 2),
                            wall.at(opening.at + opening.width / 2) + kWindowSpace * inward));
    }
  }
  return areas;
}

// Furnishes one room.
class RoomFurnisher {
 public:
  RoomFurnisher(FurnishedHouse& house, size_t room, Rng& rng)
      : house_(house),
        room_(room),
        rng_(rng),
        inner_(house.plan.rooms[room].inner()),
        doors_(DoorAreas(house.plan, room)),
        windows_(WindowAreas(house.plan, room)) {}

  // Puts a piece with its back to a wall; false without a place.
  bool AtWall(std::string_view kind) {
    HouseThing thing = MakeFurniture(kind, rng_);
    std::array<Side, 4> sides = SidesOf(inner_);
    rng_.Shuffle(sides);
    for (const Side& side : sides) {
      const double slack = side.length - thing.size.x();
      if (slack < 0) continue;
      for (int t = 0; t < kTries; ++t) {
        // Corners first.
        const double at = t == 0 ? 0 : t == 1 ? slack : rng_.Uniform(0, slack);
        if (TryAtWall(thing, side, at + thing.size.x() / 2)) return true;
      }
    }
    return false;
  }
  // Puts pieces beside each other along one wall, as many as fit.
  void Row(std::span<const std::string_view> kinds) {
    std::array<Side, 4> sides = SidesOf(inner_);
    std::ranges::stable_sort(sides, std::greater<>(),
                             [&](const Side& side) { return FreeLength(side); });
    for (const Side& side : sides) {
      const size_t before = house_.pieces.size();
      double at = kWallGap;
      for (const std::string_view kind : kinds) {
        HouseThing thing = MakeFurniture(kind, rng_);
        const double half = thing.size.x() / 2;
        // A piece that does not fit here may fit beyond a door.
        for (double shift = 0; shift < 1.6; shift += 0.1) {
          if (at + shift + 2 * half > side.length) break;
          if (!TryAtWall(thing, side, at + shift + half)) continue;
          at += shift + 2 * half + kBesideGap;
          break;
        }
      }
      if (house_.pieces.size() >= before + 3) return AddCupboards(side, before);
      Undo(before);
    }
  }
  // Puts a piece into the room, with chairs around it.
  bool InMiddle(std::string_view kind, int chairs) {
    HouseThing thing = MakeFurniture(kind, rng_);
    const double space = chairs > 0 ? 0.75 : 0.45;
    const bool turned = rng_.Uniform(0, 1) < 0.5;
    const Vector2d half = (turned ? Vector2d(thing.size.y(), thing.size.x())
                                  : Vector2d(thing.size.x(), thing.size.y())) /
                          2;
    const Vector2d low = inner_.min() + half + Vector2d::Constant(space),
                   high = inner_.max() - half - Vector2d::Constant(space);
    if ((low.array() > high.array()).any()) return false;
    for (int t = 0; t < kTries; ++t) {
      const Vector2d at(rng_.Uniform(low.x(), high.x()), rng_.Uniform(low.y(), high.y()));
      const Box2 box(at - half, at + half);
      const Box2 around(box.min() - Vector2d::Constant(space),
                        box.max() + Vector2d::Constant(space));
      if (!IsFree(box, around, thing.size.z())) continue;
      const Vector3d size = thing.size;
      const double yaw = turned ? kPi / 2 : 0;
      Put(std::move(thing), at, yaw, box, around);
      PutChairs(at, size, yaw, chairs);
      return true;
    }
    return false;
  }
  // Puts a piece in front of the last one, facing it.
  bool InFrontOfLast(std::string_view kind, double gap) {
    HouseThing thing = MakeFurniture(kind, rng_);
    const HousePiece& last = house_.pieces.back();
    const double yaw = last.thing.body.yaw;
    const Vector2d front(-std::sin(yaw), std::cos(yaw));
    const double distance = last.thing.size.y() / 2 + gap + thing.size.y() / 2;
    const Vector2d at = last.footprint.center() + distance * front;
    return TryAt(std::move(thing), at, yaw, gap);
  }
  // Puts a chair at the last piece, a desk, facing it.
  void ChairAtLast() {
    const HousePiece last = house_.pieces.back();
    const double yaw = last.thing.body.yaw;
    const Vector2d front(-std::sin(yaw), std::cos(yaw));
    HouseThing chair = MakeFurniture("Chair", rng_);
    const double left = last.thing.size.x() / 2 - 0.42 - last.thing.size.x() / 2;
    const Vector2d along(std::cos(yaw), std::sin(yaw));
    PutFreely(std::move(chair),
              last.footprint.center() + (last.thing.size.y() / 2 + 0.1) * front + left / 2 * along,
              yaw + kPi);
  }
  // Puts a piece beside the last one, at the same wall.
  bool BesideLast(std::string_view kind) {
    const HousePiece last = house_.pieces.back();
    HouseThing thing = MakeFurniture(kind, rng_);
    const double yaw = last.thing.body.yaw;
    const Vector2d along(std::cos(yaw), std::sin(yaw)), front(-std::sin(yaw), std::cos(yaw));
    const double back = (last.thing.size.y() - thing.size.y()) / 2;
    for (const double side : {-1.0, 1.0}) {
      const double distance = (last.thing.size.x() + thing.size.x()) / 2 + 0.03;
      HouseThing copy = thing;
      if (TryAt(std::move(copy), last.footprint.center() + side * distance * along - back * front,
                yaw, 0.3))
        return true;
    }
    return false;
  }

 private:
  struct Taken {
    Box2 box, around;  // the piece, and the piece with the space that it needs
  };

  double FreeLength(const Side& side) const {
    constexpr double kStep = 0.1;
    double best = 0, run = 0;
    for (double at = 0; at + kStep <= side.length; at += kStep) {
      const Vector2d from = side.start + at * side.along;
      const Box2 cell = BoxOf(from, from + kStep * side.along + 0.6 * side.inward);
      const bool free =
          std::ranges::none_of(doors_, [&](const Box2& door) { return Overlap(door, cell); });
      run = free ? run + kStep : 0;
      best = std::max(best, run);
    }
    return best;
  }
  bool IsFree(const Box2& box, const Box2& around, double height) const {
    if (!inner_.contains(box)) return false;
    const auto hits = [&](const Box2& other) { return Overlap(box, other); };
    if (std::ranges::any_of(doors_, hits)) return false;
    if (height > kHigh && std::ranges::any_of(windows_, hits)) return false;
    return std::ranges::none_of(taken_, [&](const Taken& other) {
      return Overlap(box, other.around) || Overlap(around, other.box);
    });
  }
  bool TryAtWall(HouseThing& thing, const Side& side, double at) {
    const double depth = thing.size.y(), half = thing.size.x() / 2;
    const Vector2d back = side.start + at * side.along + kWallGap * side.inward;
    const Box2 box =
        BoxOf(back - half * side.along, back + half * side.along + depth * side.inward);
    Box2 around = box;
    around.extend(back + (depth + kFrontSpace) * side.inward);
    if (!IsFree(box, around, thing.size.z())) return false;
    Put(std::move(thing), back + depth / 2 * side.inward, side.yaw, box, around);
    return true;
  }
  bool TryAt(HouseThing thing, const Vector2d& at, double yaw, double space) {
    const Box2 box = FootprintOf(thing, at, yaw);
    const Box2 around(box.min() - Vector2d::Constant(std::min(space, 0.3)),
                      box.max() + Vector2d::Constant(std::min(space, 0.3)));
    if (!inner_.contains(box)) return false;
    const auto hits = [&](const Box2& other) { return Overlap(box, other); };
    if (std::ranges::any_of(doors_, hits)) return false;
    if (thing.size.z() > kHigh && std::ranges::any_of(windows_, hits)) return false;
    if (std::ranges::any_of(taken_, [&](const Taken& other) { return Overlap(box, other.box); }))
      return false;
    Put(std::move(thing), at, yaw, box, around);
    return true;
  }
  // A chair stands partly below its table.
  void PutFreely(HouseThing thing, const Vector2d& at, double yaw) {
    const Box2 box = FootprintOf(thing, at, yaw);
    if (!inner_.contains(box)) return;
    const auto hits = [&](const Box2& other) { return Overlap(box, other); };
    if (std::ranges::any_of(doors_, hits)) return;
    Put(std::move(thing), at, yaw, box, box);
  }
  static Box2 FootprintOf(const HouseThing& thing, const Vector2d& at, double yaw) {
    const bool turned = std::abs(std::sin(yaw)) > 0.5;
    const Vector2d half = (turned ? Vector2d(thing.size.y(), thing.size.x())
                                  : Vector2d(thing.size.x(), thing.size.y())) /
                          2;
    return {at - half, at + half};
  }
  void PutChairs(const Vector2d& at, const Vector3d& size, double yaw, int count) {
    static constexpr double kTucked = 0.1;  // of the chair's middle from the table's edge
    const Vector2d along(std::cos(yaw), std::sin(yaw)), across(-std::sin(yaw), std::cos(yaw));
    for (int i = 0; i < count; ++i) {
      const double side = i % 2 ? 1 : -1;
      const double shift = count <= 2 ? 0 : (i / 2 ? 1 : -1) * size.x() / 4;
      PutFreely(MakeFurniture("Chair", rng_),
                at + side * (size.y() / 2 + kTucked) * across + shift * along,
                yaw + (side > 0 ? kPi : 0));
    }
  }
  HousePiece& Put(HouseThing thing, const Vector2d& at, double yaw, const Box2& box,
                  const Box2& around) {
    thing.body.pos = {at.x(), at.y(), 0};
    thing.body.yaw = yaw;
    taken_.push_back({box, around});
    house_.pieces.push_back({.thing = std::move(thing), .room = room_, .footprint = box});
    return house_.pieces.back();
  }
  void Undo(size_t before) {
    taken_.resize(taken_.size() - (house_.pieces.size() - before));
    house_.pieces.resize(before);
  }
  // Hangs cupboards above some of the low pieces from number `before` on.
  void AddCupboards(const Side& side, size_t before) {
    const size_t end = house_.pieces.size();
    for (size_t i = before; i < end; ++i) {
      const HousePiece& below = house_.pieces[i];
      const std::string& category = below.thing.category;
      if (category == "Fridge" || category == "Stove" || category == "Sink") continue;
      const auto hits = [&](const Box2& other) { return Overlap(below.footprint, other); };
      if (std::ranges::any_of(windows_, hits) || rng_.Uniform(0, 1) < 0.35) continue;
      HouseThing cupboard = MakeFurniture("WallCupboard", rng_);
      const double shift = (below.thing.size.y() - cupboard.size.y()) / 2;
      const Vector2d at = below.footprint.center() - shift * side.inward;
      cupboard.body.pos = {at.x(), at.y(), 0};
      cupboard.body.yaw = side.yaw;
      const Box2 box = FootprintOf(cupboard, at, side.yaw);
      house_.pieces.push_back(
          {.thing = std::move(cupboard), .room = room_, .is_high = true, .footprint = box});
      taken_.push_back({box, box});
    }
  }

  FurnishedHouse& house_;
  size_t room_;
  Rng& rng_;
  Box2 inner_;
  std::vector<Box2> doors_, windows_;
  std::vector<Taken> taken_;
};

void FurnishRoom(FurnishedHouse& house, size_t room, Rng& rng) {
  RoomFurnisher furnisher(house, room, rng);
  const double area = house.plan.rooms[room].inner().volume();
  const auto chance = [&](double p) { return rng.Uniform(0, 1) < p; };
  switch (house.plan.rooms[room].kind) {
    case RoomKind::kKitchen: {
      static constexpr std::array<std::string_view, 7> kRow = {
          "Fridge", "Counter", "Sink", "DrawerUnit", "Stove", "Counter", "DrawerUnit"};
      furnisher.Row(kRow);
      if (!furnisher.InMiddle("DiningTable", area > 13 ? 4 : 2)) furnisher.AtWall("SideTable");
      break;
    }
    case RoomKind::kLiving:
      if (furnisher.AtWall("Sofa")) furnisher.InFrontOfLast("CoffeeTable", 0.32);
      furnisher.AtWall("Sideboard");
      furnisher.AtWall("Bookshelf");
      if (area > 12) furnisher.InMiddle("DiningTable", 2);
      if (chance(0.6)) furnisher.AtWall("SideTable");
      break;
    case RoomKind::kBedroom:
      if (furnisher.AtWall("Bed")) furnisher.BesideLast("Nightstand");
      furnisher.AtWall("Wardrobe");
      if (chance(0.6) && furnisher.AtWall("Desk")) furnisher.ChairAtLast();
      if (chance(0.4)) furnisher.AtWall("SideTable");
      break;
    case RoomKind::kOffice:
      for (int i = 0; i < (area > 12 ? 2 : 1); ++i) {
        if (furnisher.AtWall("Desk")) furnisher.ChairAtLast();
      }
      furnisher.AtWall("FilingCabinet");
      furnisher.AtWall("Bookshelf");
      if (chance(0.5)) furnisher.AtWall("SideTable");
      break;
    case RoomKind::kWorkshop:
      furnisher.AtWall("Workbench");
      furnisher.AtWall("ToolShelf");
      if (area > 11) furnisher.AtWall("Workbench");
      if (chance(0.5)) furnisher.AtWall("FilingCabinet");
      break;
    case RoomKind::kWarehouse:
      for (int i = 0; i < (area > 14 ? 3 : 2); ++i) furnisher.AtWall("PalletRack");
      furnisher.AtWall("ToolShelf");
      if (chance(0.5)) furnisher.AtWall("Workbench");
      break;
  }
}

// "CoffeeTable" -> "coffee_table".
std::string Lemma(const std::string& category) {
  std::string words = WordsOfCategory(category);
  std::ranges::replace(words, ' ', '_');
  return words;
}

// Gives bodies, joints and parts in the tree below a body full names.
void NameChildren(HouseBody& body, const std::string& prefix) {
  for (HouseBody& child : body.children) {
    child.name = prefix + "_" + child.name;
    if (child.joint) child.joint->name = prefix + "_" + child.joint->name;
    // Parts and joints of children begin with the child's own name already.
    int unnamed = 0;
    for (HousePart& part : child.parts)
      part.name = part.name.empty() ? child.name + "_part_" + std::to_string(unnamed++)
                                    : prefix + "_" + part.name;
    NameChildren(child, prefix);
  }
}

void NameAll(HouseBody& body, const std::string& prefix) {
  int count = 0;
  for (HousePart& part : body.parts)
    part.name = prefix + "_" + (part.name.empty() ? "part_" + std::to_string(count++) : part.name);
  NameChildren(body, prefix);
}

class Namer {
 public:
  void Name(HousePiece& piece) {
    const std::string lemma = Lemma(piece.thing.category);
    piece.thing.body.name = fmt::format("{}_{}_0_{}", lemma, ++counts_[lemma], piece.room + 1);
    NameAll(piece.thing.body, piece.thing.body.name);
  }

 private:
  std::map<std::string, int> counts_;
};

// Returns the slots of a body and its children in the world.
void CollectSlots(const HouseBody& body, const Pose& parent, size_t piece,
                  std::vector<FilledSlot>& slots) {
  const Pose here = parent * Pose::FromRpy(body.pos, {0, 0, body.yaw});
  for (const HouseSlot& slot : body.slots)
    slots.push_back(
        {.piece = piece, .body = body.name, .frame_to_world = here * Pose(slot.pos), .slot = slot});
  for (const HouseBody& child : body.children) CollectSlots(child, here, piece, slots);
}

// Puts objects into slots.
class Filler {
 public:
  Filler(FurnishedHouse& house, Rng& rng) : house_(house), rng_(rng) {}

  // Puts up to `count` objects into a slot; it may stay empty.
  void Fill(FilledSlot& slot, int count) {
    const RoomKind kind = house_.plan.rooms[house_.pieces[slot.piece].room].kind;
    std::vector<std::string> kinds = HouseObjectsOf(kind);
    std::vector<std::pair<Vector2d, double>> taken;
    for (int i = 0; i < count; ++i) {
      rng_.Shuffle(kinds);
      for (const std::string& each : kinds) {
        if (TryPut(slot, MakeHouseObject(each, rng_), taken)) break;
      }
    }
    if (!slot.objects.empty()) house_.slots.push_back(slot);
  }

 private:
  bool TryPut(FilledSlot& slot, HouseThing thing, std::vector<std::pair<Vector2d, double>>& taken) {
    const HouseSlot& space = slot.slot;
    if (thing.size.z() + kHeadroom > space.height) return false;
    const double radius = std::hypot(thing.size.x(), thing.size.y()) / 2;
    // An object as long as the slot lies along it.
    const bool fits_turned = radius <= std::min(space.half_x, space.half_y);
    double half_x = radius, half_y = radius, turn = rng_.Uniform(-kPi, kPi);
    if (!fits_turned) {
      const bool across = (space.half_x < space.half_y) != (thing.size.x() < thing.size.y());
      turn = across ? kPi / 2 : 0;
      half_x = (across ? thing.size.y() : thing.size.x()) / 2;
      half_y = (across ? thing.size.x() : thing.size.y()) / 2;
      if (half_x > space.half_x || half_y > space.half_y) return false;
    }
    for (int t = 0; t < kTries; ++t) {
      const double u = rng_.Uniform(-1, 1), v = rng_.Uniform(-1, 1);
      const Vector2d at(u * (space.half_x - half_x), v * (space.half_y - half_y));
      const bool free = std::ranges::none_of(taken, [&](const auto& other) {
        return (other.first - at).norm() < other.second + radius + kObjectSpace;
      });
      if (!free) continue;
      taken.emplace_back(at, radius);
      const Pose pose = slot.frame_to_world * Pose(Vector3d(at.x(), at.y(), kDrop));
      thing.body.pos = pose.translation();
      thing.body.yaw = turn + house_.pieces[slot.piece].thing.body.yaw;
      slot.objects.push_back(house_.objects.size());
      house_.objects.push_back({.thing = std::move(thing), .room = house_.pieces[slot.piece].room});
      return true;
    }
    return false;
  }

  FurnishedHouse& house_;
  Rng& rng_;
};

// Returns them with two surfaces before each container, as long as there are both.
std::vector<FilledSlot> Mixed(std::vector<FilledSlot> all) {
  std::vector<FilledSlot> surfaces, containers, mixed;
  for (FilledSlot& slot : all)
    (slot.slot.is_container ? containers : surfaces).push_back(std::move(slot));
  size_t surface = 0, container = 0;
  while (mixed.size() < all.size()) {
    for (int i = 0; i < 2 && surface < surfaces.size(); ++i)
      mixed.push_back(std::move(surfaces[surface++]));
    if (container < containers.size()) mixed.push_back(std::move(containers[container++]));
  }
  return mixed;
}

}  // namespace

std::vector<Box2> DoorAreas(const FloorPlan& plan, size_t room) {
  std::vector<Box2> areas;
  for (const PlanWall& wall : plan.walls) {
    const bool below = wall.below == static_cast<int>(room),
               above = wall.above == static_cast<int>(room);
    if (!below && !above) continue;
    for (const PlanOpening& opening : wall.openings) {
      if (!opening.is_door) continue;
      const double half = opening.width / 2 + 0.05, depth = kDoorSpace + kWallThickness / 2;
      const Vector2d inward = wall.up() * (above ? 1 : -1);
      areas.push_back(
          BoxOf(wall.at(opening.at - half), wall.at(opening.at + half) + depth * inward));
    }
  }
  return areas;
}

FurnishedHouse Furnish(FloorPlan plan, const FurnishingOptions& options, Rng& rng) {
  FurnishedHouse house{.plan = std::move(plan), .pieces = {}, .objects = {}, .slots = {}};
  Rng furniture_rng = rng.Fork("furniture"), object_rng = rng.Fork("objects");
  for (size_t room = 0; room < house.plan.rooms.size(); ++room) {
    Rng own = furniture_rng.Fork(room);
    FurnishRoom(house, room, own);
  }
  Namer namer;
  std::vector<FilledSlot> all;
  for (size_t i = 0; i < house.pieces.size(); ++i) {
    namer.Name(house.pieces[i]);
    CollectSlots(house.pieces[i].thing.body, Pose(), i, all);
  }
  // Two surfaces for each container, which cannot be seen into.
  object_rng.Shuffle(all);
  all = Mixed(std::move(all));
  Filler filler(house, object_rng);
  // Some surfaces hold more than one object.
  int spare =
      std::max(options.most_objects / 3, options.most_objects - static_cast<int>(all.size()));
  for (FilledSlot& slot : all) {
    const int left = options.most_objects - static_cast<int>(house.objects.size());
    if (left <= 0) break;
    int count = 1;
    if (!slot.slot.is_container && spare > 0) {
      const int more = std::min(spare, static_cast<int>(object_rng.UniformInt(kMostInSlot)));
      count += more;
      spare -= more;
    }
    filler.Fill(slot, std::min(count, left));
  }
  for (HousePiece& object : house.objects) namer.Name(object);
  return house;
}

void RemoveObjects(FurnishedHouse& house, std::vector<size_t> objects) {
  std::ranges::sort(objects, std::greater<>());
  objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
  for (const size_t object : objects) {
    house.objects.erase(house.objects.begin() + static_cast<std::ptrdiff_t>(object));
    for (FilledSlot& slot : house.slots) {
      std::erase(slot.objects, object);
      for (size_t& other : slot.objects) other -= other > object;
    }
  }
  std::erase_if(house.slots, [](const FilledSlot& slot) { return slot.objects.empty(); });
}

}  // namespace robocell::internal
