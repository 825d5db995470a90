#include "robocell/scenes/houses/house_objects.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/scenes/houses/house_metadata.h"

namespace robocell::internal {
namespace {

using Eigen::Vector3d;

constexpr std::array kColours = {"red", "blue", "green", "yellow", "white", "orange", "teal"};

std::string Colour(Rng& rng) { return kColours[rng.UniformInt(kColours.size())]; }

// Adds parts to an object; all have the same density.
class ObjectMaker {
 public:
  ObjectMaker(std::string category, double density) : density_(density) {
    thing_.category = std::move(category);
    thing_.body.is_free = true;
  }
  ObjectMaker& Add(HousePart part) {
    part.part_class = PartClass::kObject;
    part.density = density_;
    thing_.body.parts.push_back(std::move(part));
    return *this;
  }
  // Four walls and a floor, open at the top.
  ObjectMaker& Tub(const Vector3d& size, double wall, const std::string& material) {
    Add(Box({0, 0, wall / 2}, {size.x() / 2, size.y() / 2, wall / 2}, material));
    const double half = (size.z() - wall) / 2, z = wall + half;
    for (const double side : {-1.0, 1.0}) {
      Add(Box({side * (size.x() - wall) / 2, 0, z}, {wall / 2, size.y() / 2, half}, material));
      Add(Box({0, side * (size.y() - wall) / 2, z}, {size.x() / 2 - wall, wall / 2, half},
              material));
    }
    return *this;
  }
  // A ring of eight walls on a round floor.
  ObjectMaker& Pot(double radius, double height, double wall, const std::string& material) {
    Add(Cylinder({0, 0, wall / 2}, radius, wall / 2, material));
    constexpr int kWalls = 8;
    const double apothem = radius * 0.92, half_side = apothem * 0.4142 + wall * 0.2;
    for (int i = 0; i < kWalls; ++i) {
      const double yaw = i * kPi / 4;
      const Vector3d out(std::cos(yaw), std::sin(yaw), 0);
      HousePart side = Box(out * (apothem - wall / 2) + Vector3d(0, 0, wall + (height - wall) / 2),
                           {wall / 2, half_side, (height - wall) / 2}, material);
      side.yaw = yaw;
      Add(side);
    }
    return *this;
  }
  HouseThing Done(const Vector3d& size, const std::string& colour) {
    thing_.size = size;
    const std::string noun = WordsOfCategory(thing_.category);
    thing_.words = {noun};
    if (!colour.empty()) thing_.words.insert(thing_.words.begin(), colour + " " + noun);
    return std::move(thing_);
  }

 private:
  double density_;
  HouseThing thing_;
};

HouseThing MakeMug(Rng& rng) {
  const std::string colour = Colour(rng);
  const double radius = rng.Uniform(0.035, 0.042), height = rng.Uniform(0.08, 0.1);
  return ObjectMaker("Mug", 900)
      .Pot(radius, height, 0.006, colour)
      .Add(Capsule({radius + 0.014, 0, height / 2}, 0.005, 0.022, colour, Vector3d::UnitZ()))
      .Done({2 * radius + 0.05, 2 * radius, height}, colour);
}
HouseThing MakeBowl(Rng& rng) {
  const std::string colour = Colour(rng);
  const double radius = rng.Uniform(0.065, 0.085), height = rng.Uniform(0.05, 0.065);
  return ObjectMaker("Bowl", 900)
      .Pot(radius, height, 0.006, colour)
      .Done({2 * radius, 2 * radius, height}, colour);
}
HouseThing MakePlate(Rng& rng) {
  const std::string colour = rng.Uniform(0, 1) < 0.6 ? "white" : Colour(rng);
  const double radius = rng.Uniform(0.09, 0.12);
  return ObjectMaker("Plate", 900)
      .Add(Cylinder({0, 0, 0.005}, radius * 0.6, 0.005, colour))
      .Add(Cylinder({0, 0, 0.0125}, radius, 0.004, colour))
      .Done({2 * radius, 2 * radius, 0.0165}, colour);
}
HouseThing MakeCan(Rng& rng) {
  const std::string colour = Colour(rng);
  const double height = rng.Uniform(0.09, 0.13);
  return ObjectMaker("Can", 900)
      .Add(Cylinder({0, 0, height / 2}, 0.033, height / 2, colour))
      .Done({0.066, 0.066, height}, colour);
}
HouseThing MakeBottle(Rng& rng) {
  const std::string colour = Colour(rng);
  const double height = rng.Uniform(0.15, 0.19), radius = rng.Uniform(0.03, 0.036);
  return ObjectMaker("Bottle", 600)
      .Add(Cylinder({0, 0, height / 2}, radius, height / 2, colour))
      .Add(Cylinder({0, 0, height + 0.025}, 0.013, 0.025, colour))
      .Add(Cylinder({0, 0, height + 0.06}, 0.015, 0.01, "white"))
      .Done({2 * radius, 2 * radius, height + 0.07}, colour);
}
HouseThing MakeFruit(const char* category, const char* colour, Rng& rng) {
  const double radius = rng.Uniform(0.032, 0.04);
  HousePart ball{.shape = PartShape::kSphere,
                 .pos = {0, 0, radius},
                 .half = {radius, 0, 0},
                 .material = colour};
  return ObjectMaker(category, 800).Add(ball).Done({2 * radius, 2 * radius, 2 * radius}, colour);
}
HouseThing MakeBox(const char* category, const Vector3d& low, const Vector3d& high, double density,
                   std::string material, Rng& rng) {
  const std::string colour = material.empty() ? Colour(rng) : "";
  if (material.empty()) material = colour;
  const Vector3d size(rng.Uniform(low.x(), high.x()), rng.Uniform(low.y(), high.y()),
                      rng.Uniform(low.z(), high.z()));
  return ObjectMaker(category, density)
      .Add(Box({0, 0, size.z() / 2}, size / 2, material))
      .Done(size, colour);
}
HouseThing MakeCookingPot(Rng& rng) {
  const double radius = rng.Uniform(0.085, 0.11), height = rng.Uniform(0.09, 0.13);
  ObjectMaker maker("Pot", 900);
  maker.Pot(radius, height, 0.006, "steel");
  for (const double side : {-1.0, 1.0})
    maker.Add(Capsule({side * (radius + 0.012), 0, height - 0.02}, 0.006, 0.03, "dark",
                      Vector3d::UnitY()));
  return maker.Done({2 * radius + 0.04, 2 * radius, height}, "");
}
HouseThing MakeBook(Rng& rng) {
  const std::string colour = Colour(rng);
  const Vector3d size(rng.Uniform(0.13, 0.17), rng.Uniform(0.19, 0.24), rng.Uniform(0.02, 0.045));
  return ObjectMaker("Book", 500)
      .Add(Box({0, 0, size.z() / 2}, size / 2, colour))
      .Add(Box({0.003, 0, size.z() / 2}, {size.x() / 2, size.y() / 2 - 0.004, size.z() / 2 - 0.003},
               "linen"))
      .Done(size, colour);
}
HouseThing MakeLaptop(Rng& /*rng*/) {
  return ObjectMaker("Laptop", 700)
      .Add(Box({0, 0, 0.008}, {0.16, 0.11, 0.008}, "steel"))
      .Add(Box({0, -0.106, 0.118}, {0.16, 0.004, 0.102}, "dark"))
      .Done({0.32, 0.22, 0.22}, "");
}
HouseThing MakeVase(Rng& rng) {
  const std::string colour = Colour(rng);
  const double height = rng.Uniform(0.14, 0.2);
  return ObjectMaker("Vase", 800)
      .Add(Cylinder({0, 0, height * 0.35}, 0.05, height * 0.35, colour))
      .Add(Cylinder({0, 0, height * 0.85}, 0.03, height * 0.15, colour))
      .Done({0.1, 0.1, height}, colour);
}
HouseThing MakePlant(Rng& rng) {
  const double height = rng.Uniform(0.1, 0.14), leaves = rng.Uniform(0.06, 0.08);
  HousePart ball{.shape = PartShape::kEllipsoid,
                 .pos = {0, 0, height + leaves * 0.8},
                 .half = {leaves, leaves, leaves},
                 .material = "leaf"};
  return ObjectMaker("Plant", 700)
      .Add(Cylinder({0, 0, height / 2}, 0.06, height / 2, "terracotta"))
      .Add(ball)
      .Done({2 * leaves, 2 * leaves, height + 1.8 * leaves}, "");
}
HouseThing MakeLamp(Rng& rng) {
  const std::string colour = Colour(rng);
  const double height = rng.Uniform(0.22, 0.3);
  return ObjectMaker("Lamp", 600)
      .Add(Cylinder({0, 0, 0.012}, 0.07, 0.012, "dark"))
      .Add(Cylinder({0, 0, height / 2}, 0.01, height / 2, "steel"))
      .Add(Cylinder({0, 0, height + 0.06}, 0.075, 0.06, colour))
      .Done({0.15, 0.15, height + 0.12}, colour);
}
HouseThing MakeHammer(Rng& /*rng*/) {
  return ObjectMaker("Hammer", 1500)
      .Add(Box({0, 0, 0.014}, {0.018, 0.045, 0.014}, "iron"))
      .Add(Capsule({0.13, 0, 0.013}, 0.013, 0.12, "oak", Vector3d::UnitX()))
      .Done({0.3, 0.09, 0.028}, "");
}
HouseThing MakeScrewdriver(Rng& rng) {
  const std::string colour = Colour(rng);
  return ObjectMaker("Screwdriver", 1200)
      .Add(Box({0, 0, 0.015}, {0.05, 0.014, 0.015}, colour))
      .Add(Capsule({0.1, 0, 0.015}, 0.004, 0.05, "steel", Vector3d::UnitX()))
      .Done({0.22, 0.03, 0.03}, colour);
}
HouseThing MakeToolbox(Rng& rng) {
  const std::string colour = Colour(rng);
  const Vector3d size(rng.Uniform(0.26, 0.34), 0.16, 0.14);
  return ObjectMaker("Toolbox", 250)
      .Add(Box({0, 0, size.z() / 2}, size / 2, colour))
      .Add(Capsule({0, 0, size.z() + 0.03}, 0.008, 0.06, "dark", Vector3d::UnitX()))
      .Add(Box({-0.06, 0, size.z() + 0.015}, {0.006, 0.01, 0.015}, "dark"))
      .Add(Box({0.06, 0, size.z() + 0.015}, {0.006, 0.01, 0.015}, "dark"))
      .Done({size.x(), size.y(), size.z() + 0.04}, colour);
}
HouseThing MakePaintCan(Rng& rng) {
  const std::string colour = Colour(rng);
  return ObjectMaker("PaintCan", 900)
      .Add(Cylinder({0, 0, 0.075}, 0.065, 0.075, "steel"))
      .Add(Cylinder({0, 0, 0.075}, 0.066, 0.045, colour))
      .Done({0.132, 0.132, 0.15}, colour);
}
HouseThing MakeCrate(Rng& rng) {
  const std::string colour = Colour(rng);
  const Vector3d size(rng.Uniform(0.34, 0.4), rng.Uniform(0.26, 0.3), rng.Uniform(0.14, 0.2));
  return ObjectMaker("Crate", 300).Tub(size, 0.012, colour).Done(size, colour);
}
HouseThing MakePenCup(Rng& rng) {
  const std::string colour = Colour(rng);
  return ObjectMaker("PenCup", 800)
      .Pot(0.04, 0.1, 0.006, colour)
      .Add(Cylinder({0.008, 0.006, 0.09}, 0.004, 0.08, "blue"))
      .Add(Cylinder({-0.01, -0.004, 0.085}, 0.004, 0.075, "red"))
      .Done({0.08, 0.08, 0.17}, colour);
}

using ObjectFunction = HouseThing (*)(Rng&);
constexpr std::pair<const char*, ObjectFunction> kObjectMakers[] = {
    {"Mug", MakeMug},
    {"Bowl", MakeBowl},
    {"Plate", MakePlate},
    {"Can", MakeCan},
    {"Bottle", MakeBottle},
    {"Apple", [](Rng& rng) { return MakeFruit("Apple", "red", rng); }},
    {"Orange", [](Rng& rng) { return MakeFruit("Orange", "orange", rng); }},
    {"CerealBox",
     [](Rng& rng) {
       return MakeBox("CerealBox", {0.06, 0.15, 0.2}, {0.075, 0.19, 0.27}, 200, "", rng);
     }},
    {"Pot", MakeCookingPot},
    {"Book", MakeBook},
    {"RemoteControl",
     [](Rng& rng) {
       return MakeBox("RemoteControl", {0.04, 0.14, 0.018}, {0.05, 0.19, 0.025}, 900, "dark", rng);
     }},
    {"Phone",
     [](Rng& rng) {
       return MakeBox("Phone", {0.068, 0.14, 0.012}, {0.078, 0.16, 0.014}, 1500, "dark", rng);
     }},
    {"Laptop", MakeLaptop},
    {"Vase", MakeVase},
    {"Plant", MakePlant},
    {"Lamp", MakeLamp},
    {"ToyBlock",
     [](Rng& rng) {
       return MakeBox("ToyBlock", {0.04, 0.04, 0.04}, {0.06, 0.06, 0.06}, 500, "", rng);
     }},
    {"TissueBox",
     [](Rng& rng) {
       return MakeBox("TissueBox", {0.11, 0.2, 0.07}, {0.12, 0.23, 0.09}, 150, "", rng);
     }},
    {"PenCup", MakePenCup},
    {"Hammer", MakeHammer},
    {"Screwdriver", MakeScrewdriver},
    {"Toolbox", MakeToolbox},
    {"PaintCan", MakePaintCan},
    {"Carton",
     [](Rng& rng) {
       return MakeBox("Carton", {0.24, 0.3, 0.18}, {0.34, 0.42, 0.3}, 120, "cardboard", rng);
     }},
    {"SmallCarton",
     [](Rng& rng) {
       return MakeBox("SmallCarton", {0.06, 0.08, 0.05}, {0.08, 0.14, 0.1}, 250, "cardboard", rng);
     }},
    {"Crate", MakeCrate},
};

}  // namespace

std::vector<std::string> HouseObjectKinds() {
  std::vector<std::string> kinds;
  for (const auto& [name, maker] : kObjectMakers) kinds.emplace_back(name);
  return kinds;
}

std::vector<std::string> HouseObjectsOf(RoomKind room) {
  switch (room) {
    case RoomKind::kKitchen:
      return {"Mug", "Bowl", "Can", "Plate", "Bottle", "Apple", "CerealBox", "Pot", "Orange"};
    case RoomKind::kLiving:
      return {"Book", "RemoteControl", "Vase", "Mug", "Plant", "ToyBlock", "Bowl", "TissueBox"};
    case RoomKind::kBedroom:
      return {"Book", "Phone", "Lamp", "TissueBox", "ToyBlock", "Bottle", "Mug"};
    case RoomKind::kOffice:
      return {"Laptop", "PenCup", "Book", "Mug", "Phone", "TissueBox", "Plant"};
    case RoomKind::kWorkshop:
      return {"Hammer", "Screwdriver", "Toolbox", "PaintCan", "SmallCarton", "Can"};
    case RoomKind::kWarehouse:
      return {"Carton", "Crate", "SmallCarton", "PaintCan", "Toolbox"};
  }
  return HouseObjectKinds();
}

HouseThing MakeHouseObject(std::string_view kind, Rng& rng) {
  for (const auto& [name, maker] : kObjectMakers) {
    if (kind == name) return maker(rng);
  }
  throw ArgumentError(fmt::format("no object '{}'", kind));
}

}  // namespace robocell::internal
