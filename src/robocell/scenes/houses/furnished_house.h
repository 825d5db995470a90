// FurnishedHouse: a floor plan with furniture along the walls and in the middle of its rooms, and
// objects in the slots of the furniture. Plain data: house_model.h makes a model of it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/math/pose.h"
#include "robocell/scenes/houses/floor_plan.h"
#include "robocell/scenes/houses/house_parts.h"

namespace robocell::internal {

struct HousePiece {
  HouseThing thing;      // its body has its name and its pose in the world
  size_t room = 0;       // index into the plan's rooms
  bool is_high = false;  // hangs above other furniture
  Eigen::AlignedBox2d footprint = {};
};

// A slot with the objects in it.
struct FilledSlot {
  size_t piece = 0;
  std::string body;     // full name of the body that has the slot
  Pose frame_to_world;  // the middle of its floor, with the joints closed
  HouseSlot slot;
  std::vector<size_t> objects = {};
};

struct FurnishedHouse {
  FloorPlan plan;
  std::vector<HousePiece> pieces;
  std::vector<HousePiece> objects;
  std::vector<FilledSlot> slots;  // only those with objects
};

struct FurnishingOptions {
  int most_objects = 40;
};

FurnishedHouse Furnish(FloorPlan plan, const FurnishingOptions& options, Rng& rng);

// Removes objects, by their numbers; slots that they leave empty go too.
void RemoveObjects(FurnishedHouse& house, std::vector<size_t> objects);

// Returns the place that doors of rooms and people need in front of the openings of a room.
std::vector<Eigen::AlignedBox2d> DoorAreas(const FloorPlan& plan, size_t room);

}  // namespace robocell::internal
