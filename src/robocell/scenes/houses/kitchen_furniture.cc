#include <array>

#include "robocell/scenes/houses/furniture.h"

namespace robocell::internal {
namespace {

constexpr double kDepth = 0.6, kUnit = 0.6, kTop = 0.9, kTopThickness = 0.035, kPlinth = 0.1;
constexpr double kDoorPlane = kDepth / 2 - 0.022;  // of the doors' backs

using Eigen::Vector3d;

HouseSlot WorkTop() { return {{0, 0.02, kTop}, kUnit / 2 - 0.04, kDepth / 2 - 0.06, 0.4, false}; }

void AddPlinth(HouseBody& body) {
  body.parts.push_back(
      Box({0, -0.03, kPlinth / 2}, {kUnit / 2, kDepth / 2 - 0.05, kPlinth / 2}, "dark"));
}

}  // namespace

HouseThing MakeCounter(Rng& rng, bool drawers) {
  HouseThing thing{.category = drawers ? "DrawerUnit" : "Counter", .size = {kUnit, kDepth, kTop}};
  HouseBody& body = thing.body;
  AddPlinth(body);
  const double low = kPlinth, high = kTop - kTopThickness;
  AddCarcass(body, {-kUnit / 2, -kDepth / 2, low}, {kUnit / 2, kDoorPlane, high}, "cabinet");
  body.parts.push_back(
      Box({0, 0, kTop - kTopThickness / 2}, {kUnit / 2, kDepth / 2, kTopThickness / 2}, "worktop"));
  body.slots.push_back(WorkTop());
  Front front{-kUnit / 2, kUnit / 2, low, high, kDoorPlane};
  if (drawers) {
    const double third = (high - low) / 3;
    for (int i = 0; i < 3; ++i) {
      front.low = low + i * third;
      front.high = low + (i + 1) * third;
      body.children.push_back(
          MakeDrawer("drawer_" + std::to_string(i), front, 0.5, "cabinet_front"));
    }
    return thing;
  }
  const double shelf = (low + high) / 2;
  body.parts.push_back(Box({0, -0.06, shelf}, {kUnit / 2 - kPanel, 0.2, kPanel / 2}, "cabinet"));
  body.slots.push_back(
      {{0, -0.06, low + kPanel}, kUnit / 2 - 0.05, 0.18, shelf - low - 2 * kPanel, true});
  body.slots.push_back(
      {{0, -0.06, shelf + kPanel / 2}, kUnit / 2 - 0.05, 0.18, high - shelf - 2 * kPanel, true});
  body.children.push_back(MakeDoor("door", front, rng.Uniform(0, 1) < 0.5, "cabinet_front"));
  return thing;
}

HouseThing MakeSink(Rng& rng) {
  HouseThing thing{.category = "Sink", .size = {kUnit, kDepth, kTop}};
  HouseBody& body = thing.body;
  AddPlinth(body);
  const double high = kTop - kTopThickness, x = 0.21, y = 0.17, deep = 0.16;
  body.parts.push_back(Box({-kUnit / 2 + kPanel / 2, -0.011, (kPlinth + high) / 2},
                           {kPanel / 2, kDepth / 2 - 0.011, (high - kPlinth) / 2}, "cabinet"));
  body.parts.push_back(Box({kUnit / 2 - kPanel / 2, -0.011, (kPlinth + high) / 2},
                           {kPanel / 2, kDepth / 2 - 0.011, (high - kPlinth) / 2}, "cabinet"));
  body.parts.push_back(Box({0, -0.011, kPlinth + kPanel / 2},
                           {kUnit / 2 - kPanel, kDepth / 2 - 0.011, kPanel / 2}, "cabinet"));
  // The worktop around the basin, and the basin.
  const double z = kTop - kTopThickness / 2, half = kTopThickness / 2;
  for (const double side : {-1.0, 1.0}) {
    body.parts.push_back(Box({side * (kUnit / 2 + x) / 2, 0, z},
                             {(kUnit / 2 - x) / 2, kDepth / 2, half}, "worktop"));
    body.parts.push_back(
        Box({0, side * (kDepth / 2 + y) / 2, z}, {x, (kDepth / 2 - y) / 2, half}, "worktop"));
    body.parts.push_back(
        Box({side * (x - 0.003), 0, kTop - deep / 2}, {0.003, y, deep / 2}, "steel"));
    body.parts.push_back(
        Box({0, side * (y - 0.003), kTop - deep / 2}, {x - 0.006, 0.003, deep / 2}, "steel"));
  }
  body.parts.push_back(Box({0, 0, kTop - deep - 0.003}, {x, y, 0.003}, "steel"));
  body.slots.push_back({{0, 0, kTop - deep}, x - 0.03, y - 0.03, 0.4, true});
  // The tap.
  const double back = -y - 0.06;
  body.parts.push_back(Cylinder({0, back, kTop + 0.01}, 0.025, 0.01, "steel"));
  body.parts.push_back(Cylinder({0, back, kTop + 0.13}, 0.012, 0.13, "steel"));
  body.parts.push_back(
      Capsule({0, back + 0.08, kTop + 0.26}, 0.011, 0.08, "steel", Vector3d::UnitY()));
  body.parts.push_back(Cylinder({0, back + 0.16, kTop + 0.24}, 0.011, 0.02, "steel"));
  body.children.push_back(MakeDoor("door", {-kUnit / 2, kUnit / 2, kPlinth, high, kDoorPlane},
                                   rng.Uniform(0, 1) < 0.5, "cabinet_front"));
  return thing;
}

HouseThing MakeStove(Rng& /*rng*/) {
  HouseThing thing{.category = "Stove", .size = {kUnit, kDepth, kTop}};
  HouseBody& body = thing.body;
  AddPlinth(body);
  const double low = kPlinth, high = kTop - 0.14;
  AddCarcass(body, {-kUnit / 2, -kDepth / 2, low}, {kUnit / 2, kDoorPlane, high}, "enamel");
  body.parts.push_back(Box({0, -0.011, (high + kTop - 0.01) / 2},
                           {kUnit / 2, kDepth / 2 - 0.011, (kTop - 0.01 - high) / 2}, "enamel"));
  body.parts.push_back(Box({0, 0, kTop - 0.005}, {kUnit / 2, kDepth / 2, 0.005}, "glass_dark"));
  for (int i = 0; i < 4; ++i) {
    const double x = i % 2 ? 0.15 : -0.15, y = i / 2 ? 0.13 : -0.13;
    HousePart burner =
        Cylinder({x, y, kTop + 0.0005}, i == 1 || i == 2 ? 0.1 : 0.08, 0.0005, "burner");
    burner.part_class = PartClass::kVisual;
    body.parts.push_back(burner);
    body.parts.push_back(Cylinder({-0.21 + 0.14 * i, kDepth / 2, kTop - 0.07}, 0.02, 0.018, "steel",
                                  Vector3d::UnitY()));
    body.parts.back().name = "knob_" + std::to_string(i);
  }
  body.slots.push_back(WorkTop());
  body.slots.push_back({{0, -0.03, low + kPanel},
                        kUnit / 2 - 0.05,
                        kDepth / 2 - 0.07,
                        high - low - 2 * kPanel,
                        true});
  // The oven's door is hinged at its lower edge.
  HouseBody door{.name = "oven_door", .pos = {0, kDoorPlane + 0.003, low + 0.004}};
  door.joint = HouseJoint{.name = "oven_door_hinge",
                          .axis = -Vector3d::UnitX(),
                          .range = 1.5,
                          .damping = 0.4,
                          .friction = 1.2};
  const double height = high - low - 0.008;
  door.parts.push_back(Box({0, 0.01, height / 2}, {kUnit / 2 - 0.004, 0.01, height / 2}, "enamel"));
  HousePart window =
      Box({0, 0.0205, height / 2 - 0.02}, {0.2, 0.0006, height / 2 - 0.12}, "glass_dark");
  window.part_class = PartClass::kVisual;
  door.parts.push_back(window);
  HousePart handle = Capsule({0, 0.055, height - 0.06}, 0.009, 0.22, "steel", Vector3d::UnitX());
  handle.name = "oven_door_handle";
  door.parts.push_back(handle);
  for (const double x : {-0.2, 0.2}) {
    HousePart holder = Capsule({x, 0.035, height - 0.06}, 0.007, 0.02, "steel", Vector3d::UnitY());
    holder.name = x < 0 ? "oven_door_handle_left" : "oven_door_handle_right";
    door.parts.push_back(holder);
  }
  body.children.push_back(std::move(door));
  return thing;
}

HouseThing MakeFridge(Rng& rng) {
  const double width = 0.62, height = rng.Uniform(1.65, 1.9), depth = 0.64;
  HouseThing thing{.category = "Fridge", .size = {width, depth, height}};
  HouseBody& body = thing.body;
  const double front = depth / 2 - 0.022, split = 0.62 * height;
  AddCarcass(body, {-width / 2, -depth / 2, 0.03}, {width / 2, front, split}, "enamel");
  AddCarcass(body, {-width / 2, -depth / 2, split}, {width / 2, front, height}, "enamel");
  body.parts.push_back(Box({0, -0.02, 0.015}, {width / 2 - 0.02, depth / 2 - 0.04, 0.015}, "dark"));
  const double shelf = 0.35 * height;
  body.parts.push_back(
      Box({0, -0.04, shelf}, {width / 2 - kPanel, depth / 2 - 0.07, 0.005}, "glass"));
  const double x = width / 2 - 0.07, y = depth / 2 - 0.12;
  body.slots.push_back({{0, -0.04, 0.03 + kPanel}, x, y, shelf - 0.07, true});
  body.slots.push_back({{0, -0.04, shelf + 0.005}, x, y, split - shelf - 0.04, true});
  body.slots.push_back({{0, -0.04, split + kPanel}, x, y, height - split - 2 * kPanel, true});
  const bool left = rng.Uniform(0, 1) < 0.5;
  body.children.push_back(
      MakeDoor("door", {-width / 2, width / 2, 0.03, split, front}, left, "enamel"));
  body.children.push_back(
      MakeDoor("freezer_door", {-width / 2, width / 2, split, height, front}, left, "enamel"));
  return thing;
}

HouseThing MakeWallCupboard(Rng& rng) {
  const double width = 0.6, depth = 0.34, low = 1.42, high = 2.1;
  HouseThing thing{.category = "WallCupboard", .size = {width, depth, high}};
  HouseBody& body = thing.body;
  const double front = depth / 2 - 0.022;
  AddCarcass(body, {-width / 2, -depth / 2, low}, {width / 2, front, high}, "cabinet");
  body.slots.push_back({{0, -0.02, low + kPanel}, width / 2 - 0.05, depth / 2 - 0.06, 0.3, true});
  body.parts.push_back(
      Box({0, -0.01, low + 0.34}, {width / 2 - kPanel, depth / 2 - 0.03, kPanel / 2}, "cabinet"));
  body.children.push_back(MakeDoor("door", {-width / 2, width / 2, low, high, front},
                                   rng.Uniform(0, 1) < 0.5, "cabinet_front"));
  return thing;
}

}  // namespace robocell::internal
