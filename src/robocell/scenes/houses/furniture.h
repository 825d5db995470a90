// The furniture of generated houses. A piece stands on its origin, the middle of its footprint; its
// back is at -y and its front at +y.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/scenes/houses/house_parts.h"

namespace robocell::internal {

// Returns the kinds of furniture: "Counter", "DiningTable", ...
std::vector<std::string> FurnitureKinds();
// Returns a piece with sizes and colours drawn from `rng`. Requires one of FurnitureKinds. The names
// of its bodies, joints and parts are those in the piece; the house adds its own.
HouseThing MakeFurniture(std::string_view kind, Rng& rng);

// Parts of furniture with doors and drawers, for its makers.
struct Front {
  double left, right, low, high;  // of the opening, along x and z
  double y;                       // of the front plane
};
// Adds a box without a front, of panels. Its inner space is kPanel smaller on all sides.
void AddCarcass(HouseBody& body, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                const std::string& material);
HouseBody MakeDoor(const std::string& name, const Front& front, bool hinge_left,
                   const std::string& material);
// `depth`: of the space behind the front.
HouseBody MakeDrawer(const std::string& name, const Front& front, double depth,
                     const std::string& material);
inline constexpr double kPanel = 0.018;  // metres

// The makers of the kitchen's furniture (kitchen_furniture.cc).
HouseThing MakeCounter(Rng& rng, bool drawers);
HouseThing MakeSink(Rng& rng);
HouseThing MakeStove(Rng& rng);
HouseThing MakeFridge(Rng& rng);
HouseThing MakeWallCupboard(Rng& rng);

}  // namespace robocell::internal
