#include "robocell/scenes/houses/make_houses.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <utility>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/make_directories.h"
#include "robocell/base/paths.h"
#include "robocell/base/real_file.h"
#include "robocell/base/rng.h"
#include "robocell/base/version.h"
#include "robocell/scenes/houses/house_map.h"
#include "robocell/scenes/houses/house_metadata.h"
#include "robocell/scenes/houses/house_model.h"
#include "robocell/scenes/houses/house_textures.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using internal::FurnishedHouse;
using internal::HouseBody;
using internal::HouseMap;
using internal::HouseMetadata;
using internal::HouseObject;
using internal::HousePiece;
using internal::PlanOpening;
using internal::PlanRoom;
using internal::PlanWall;
using internal::RoomKind;

constexpr double kPixelsPerMetre = 50, kMapMargin = 0.5;  // the margin around the house, metres
constexpr double kWorkplaces = 0.25;                      // share of buildings without a home
constexpr const char* kOptionsFile = "houses.json";
constexpr int kGenerator = 1;  // changes with what houses look like

std::string NameOfHouse(const HouseOptions& options, int index) {
  return options.prefix + std::to_string(index);
}

HouseMap MapOf(const FurnishedHouse& house) {
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(kMapMargin);
  HouseMap map = internal::MakeHouseMap(house.plan.outline.min() - margin,
                                        house.plan.outline.max() + margin, kPixelsPerMetre);
  const auto fill = [&](const Eigen::AlignedBox2d& box, bool free, int room) {
    for (int row = 0; row < map.rows; ++row) {
      for (int column = 0; column < map.columns; ++column) {
        if (!box.contains(map.PositionOf(row, column))) continue;
        const size_t pixel = static_cast<size_t>(row) * static_cast<size_t>(map.columns) +
                             static_cast<size_t>(column);
        map.free[pixel] = free;
        if (room > 0) map.room[pixel] = static_cast<uint8_t>(room);
      }
    }
  };
  for (size_t i = 0; i < house.plan.rooms.size(); ++i) {
    const PlanRoom& room = house.plan.rooms[i];
    fill(room.inner(), true, static_cast<int>(i) + 1);
    map.room_names[static_cast<int>(i) + 1] = room.name;
  }
  for (const PlanWall& wall : house.plan.walls) {
    for (const PlanOpening& opening : wall.openings) {
      if (!opening.is_door) continue;
      const Eigen::Vector2d half = wall.up() * internal::kWallThickness / 2;
      Eigen::AlignedBox2d way(wall.at(opening.at - opening.width / 2) - half);
      way.extend(wall.at(opening.at + opening.width / 2) + half);
      fill(way, true, std::max(wall.below, wall.above) + 1);
    }
  }
  for (const HousePiece& piece : house.pieces) {
    if (!piece.is_high) fill(piece.footprint, false, 0);
  }
  return map;
}

void CollectNames(const HouseBody& body, HouseObject& object) {
  object.bodies[body.name] = body.name;
  if (body.joint) object.joints[body.joint->name] = body.joint->name;
  for (const HouseBody& child : body.children) CollectNames(child, object);
}

HouseObject ObjectOf(const HousePiece& piece) {
  HouseObject object{.category = piece.thing.category,
                     .asset = "robocell_" + piece.thing.category,
                     .id = piece.thing.body.name,
                     .words = piece.thing.words,
                     .room = static_cast<int>(piece.room) + 1,
                     .is_static = !piece.thing.body.is_free};
  CollectNames(piece.thing.body, object);
  return object;
}

HouseMetadata MetadataOf(const FurnishedHouse& house) {
  HouseMetadata metadata;
  for (const HousePiece& piece : house.pieces)
    metadata.objects[piece.thing.body.name] = ObjectOf(piece);
  for (const HousePiece& piece : house.objects)
    metadata.objects[piece.thing.body.name] = ObjectOf(piece);
  std::map<std::string, int> counts;
  for (const internal::FilledSlot& slot : house.slots) {
    const std::string& piece = house.pieces[slot.piece].thing.body.name;
    HouseObject& holder = metadata.objects.at(piece);
    const std::string site = internal::SlotSiteName(slot, counts[slot.body]++);
    holder.sites[site] = site;
    for (const size_t object : slot.objects) {
      const std::string& name = house.objects[object].thing.body.name;
      holder.children.push_back(name);
      metadata.objects.at(name).parent = piece;
    }
  }
  for (const PlanWall& wall : house.plan.walls) {
    for (const PlanOpening& opening : wall.openings) {
      if (!opening.is_door) continue;
      HouseObject door{.category = "Door",
                       .asset = "robocell_Door",
                       .id = opening.name,
                       .room = std::max(wall.below, wall.above) + 1,
                       .is_static = true};
      for (const std::string& body : {opening.name, opening.name + "_leaf"})
        door.bodies[body] = body;
      door.joints[opening.name + "_hinge"] = opening.name + "_hinge";
      metadata.objects[opening.name] = std::move(door);
    }
  }
  return metadata;
}

int JointsOf(const HouseBody& body) {
  int count = body.joint ? 1 : 0;
  for (const HouseBody& child : body.children) count += JointsOf(child);
  return count;
}

std::string OptionsText(const HouseOptions& options) {
  nlohmann::ordered_json json = {{"generator", kGenerator},
                                 {"robocell", std::string(Version())},
                                 {"seed", options.seed},
                                 {"rooms", {options.least_rooms, options.most_rooms}},
                                 {"most_objects", options.most_objects}};
  return json.dump(1) + "\n";
}

}  // namespace

void HouseOptions::Validate() const {
  if (least_rooms < 1 || most_rooms < least_rooms || most_rooms > kMostRooms)
    throw ArgumentError(fmt::format("rooms: {} to {}; give 1 to {}, the smaller number first",
                                    least_rooms, most_rooms, kMostRooms));
  if (kinds.size() > size_t{kMostRooms})
    throw ArgumentError(fmt::format("kinds: {} rooms; give up to {}", kinds.size(), kMostRooms));
  if (most_objects < 0 || most_objects > kMostObjects)
    throw ArgumentError(fmt::format("most_objects: {}; give 0 to {}", most_objects, kMostObjects));
  if (!internal::ValidFileName(prefix + "0"))
    throw ArgumentError(fmt::format("prefix: '{}' is not the beginning of a file's name", prefix));
}

FurnishedHouse PlanHouse(const HouseOptions& options, int index) {
  options.Validate();
  Rng rng = Rng::Stream(options.seed, "house", index);
  internal::PlanOptions plan{.rooms = static_cast<int>(options.kinds.size()),
                             .kinds = options.kinds};
  if (options.kinds.empty()) {
    const int span = std::max(0, options.most_rooms - options.least_rooms);
    plan.rooms =
        options.least_rooms + static_cast<int>(rng.UniformInt(static_cast<uint64_t>(span) + 1));
    static constexpr std::array kWork = {RoomKind::kWarehouse, RoomKind::kWorkshop,
                                         RoomKind::kOffice};
    if (rng.Uniform(0, 1) < kWorkplaces) plan.kinds = {kWork.begin(), kWork.end()};
    if (static_cast<int>(plan.kinds.size()) > plan.rooms)
      plan.kinds.resize(static_cast<size_t>(plan.rooms));
  }
  Rng plan_rng = rng.Fork("plan"), furnishing = rng.Fork("furnishing");
  return internal::Furnish(internal::MakeFloorPlan(plan, plan_rng),
                           {.most_objects = options.most_objects}, furnishing);
}

void PrepareHouseFolder(const fs::path& folder, const HouseOptions& options) {
  options.Validate();
  internal::MakeDirectories(folder / internal::kTextureFolder);
  const fs::path file = folder / kOptionsFile;
  const std::string text = OptionsText(options);
  if (internal::CanReadFile(file) && internal::ReadRealFile(file) != text)
    throw ArgumentError(fmt::format(
        "'{}' has houses of other options, or of another version: {}. Give another folder",
        folder.string(), internal::ReadRealFile(file)));
  for (const internal::HouseTexture& texture : internal::HouseTextures()) {
    const fs::path png = folder / internal::kTextureFolder / (texture.name + ".png");
    const std::string_view bytes(reinterpret_cast<const char*>(texture.png.data()),
                                 texture.png.size());
    if (!internal::CanReadFile(png)) AtomicWrite(png, bytes);
  }
  AtomicWrite(file, text);
}

bool HasHouse(const fs::path& folder, const HouseOptions& options, int index) {
  return internal::CanReadFile(folder / (NameOfHouse(options, index) + ".xml"));
}

HouseSummary MakeHouseFiles(const fs::path& folder, const HouseOptions& options, int index) {
  const std::string name = NameOfHouse(options, index);
  internal::SettledHouse settled =
      internal::SettleHouse(PlanHouse(options, index), name, fs::absolute(folder));
  const FurnishedHouse& house = settled.house;
  const std::vector<uint8_t> map = internal::EncodeHouseMap(MapOf(house));
  AtomicWrite(folder / (name + "_map.png"),
              std::string_view(reinterpret_cast<const char*>(map.data()), map.size()));
  AtomicWrite(folder / (name + "_metadata.json"), internal::HouseMetadataText(MetadataOf(house)));
  AtomicWrite(folder / (name + "_ceiling.xml"), settled.ceiling_xml);
  AtomicWrite(folder / (name + ".xml"), settled.xml);
  HouseSummary summary{.name = name,
                       .rooms = static_cast<int>(house.plan.rooms.size()),
                       .pieces = static_cast<int>(house.pieces.size()),
                       .objects = static_cast<int>(house.objects.size()),
                       .slots = static_cast<int>(house.slots.size()),
                       .removed = settled.removed};
  for (const HousePiece& piece : house.pieces) summary.joints += JointsOf(piece.thing.body);
  for (const PlanWall& wall : house.plan.walls)
    summary.joints +=
        static_cast<int>(std::ranges::count(wall.openings, true, &PlanOpening::is_door));
  return summary;
}

}  // namespace robocell
