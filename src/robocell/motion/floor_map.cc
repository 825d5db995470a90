#include "robocell/motion/floor_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "robocell/base/units.h"

namespace robocell::internal {
namespace {

constexpr int kHeadings = 32;  // the base drives along every fourth one
constexpr int kDriveEvery = kHeadings / 8;
constexpr double kTurnCost = 0.03;  // metres for a turn from one heading to the next
constexpr double kBackCost = 1.5;   // times the way forwards
constexpr double kSideCost = 2;
constexpr double kTightCost = 1;  // more for a metre along an obstacle
constexpr double kAmple = 0.35;   // metres beside the robot's circle, from where more is no better
constexpr double kSlice = 0.04;   // metres between places of a straight drive that are checked
constexpr double kTurnSlice = 0.12;  // rad
constexpr double kSameOnFloor = 1e-6;
constexpr size_t kMostFloorCells = 4000000;

double AngleOf(int heading) { return 2 * kPi * heading / kHeadings; }
double Wrapped(double angle) { return std::remainder(angle, 2 * kPi); }
int NearestHeading(double yaw) {
  const int heading = static_cast<int>(std::lround(yaw / (2 * kPi) * kHeadings)) % kHeadings;
  return heading < 0 ? heading + kHeadings : heading;
}

// Returns the squared distances of all cells in a line to the nearest source: the lower envelope of
// parabolas (Felzenszwalb and Huttenlocher 2012).
void NearestInLine(std::vector<double>& line, std::vector<int>& at, std::vector<double>& from,
                   std::vector<double>& out) {
  const int n = static_cast<int>(line.size());
  const double endless = std::numeric_limits<double>::infinity();
  int k = -1;
  for (int q = 0; q < n; ++q) {
    const double f = line[static_cast<size_t>(q)];
    if (std::isinf(f)) continue;
    double s = -endless;
    while (k >= 0) {
      const int v = at[static_cast<size_t>(k)];
      s = ((f + q * q) - (line[static_cast<size_t>(v)] + v * v)) / (2.0 * (q - v));
      if (s > from[static_cast<size_t>(k)]) break;
      --k;
      s = -endless;
    }
    ++k;
    at[static_cast<size_t>(k)] = q;
    from[static_cast<size_t>(k)] = s;
  }
  if (k < 0) return;
  int part = 0;
  for (int q = 0; q < n; ++q) {
    while (part < k && from[static_cast<size_t>(part) + 1] < q) ++part;
    const int v = at[static_cast<size_t>(part)];
    out[static_cast<size_t>(q)] = (q - v) * (q - v) + line[static_cast<size_t>(v)];
  }
  line.swap(out);
}

}  // namespace

double LengthOf(std::span<const FloorPlace> way) {
  double length = 0;
  for (size_t i = 1; i < way.size(); ++i)
    length += std::hypot(way[i].x - way[i - 1].x, way[i].y - way[i - 1].y);
  return length;
}

FloorMap::FloorMap(const FloorMapOptions& options, IsFree is_free)
    : options_(options), is_free_(std::move(is_free)) {
  const Eigen::Vector2d size = options_.bounds.sizes();
  const double area = std::max(size.x(), 0.0) * std::max(size.y(), 0.0);
  options_.cell = std::max(options_.cell, std::sqrt(area / kMostFloorCells));
  nx_ = std::max(1, static_cast<int>(std::ceil(size.x() / options_.cell)));
  ny_ = std::max(1, static_cast<int>(std::ceil(size.y() / options_.cell)));
  const size_t cells = static_cast<size_t>(nx_) * static_cast<size_t>(ny_);
  taken_.assign(cells, 0);
  known_.assign(cells * kHeadings, -1);
}

FloorMap::Cell FloorMap::CellAt(double x, double y) const {
  return {static_cast<int>(std::floor((x - options_.bounds.min().x()) / options_.cell)),
          static_cast<int>(std::floor((y - options_.bounds.min().y()) / options_.cell))};
}

Eigen::Vector2d FloorMap::MiddleOf(Cell cell) const {
  return options_.bounds.min() + options_.cell * Eigen::Vector2d(cell.i + 0.5, cell.j + 0.5);
}

void FloorMap::Block(const std::vector<Eigen::Vector2d>& outline) {
  if (outline.empty()) return;
  Eigen::AlignedBox2d around;
  for (const Eigen::Vector2d& point : outline) around.extend(point);
  const double reach = options_.cell * std::sqrt(0.5);  // of a cell around its middle
  const Cell low = CellAt(around.min().x() - reach, around.min().y() - reach),
             high = CellAt(around.max().x() + reach, around.max().y() + reach);
  for (int j = std::max(0, low.j); j <= std::min(ny_ - 1, high.j); ++j) {
    for (int i = std::max(0, low.i); i <= std::min(nx_ - 1, high.i); ++i) {
      const Eigen::Vector2d at = MiddleOf({i, j});
      bool is_near = true;
      for (size_t e = 0; e < outline.size() && is_near; ++e) {
        const Eigen::Vector2d edge = outline[(e + 1) % outline.size()] - outline[e];
        const double length = edge.norm();
        if (length < 1e-9) continue;
        const Eigen::Vector2d from = at - outline[e];
        is_near = (edge.y() * from.x() - edge.x() * from.y()) / length <= reach;
      }
      if (is_near) taken_[Index({i, j})] = 1;
    }
  }
  is_measured_ = false;
}

void FloorMap::Measure() {
  if (is_measured_) return;
  is_measured_ = true;
  const double endless = std::numeric_limits<double>::infinity();
  room_.assign(taken_.size(), endless);
  for (size_t c = 0; c < taken_.size(); ++c)
    if (taken_[c]) room_[c] = 0;
  const auto longest = static_cast<size_t>(std::max(nx_, ny_));
  std::vector<int> at(longest + 1);
  std::vector<double> from(longest + 1), line, out;
  for (int j = 0; j < ny_; ++j) {
    const auto first = room_.begin() + static_cast<std::ptrdiff_t>(Index({0, j}));
    line.assign(first, first + nx_);
    out.assign(line.size(), endless);
    NearestInLine(line, at, from, out);
    std::ranges::copy(line, first);
  }
  for (int i = 0; i < nx_; ++i) {
    line.clear();
    for (int j = 0; j < ny_; ++j) line.push_back(room_[Index({i, j})]);
    out.assign(line.size(), endless);
    NearestInLine(line, at, from, out);
    for (int j = 0; j < ny_; ++j) room_[Index({i, j})] = line[static_cast<size_t>(j)];
  }
  for (double& room : room_) room = options_.cell * std::sqrt(room);
  std::ranges::fill(known_, int8_t{-1});
}

double FloorMap::RoomAt(double x, double y) {
  Measure();
  const Cell cell = CellAt(x, y);
  if (!Has(cell)) return 0;
  // From anywhere in this cell to anywhere in the nearest taken one.
  return std::max(0.0, room_[Index(cell)] - options_.cell * std::sqrt(2.0));
}

bool FloorMap::Free(const FloorPlace& place) {
  if (!Has(CellAt(place.x, place.y))) return false;
  return RoomAt(place.x, place.y) > options_.radius || is_free_(place);
}

bool FloorMap::FreeAt(Cell cell, int heading) {
  if (!Has(cell)) return false;
  int8_t& known = known_[Index(cell) * kHeadings + static_cast<size_t>(heading)];
  if (known < 0) {
    const Eigen::Vector2d at = MiddleOf(cell);
    known = Free({at.x(), at.y(), AngleOf(heading)}) ? 1 : 0;
  }
  return known == 1;
}

bool FloorMap::CanTurn(const FloorPlace& at, double to) {
  const double angle = Wrapped(to - at.yaw);
  const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(angle) / kTurnSlice)));
  for (int s = 0; s <= steps; ++s)
    if (!Free({at.x, at.y, at.yaw + angle * s / steps})) return false;
  return true;
}

bool FloorMap::CanDrive(const FloorPlace& from, const FloorPlace& to) {
  const double length = std::hypot(to.x - from.x, to.y - from.y);
  const int steps = std::max(1, static_cast<int>(std::ceil(length / kSlice)));
  for (int s = 0; s <= steps; ++s) {
    const double t = static_cast<double>(s) / steps;
    if (!Free({std::lerp(from.x, to.x, t), std::lerp(from.y, to.y, t), from.yaw})) return false;
  }
  return true;
}

std::optional<std::vector<FloorPlace>> FloorMap::FindWay(const FloorPlace& start,
                                                         std::span<const FloorPlace> goals) {
  Measure();
  struct Goal {
    Cell cell;
    int heading;
    size_t number;
  };
  // A place is joined to the middle of its cell, at the nearest heading, by a short drive and turn.
  const auto joins = [&](const FloorPlace& place) {
    const Cell cell = CellAt(place.x, place.y);
    if (!Has(cell) || !Free(place)) return false;
    const int heading = NearestHeading(place.yaw);
    const Eigen::Vector2d middle = MiddleOf(cell);
    return FreeAt(cell, heading) && CanTurn(place, AngleOf(heading)) &&
           CanDrive({place.x, place.y, AngleOf(heading)},
                    {middle.x(), middle.y(), AngleOf(heading)});
  };
  if (!joins(start)) return std::nullopt;
  std::vector<Goal> ends;
  for (size_t g = 0; g < goals.size(); ++g)
    if (joins(goals[g]))
      ends.push_back({CellAt(goals[g].x, goals[g].y), NearestHeading(goals[g].yaw), g});
  if (ends.empty()) return std::nullopt;

  const auto key = [&](Cell cell, int heading) {
    return Index(cell) * kHeadings + static_cast<size_t>(heading);
  };
  const auto bound = [&](Cell cell) {
    double least = std::numeric_limits<double>::infinity();
    for (const Goal& goal : ends)
      least = std::min(least, std::hypot(goal.cell.i - cell.i, goal.cell.j - cell.j));
    return least * options_.cell;
  };
  constexpr uint32_t kNone = ~uint32_t{0};
  std::vector<double> cost(known_.size(), std::numeric_limits<double>::infinity());
  std::vector<uint32_t> before(known_.size(), kNone);
  using Entry = std::pair<double, size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const Cell from = CellAt(start.x, start.y);
  const size_t first = key(from, NearestHeading(start.yaw));
  cost[first] = 0;
  open.emplace(bound(from), first);
  std::vector<char> closed(known_.size(), 0);
  while (!open.empty()) {
    const size_t here = open.top().second;
    open.pop();
    if (closed[here]) continue;
    closed[here] = 1;
    const int heading = static_cast<int>(here % kHeadings);
    const size_t index = here / kHeadings;
    const Cell cell{static_cast<int>(index % static_cast<size_t>(nx_)),
                    static_cast<int>(index / static_cast<size_t>(nx_))};
    for (const Goal& goal : ends) {
      if (goal.cell.i != cell.i || goal.cell.j != cell.j || goal.heading != heading) continue;
      std::vector<FloorPlace> way = {goals[goal.number]};
      for (size_t at = here;; at = before[at]) {
        const size_t c = at / kHeadings;
        const Eigen::Vector2d middle = MiddleOf({static_cast<int>(c % static_cast<size_t>(nx_)),
                                                 static_cast<int>(c / static_cast<size_t>(nx_))});
        const double yaw = AngleOf(static_cast<int>(at % kHeadings));
        if (at == here) way.push_back({goals[goal.number].x, goals[goal.number].y, yaw});
        way.push_back({middle.x(), middle.y(), yaw});
        if (at == first) {
          way.push_back({start.x, start.y, yaw});
          break;
        }
      }
      way.push_back(start);
      std::ranges::reverse(way);
      return Shortened(way);
    }
    const auto reach = [&](Cell to, int turned, double more) {
      if (!FreeAt(to, turned)) return;
      const size_t there = key(to, turned);
      const double total = cost[here] + more;
      if (total >= cost[there]) return;
      cost[there] = total;
      before[there] = static_cast<uint32_t>(here);
      open.emplace(total + bound(to), there);
    };
    for (const int turn : {1, kHeadings - 1}) reach(cell, (heading + turn) % kHeadings, kTurnCost);
    if (heading % kDriveEvery != 0) continue;
    static constexpr std::array<std::array<int, 2>, 8> kSteps = {
        {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
    for (const int quarter : {0, 1, 2, 3}) {
      if (quarter % 2 == 1 && !options_.drives_sideways) continue;
      const auto& step = kSteps[static_cast<size_t>((heading / kDriveEvery + 2 * quarter) % 8)];
      const Cell to{cell.i + step[0], cell.j + step[1]};
      if (!Has(to)) continue;
      const double room = room_[Index(to)] - options_.radius;
      const double tight = kTightCost * std::clamp(1 - room / kAmple, 0.0, 1.0);
      const double factor = quarter == 0 ? 1 : quarter == 2 ? kBackCost : kSideCost;
      reach(to, heading, options_.cell * std::hypot(step[0], step[1]) * (factor + tight));
    }
  }
  return std::nullopt;
}

// Joins places of the way directly where the straight drive between them is free and has as much
// room as the way has.
std::vector<FloorPlace> FloorMap::Shortened(const std::vector<FloorPlace>& way) {
  std::vector<FloorPlace> out = {way.front()};
  const double ample = options_.radius + kAmple / 2;
  const auto turn_to = [&](double yaw) {
    const FloorPlace& last = out.back();
    if (std::abs(Wrapped(yaw - last.yaw)) > kSameOnFloor) out.push_back({last.x, last.y, yaw});
  };
  const auto least_room = [&](const FloorPlace& a, const FloorPlace& b) {
    double least = ample;
    const int steps = 1 + static_cast<int>(std::hypot(b.x - a.x, b.y - a.y) / options_.cell);
    for (int s = 0; s <= steps; ++s) {
      const double t = static_cast<double>(s) / steps;
      least = std::min(least, RoomAt(std::lerp(a.x, b.x, t), std::lerp(a.y, b.y, t)));
    }
    return least;
  };
  const auto cuts = [&](size_t i, size_t j) {
    const FloorPlace &a = way[i], &b = way[j];
    if (std::hypot(b.x - a.x, b.y - a.y) < options_.cell) return false;
    double room = ample;
    for (size_t k = i; k < j; ++k) room = std::min(room, least_room(way[k], way[k + 1]));
    if (least_room(a, b) < room - options_.cell) return false;
    const double yaw = std::atan2(b.y - a.y, b.x - a.x);
    return CanTurn(out.back(), yaw) && CanDrive({a.x, a.y, yaw}, {b.x, b.y, yaw}) &&
           CanTurn({b.x, b.y, yaw}, b.yaw);
  };
  for (size_t i = 0; i + 1 < way.size();) {
    size_t next = i + 1;
    // Halves the stretch until its ends can be joined.
    for (size_t j = way.size() - 1; j > i + 1; j = i + (j - i) / 2) {
      if (!cuts(i, j)) continue;
      next = j;
      break;
    }
    const FloorPlace &a = way[i], &b = way[next];
    if (next > i + 1) turn_to(std::atan2(b.y - a.y, b.x - a.x));
    if (next == i + 1 && std::abs(Wrapped(a.yaw - out.back().yaw)) > kSameOnFloor) turn_to(a.yaw);
    if (std::hypot(b.x - a.x, b.y - a.y) > kSameOnFloor) out.push_back({b.x, b.y, out.back().yaw});
    if (next == i + 1) turn_to(b.yaw);
    i = next;
  }
  turn_to(way.back().yaw);
  // One drive in place of several in a row.
  std::vector<FloorPlace> joined;
  for (const FloorPlace& place : out) {
    while (joined.size() >= 2) {
      const FloorPlace &a = joined[joined.size() - 2], &b = joined.back();
      const Eigen::Vector2d u(b.x - a.x, b.y - a.y), v(place.x - b.x, place.y - b.y);
      const bool is_on = u.norm() > kSameOnFloor && v.norm() > kSameOnFloor &&
                         std::abs(u.x() * v.y() - u.y() * v.x()) < kSameOnFloor && u.dot(v) > 0 &&
                         std::abs(Wrapped(place.yaw - a.yaw)) < kSameOnFloor;
      if (!is_on) break;
      joined.pop_back();
    }
    joined.push_back(place);
  }
  return joined;
}

}  // namespace robocell::internal
