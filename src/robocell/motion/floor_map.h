// FloorMap: the free floor for a base that moves in a plane, and the shortest ways over it: a
// configuration-space map of cells and headings, searched by A* (Hart, Nilsson and Raphael 1968).
//
//   FloorMap map({.bounds = bounds, .radius = 0.4}, is_free);
//   for (const auto& outline : outlines) map.Block(outline);
//   if (const auto way = map.FindWay(start, goals)) Drive(*way);
//
// The base drives straight on, backwards or, if it can, sideways, and turns on the spot: a way is a
// row of places in which position and heading never change at once. Ways keep away from obstacles
// where that costs little. Obstacles come as data; what is near one is asked of `is_free`. Metres and
// radians, in the plane's frame.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>
#include <Eigen/Geometry>

namespace robocell::internal {

struct FloorPlace {
  double x = 0, y = 0, yaw = 0;
};

struct FloorMapOptions {
  Eigen::AlignedBox2d bounds;  // of the floor
  double radius = 0.4;         // of a circle around the origin that contains the robot everywhere
  double cell = 0.08;
  bool drives_sideways = true;
};

class FloorMap {
 public:
  using IsFree = std::function<bool(const FloorPlace&)>;
  // `is_free`: whether the robot touches nothing there; asked near obstacles only.
  FloorMap(const FloorMapOptions& options, IsFree is_free);

  // Marks what is under a convex outline, counter-clockwise.
  void Block(const std::vector<Eigen::Vector2d>& outline);

  // Returns the shortest way, from the start to one of the goals, both included; unset if there is
  // none. Start and goals are free, or no way leads there.
  std::optional<std::vector<FloorPlace>> FindWay(const FloorPlace& start,
                                                 std::span<const FloorPlace> goals);
  // Returns the distance to the nearest obstacle at least, metres.
  double RoomAt(double x, double y);

 private:
  struct Cell {
    int i = 0, j = 0;
  };
  size_t Index(Cell cell) const {
    return static_cast<size_t>(cell.j) * static_cast<size_t>(nx_) + static_cast<size_t>(cell.i);
  }
  bool Has(Cell cell) const { return cell.i >= 0 && cell.j >= 0 && cell.i < nx_ && cell.j < ny_; }
  Cell CellAt(double x, double y) const;
  Eigen::Vector2d MiddleOf(Cell cell) const;
  void Measure();
  bool Free(const FloorPlace& place);
  bool FreeAt(Cell cell, int heading);
  bool CanTurn(const FloorPlace& at, double to);
  bool CanDrive(const FloorPlace& from, const FloorPlace& to);
  std::vector<FloorPlace> Shortened(const std::vector<FloorPlace>& way);

  FloorMapOptions options_;
  IsFree is_free_;
  int nx_, ny_;
  std::vector<char> taken_;
  std::vector<double> room_;   // distance of each cell's middle to the nearest taken one
  std::vector<int8_t> known_;  // of each cell and heading: -1 not asked, else whether it is free
  bool is_measured_ = false;
};

// Returns the length of a way in metres, without its turns.
double LengthOf(std::span<const FloorPlace> way);

}  // namespace robocell::internal
