#include "robocell/scenes/houses/furniture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "robocell/base/error.h"

namespace robocell::internal {
namespace {

using Eigen::Vector3d;

constexpr double kFrontGap = 0.003;  // around doors and fronts of drawers
constexpr double kDoorThickness = 0.018;
constexpr double kMostPull = 0.4;  // of a drawer

std::string Wood(Rng& rng) {
  static constexpr std::array kWoods = {"oak", "walnut", "pine"};
  return kWoods[rng.UniformInt(kWoods.size())];
}
std::string Fabric(Rng& rng) {
  static constexpr std::array kFabrics = {"fabric_blue", "fabric_gray", "fabric_green",
                                          "fabric_sand"};
  return kFabrics[rng.UniformInt(kFabrics.size())];
}

void AddHandle(HouseBody& body, const std::string& name, const Vector3d& middle,
               const Vector3d& along, double half) {
  constexpr double kOut = 0.035;  // in front of the door
  HousePart bar = Capsule(middle + Vector3d(0, kOut, 0), 0.006, half, "steel", along);
  bar.name = name;
  body.parts.push_back(bar);
  for (const double side : {-1.0, 1.0}) {
    HousePart holder = Capsule(middle + side * half * along + Vector3d(0, kOut / 2, 0), 0.005,
                               kOut / 2, "steel", Vector3d::UnitY());
    holder.name = name + (side < 0 ? "_a" : "_b");
    body.parts.push_back(holder);
  }
}

void AddLegs(HouseBody& body, double x, double y, double height, double half,
             const std::string& material) {
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0})
      body.parts.push_back(
          Box({sx * (x - half), sy * (y - half), height / 2}, {half, half, height / 2}, material));
  }
}

HouseThing MakeTable(const std::string& category, const Vector3d& size, Rng& rng) {
  HouseThing thing{.category = category, .size = size};
  const std::string wood = Wood(rng);
  constexpr double kBoard = 0.03;
  thing.body.parts.push_back(
      Box({0, 0, size.z() - kBoard / 2}, {size.x() / 2, size.y() / 2, kBoard / 2}, wood));
  AddLegs(thing.body, size.x() / 2 - 0.03, size.y() / 2 - 0.03, size.z() - kBoard, 0.025, wood);
  thing.body.slots.push_back(
      {{0, 0, size.z()}, size.x() / 2 - 0.06, size.y() / 2 - 0.06, 0.5, false});
  return thing;
}

HouseThing MakeChair(Rng& rng) {
  const double width = 0.43, depth = 0.44, seat = 0.45, height = 0.88;
  HouseThing thing{.category = "Chair", .size = {width, depth, height}};
  const std::string wood = Wood(rng);
  HouseBody& body = thing.body;
  body.parts.push_back(Box({0, 0, seat - 0.02}, {width / 2, depth / 2, 0.02}, Fabric(rng)));
  AddLegs(body, width / 2, depth / 2, seat - 0.04, 0.018, wood);
  body.parts.push_back(Box({0, -depth / 2 + 0.014, 0.74}, {width / 2, 0.014, height - 0.74}, wood));
  for (const double side : {-1.0, 1.0})
    body.parts.push_back(Box({side * (width / 2 - 0.018), -depth / 2 + 0.014, (seat + 0.6) / 2},
                             {0.018, 0.014, (0.6 - seat) / 2}, wood));
  return thing;
}

HouseThing MakeSofa(Rng& rng) {
  const double width = rng.Uniform(1.6, 2.0), depth = 0.85, seat = 0.42, height = 0.8;
  HouseThing thing{.category = "Sofa", .size = {width, depth, height}};
  const std::string fabric = Fabric(rng);
  HouseBody& body = thing.body;
  body.parts.push_back(Box({0, 0, 0.03}, {width / 2 - 0.05, depth / 2 - 0.05, 0.03}, "dark"));
  body.parts.push_back(Box({0, 0, 0.17}, {width / 2, depth / 2, 0.11}, fabric));
  body.parts.push_back(Box({0, -depth / 2 + 0.1, 0.54}, {width / 2, 0.1, height - 0.54}, fabric));
  for (const double side : {-1.0, 1.0}) {
    body.parts.push_back(
        Box({side * (width / 2 - 0.08), 0.1, 0.43}, {0.08, depth / 2 - 0.1, 0.15}, fabric));
    const double half = (width / 2 - 0.16) / 2;
    body.parts.push_back(
        Box({side * half, 0.1, 0.35}, {half - 0.004, depth / 2 - 0.1, 0.07}, fabric));
  }
  body.slots.push_back({{0, 0.14, seat}, width / 2 - 0.24, 0.2, 0.5, false});
  return thing;
}

HouseThing MakeBed(Rng& rng) {
  const double width = rng.Uniform(1.0, 1.6), length = 2.05, top = 0.52;
  HouseThing thing{.category = "Bed", .size = {width, length, 0.95}};
  const std::string wood = Wood(rng), cover = Fabric(rng);
  HouseBody& body = thing.body;
  body.parts.push_back(Box({0, 0, 0.16}, {width / 2, length / 2, 0.12}, wood));
  body.parts.push_back(Box({0, 0.02, 0.39}, {width / 2 - 0.03, length / 2 - 0.05, 0.11}, "linen"));
  HousePart blanket = Box({0, 0.3, 0.505}, {width / 2 - 0.01, length / 2 - 0.32, 0.015}, cover);
  body.parts.push_back(blanket);
  body.parts.push_back(Box({0, -length / 2 + 0.025, 0.475}, {width / 2, 0.025, 0.475}, wood));
  body.parts.push_back(Box({0, -length / 2 + 0.28, 0.54}, {0.3, 0.18, 0.04}, "linen"));
  body.slots.push_back({{0, 0.3, top}, width / 2 - 0.12, length / 2 - 0.45, 0.5, false});
  return thing;
}

// A closed piece with fronts: drawers from below, and one or two doors above them.
struct CabinetPlan {
  std::string category;
  double width, depth, height;
  int drawers;
  double drawer_height;
  int doors;    // side by side
  int shelves;  // behind the doors
};
HouseThing MakeCabinet(const CabinetPlan& plan, Rng& rng) {
  HouseThing thing{.category = plan.category, .size = {plan.width, plan.depth, plan.height}};
  HouseBody& body = thing.body;
  const std::string wood = Wood(rng);
  const double front = plan.depth / 2 - 0.022, low = 0.04, half = plan.width / 2;
  body.parts.push_back(
      Box({0, -0.02, low / 2}, {half - 0.02, plan.depth / 2 - 0.04, low / 2}, "dark"));
  AddCarcass(body, {-half, -plan.depth / 2, low}, {half, front, plan.height}, wood);
  const double inner_depth = front + plan.depth / 2 - kPanel;
  double z = low;
  for (int i = 0; i < plan.drawers; ++i, z += plan.drawer_height)
    body.children.push_back(MakeDrawer(fmt::format("drawer_{}", i),
                                       {-half, half, z, z + plan.drawer_height, front}, inner_depth,
                                       wood));
  const double middle = (front - plan.depth / 2) / 2;
  if (plan.doors > 0) {
    if (plan.drawers > 0)
      body.parts.push_back(
          Box({0, middle, z}, {half - kPanel, inner_depth / 2 - 0.005, kPanel / 2}, wood));
    const double step = (plan.height - z) / (plan.shelves + 1);
    for (int i = 0; i <= plan.shelves; ++i) {
      const double floor = i == 0 ? z + kPanel : z + i * step + kPanel / 2;
      if (i > 0)
        body.parts.push_back(Box({0, middle - 0.01, z + i * step},
                                 {half - kPanel, inner_depth / 2 - 0.02, kPanel / 2}, wood));
      body.slots.push_back({{0, middle - 0.02, floor},
                            half - 0.06,
                            inner_depth / 2 - 0.06,
                            step - 2 * kPanel,
                            true});
    }
    const double width = plan.width / plan.doors;
    for (int i = 0; i < plan.doors; ++i) {
      const Front door{-half + i * width, -half + (i + 1) * width, z, plan.height, front};
      const bool left = plan.doors == 2 ? i == 0 : rng.Uniform(0, 1) < 0.5;
      body.children.push_back(MakeDoor(fmt::format("door_{}", i), door, left, wood));
    }
  }
  if (plan.height < 1.5)
    body.slots.push_back({{0, 0, plan.height}, half - 0.05, plan.depth / 2 - 0.06, 0.5, false});
  return thing;
}

HouseThing MakeShelf(const std::string& category, double width, double depth, double height,
                     int boards, const std::string& material, bool back) {
  HouseThing thing{.category = category, .size = {width, depth, height}};
  HouseBody& body = thing.body;
  for (const double side : {-1.0, 1.0})
    body.parts.push_back(Box({side * (width / 2 - kPanel / 2), 0, height / 2},
                             {kPanel / 2, depth / 2, height / 2}, material));
  if (back)
    body.parts.push_back(Box({0, -depth / 2 + 0.005, height / 2},
                             {width / 2 - kPanel, 0.005, height / 2}, material));
  const double step = (height - 0.06) / (boards - 1);
  for (int i = 0; i < boards; ++i) {
    const double z = 0.05 + i * step;
    body.parts.push_back(
        Box({0, 0.005, z}, {width / 2 - kPanel, depth / 2 - 0.006, kPanel / 2}, material));
    const double above = i + 1 < boards ? step - kPanel : 0.4;
    if (z < 1.7)
      body.slots.push_back(
          {{0, 0.01, z + kPanel / 2}, width / 2 - 0.07, depth / 2 - 0.05, above, false});
  }
  return thing;
}

HouseThing MakeDesk(Rng& rng) {
  const double width = rng.Uniform(1.2, 1.5), depth = 0.7, height = 0.74, block = 0.42;
  HouseThing thing{.category = "Desk", .size = {width, depth, height}};
  const std::string wood = Wood(rng);
  HouseBody& body = thing.body;
  body.parts.push_back(Box({0, 0, height - 0.015}, {width / 2, depth / 2, 0.015}, wood));
  body.parts.push_back(Box({-width / 2 + 0.02, 0, (height - 0.03) / 2},
                           {0.02, depth / 2 - 0.03, (height - 0.03) / 2}, wood));
  const double front = depth / 2 - 0.05, left = width / 2 - block, high = height - 0.03;
  AddCarcass(body, {left, -depth / 2 + 0.03, 0.05}, {width / 2, front, high}, wood);
  body.parts.push_back(
      Box({left + block / 2, 0, 0.025}, {block / 2 - 0.02, depth / 2 - 0.08, 0.025}, "dark"));
  const double third = (high - 0.05) / 3;
  for (int i = 0; i < 3; ++i)
    body.children.push_back(
        MakeDrawer(fmt::format("drawer_{}", i),
                   {left, width / 2, 0.05 + i * third, 0.05 + (i + 1) * third, front}, 0.5, wood));
  body.slots.push_back({{0, 0, height}, width / 2 - 0.06, depth / 2 - 0.07, 0.5, false});
  return thing;
}

HouseThing MakeWorkbench(Rng& rng) {
  const double width = rng.Uniform(1.4, 1.8), depth = 0.68, height = 0.88;
  HouseThing thing{.category = "Workbench", .size = {width, depth, height}};
  HouseBody& body = thing.body;
  body.parts.push_back(Box({0, 0, height - 0.03}, {width / 2, depth / 2, 0.03}, "pine"));
  AddLegs(body, width / 2, depth / 2, height - 0.06, 0.035, "steel_blue");
  body.parts.push_back(Box({0, 0, 0.22}, {width / 2 - 0.07, depth / 2 - 0.07, 0.01}, "pine"));
  body.parts.push_back(
      Box({0, -depth / 2 + 0.035, height - 0.11}, {width / 2 - 0.07, 0.015, 0.05}, "steel_blue"));
  // A vice at the front corner.
  body.parts.push_back(
      Box({-width / 2 + 0.16, depth / 2 - 0.1, height + 0.05}, {0.06, 0.03, 0.05}, "iron"));
  body.parts.push_back(
      Box({-width / 2 + 0.16, depth / 2 - 0.02, height + 0.06}, {0.06, 0.012, 0.04}, "iron"));
  body.slots.push_back({{0.14, 0, height}, width / 2 - 0.22, depth / 2 - 0.07, 0.5, false});
  body.slots.push_back({{0, 0, 0.23}, width / 2 - 0.18, depth / 2 - 0.14, 0.4, false});
  return thing;
}

HouseThing MakePalletRack(Rng& rng) {
  const double width = rng.Uniform(1.8, 2.2), depth = 0.9, height = 2.1;
  HouseThing thing{.category = "PalletRack", .size = {width, depth, height}};
  HouseBody& body = thing.body;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0})
      body.parts.push_back(Box({x * (width / 2 - 0.04), y * (depth / 2 - 0.04), height / 2},
                               {0.04, 0.04, height / 2}, "steel_blue"));
  }
  for (const double z : {0.15, 0.85, 1.55}) {
    for (const double y : {-1.0, 1.0})
      body.parts.push_back(Box({0, y * (depth / 2 - 0.03), z - 0.06},
                               {width / 2 - 0.08, 0.025, 0.05}, "steel_orange"));
    body.parts.push_back(Box({0, 0, z}, {width / 2 - 0.08, depth / 2 - 0.01, 0.012}, "pine"));
    body.slots.push_back({{0, 0, z + 0.012}, width / 2 - 0.16, depth / 2 - 0.1, 0.55, false});
  }
  return thing;
}

using FurnitureMaker = HouseThing (*)(Rng&);
constexpr std::pair<const char*, FurnitureMaker> kFurnitureMakers[] = {
    {"Counter", [](Rng& rng) { return MakeCounter(rng, false); }},
    {"DrawerUnit", [](Rng& rng) { return MakeCounter(rng, true); }},
    {"Sink", MakeSink},
    {"Stove", MakeStove},
    {"Fridge", MakeFridge},
    {"WallCupboard", MakeWallCupboard},
    {"DiningTable",
     [](Rng& rng) {
       const Vector3d size(rng.Uniform(1.2, 1.6), rng.Uniform(0.75, 0.9), 0.74);
       return MakeTable("DiningTable", size, rng);
     }},
    {"CoffeeTable",
     [](Rng& rng) {
       const Vector3d size(rng.Uniform(0.8, 1.1), rng.Uniform(0.5, 0.6), rng.Uniform(0.38, 0.45));
       return MakeTable("CoffeeTable", size, rng);
     }},
    {"SideTable",
     [](Rng& rng) {
       const double side = rng.Uniform(0.45, 0.6);
       return MakeTable("SideTable", {side, side, rng.Uniform(0.5, 0.7)}, rng);
     }},
    {"Chair", MakeChair},
    {"Sofa", MakeSofa},
    {"Bed", MakeBed},
    {"Desk", MakeDesk},
    {"Workbench", MakeWorkbench},
    {"PalletRack", MakePalletRack},
    {"Sideboard",
     [](Rng& rng) {
       return MakeCabinet({"Sideboard", rng.Uniform(1.1, 1.4), 0.42, 0.78, 1, 0.22, 2, 0}, rng);
     }},
    {"Nightstand",
     [](Rng& rng) {
       return MakeCabinet({"Nightstand", 0.48, 0.42, 0.52, 2, 0.235, 0, 0}, rng);
     }},
    {"Wardrobe",
     [](Rng& rng) {
       return MakeCabinet({"Wardrobe", rng.Uniform(0.95, 1.2), 0.58, 2.0, 1, 0.3, 2, 2}, rng);
     }},
    {"FilingCabinet",
     [](Rng& rng) {
       return MakeCabinet({"FilingCabinet", 0.46, 0.6, 1.06, 3, 0.336, 0, 0}, rng);
     }},
    {"Bookshelf",
     [](Rng& rng) {
       const double width = rng.Uniform(0.8, 1.0);
       return MakeShelf("Bookshelf", width, 0.32, 1.85, 5, Wood(rng), true);
     }},
    {"ToolShelf",
     [](Rng& rng) {
       return MakeShelf("ToolShelf", rng.Uniform(0.9, 1.2), 0.45, 1.8, 4, "steel_blue", false);
     }},
};

}  // namespace

void AddCarcass(HouseBody& body, const Vector3d& low, const Vector3d& high,
                const std::string& material) {
  const Vector3d middle = (low + high) / 2, half = (high - low) / 2;
  const double t = kPanel / 2;
  for (const double side : {-1.0, 1.0}) {
    body.parts.push_back(Box({middle.x() + side * (half.x() - t), middle.y(), middle.z()},
                             {t, half.y(), half.z()}, material));
    body.parts.push_back(Box({middle.x(), middle.y(), middle.z() + side * (half.z() - t)},
                             {half.x() - kPanel, half.y(), t}, material));
  }
  body.parts.push_back(Box({middle.x(), low.y() + t, middle.z()},
                           {half.x() - kPanel, t, half.z() - kPanel}, material));
}

HouseBody MakeDoor(const std::string& name, const Front& front, bool hinge_left,
                   const std::string& material) {
  const double width = front.right - front.left - 2 * kFrontGap;
  const double height = front.high - front.low - 2 * kFrontGap;
  const double side = hinge_left ? 1 : -1;  // from the hinge to the door's other edge
  HouseBody door{.name = name,
                 .pos = {hinge_left ? front.left + kFrontGap : front.right - kFrontGap,
                         front.y + kFrontGap, (front.low + front.high) / 2}};
  door.joint = HouseJoint{.name = name + "_hinge",
                          .axis = side * Vector3d::UnitZ(),
                          .range = 1.75,
                          .damping = 0.2,
                          .friction = 0.1};
  door.parts.push_back(Box({side * width / 2, kDoorThickness / 2, 0},
                           {width / 2, kDoorThickness / 2, height / 2}, material));
  door.parts.back().name = name + "_panel";
  const double grip = std::min(0.07, height / 4);
  // High doors have their handle at the height of a hand, cupboards on the wall at their lower edge.
  const double up =
      std::clamp(1.0 - door.pos.z(), -height / 2 + grip + 0.06, height / 2 - grip - 0.06);
  AddHandle(door, name + "_handle", {side * (width - 0.045), kDoorThickness, up}, Vector3d::UnitZ(),
            grip);
  return door;
}

HouseBody MakeDrawer(const std::string& name, const Front& front, double depth,
                     const std::string& material) {
  const double half_width = (front.right - front.left) / 2 - kFrontGap;
  const double half_height = (front.high - front.low) / 2 - kFrontGap;
  HouseBody drawer{
      .name = name,
      .pos = {(front.left + front.right) / 2, front.y + kFrontGap, (front.low + front.high) / 2}};
  const double reach = depth - 0.03;  // of the box behind the front
  drawer.joint = HouseJoint{.name = name + "_slide",
                            .is_slide = true,
                            .axis = Vector3d::UnitY(),
                            .range = std::min(kMostPull, 0.85 * reach),
                            .damping = 4,
                            .friction = 1.5};
  drawer.parts.push_back(
      Box({0, kDoorThickness / 2, 0}, {half_width, kDoorThickness / 2, half_height}, material));
  drawer.parts.back().name = name + "_front";
  constexpr double kWall = 0.006;
  const double x = half_width - kPanel - 0.008;
  const double floor = -half_height + kPanel + 0.006;  // above a panel or the drawer below
  const double wall_height = std::max(0.04, 2 * half_height - kPanel - 0.06);
  const double y = -reach / 2;
  drawer.parts.push_back(Box({0, y, floor + kWall / 2}, {x, reach / 2, kWall / 2}, "cabinet"));
  for (const double side : {-1.0, 1.0})
    drawer.parts.push_back(Box({side * (x - kWall / 2), y, floor + wall_height / 2},
                               {kWall / 2, reach / 2, wall_height / 2}, "cabinet"));
  drawer.parts.push_back(Box({0, -reach + kWall / 2, floor + wall_height / 2},
                             {x - kWall, kWall / 2, wall_height / 2}, "cabinet"));
  AddHandle(drawer, name + "_handle", {0, kDoorThickness, 0}, Vector3d::UnitX(),
            std::min(0.08, half_width / 2));
  drawer.slots.push_back(
      {{0, y, floor + kWall}, x - 0.03, reach / 2 - 0.03, 2 * half_height - kPanel - 0.02, true});
  return drawer;
}

std::vector<std::string> FurnitureKinds() {
  std::vector<std::string> kinds;
  for (const auto& [name, maker] : kFurnitureMakers) kinds.emplace_back(name);
  return kinds;
}

HouseThing MakeFurniture(std::string_view kind, Rng& rng) {
  for (const auto& [name, maker] : kFurnitureMakers) {
    if (kind == name) return maker(rng);
  }
  throw ArgumentError(fmt::format("no furniture '{}'", kind));
}

}  // namespace robocell::internal
