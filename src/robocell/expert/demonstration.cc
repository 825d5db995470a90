#include "robocell/expert/demonstration.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "robocell/expert/skill.h"

namespace robocell::internal {
namespace {

// Names of experts that are no skills.
constexpr std::array kOtherFreePhases = {"move", "travel", "home", "wait"};

// Segments around the gripper's motions begin and end so far from them, m of the TCP's path.
constexpr double kMargin = 0.08;
constexpr double kLeastStroke = 0.2;  // of the opening: less is no opening or closing
constexpr double kSteady = 1e-3;      // change of the opening in a row

constexpr double kMoved = 0.005, kTurned = 0.05;  // m and rad: less is no motion of a body
constexpr double kBegins = 0.002;                 // m: the beginning of a motion
constexpr double kCarried = 0.015;                // m that a held body and the hand move at least
constexpr double kSlips = 0.015;                  // m that a held body may move in the hand
constexpr double kNear = 0.3;                     // m from the held object to what it is put at

struct Span {
  int first, end;
};

std::vector<Span> SpansOfLabels(const Demonstration& demo) {
  std::vector<Span> spans;
  for (int row = 0; row < demo.rows(); ++row) {
    if (IsFreePhase(demo.phases[static_cast<size_t>(demo.phase[static_cast<size_t>(row)])]))
      continue;
    if (spans.empty() || spans.back().end != row) spans.push_back({row, row});
    spans.back().end = row + 1;
  }
  return spans;
}

double PathBetween(const Demonstration& demo, int a, int b) {
  return (demo.target_in_world[static_cast<size_t>(a)].translation() -
          demo.target_in_world[static_cast<size_t>(b)].translation())
      .norm();
}

// Returns the rows in which the gripper opens or closes by more than a little.
std::vector<Span> StrokesOf(const Demonstration& demo) {
  std::vector<Span> strokes;
  const std::vector<double>& opening = demo.opening;
  for (int row = 1; row < static_cast<int>(opening.size()); ++row) {
    const auto at = static_cast<size_t>(row);
    if (std::abs(opening[at] - opening[at - 1]) < kSteady) continue;
    if (strokes.empty() || strokes.back().end < row) strokes.push_back({row - 1, row});
    strokes.back().end = row + 1;
  }
  std::erase_if(strokes, [&](const Span& stroke) {
    const auto first = opening.begin() + stroke.first, end = opening.begin() + stroke.end;
    return *std::max_element(first, end) - *std::min_element(first, end) < kLeastStroke;
  });
  return strokes;
}

std::vector<Span> SpansOfGripper(const Demonstration& demo) {
  std::vector<Span> spans;
  for (Span stroke : StrokesOf(demo)) {
    double path = 0;
    while (stroke.first > 0 && path < kMargin) {
      path += PathBetween(demo, stroke.first, stroke.first - 1);
      --stroke.first;
    }
    path = 0;
    while (stroke.end < demo.rows() && path < kMargin) {
      path += PathBetween(demo, stroke.end - 1, stroke.end);
      ++stroke.end;
    }
    if (!spans.empty() && stroke.first <= spans.back().end)
      spans.back().end = stroke.end;
    else
      spans.push_back(stroke);
  }
  if (spans.empty()) spans.push_back({0, demo.rows()});
  return spans;
}

// The motion of a body within some rows.
struct BodyMotion {
  bool moved = false;
  double slip = 0;  // m, largest displacement of the TCP in the body while it moves
};

BodyMotion MotionOf(const Demonstration& demo, const std::vector<Pose>& body, const Span& rows) {
  BodyMotion motion;
  const Pose& start = body[static_cast<size_t>(rows.first)];
  std::optional<Eigen::Vector3d> grip;
  const int last = std::min(rows.end, demo.rows() - 1);
  for (int row = rows.first; row <= last; ++row) {
    const Pose& now = body[static_cast<size_t>(row)];
    motion.moved |= !now.is_close(start, kTurned, kMoved);
    if (now.is_close(start, kTurned, kBegins)) continue;
    const Eigen::Vector3d tcp =
        now.inverse() * demo.tcp_in_world[static_cast<size_t>(row)].translation();
    if (!grip) grip = tcp;
    motion.slip = std::max(motion.slip, (tcp - *grip).norm());
  }
  return motion;
}

// Returns the body that the hand takes along in these rows; "" without one.
std::string CarriedIn(const Demonstration& demo, const Span& rows) {
  if (rows.end <= rows.first) return "";
  std::string carried;
  double least = kSlips;
  const auto at = [](const std::vector<Pose>& poses, int row) {
    return poses[static_cast<size_t>(row)];
  };
  const int last = std::min(rows.end, demo.rows() - 1);
  const Eigen::Vector3d way =
      at(demo.tcp_in_world, last).translation() - at(demo.tcp_in_world, rows.first).translation();
  if (way.norm() < kCarried) return "";
  for (const auto& [name, poses] : demo.bodies) {
    const Pose from = at(poses, rows.first), to = at(poses, last);
    if ((to.translation() - from.translation()).norm() < kCarried) continue;
    const double slip = (from.inverse() * at(demo.tcp_in_world, rows.first).translation() -
                         to.inverse() * at(demo.tcp_in_world, last).translation())
                            .norm();
    if (slip < least) {
      least = slip;
      carried = name;
    }
  }
  return carried;
}

// Returns the body nearest to another one; "" if none is near.
std::string NearestTo(const Demonstration& demo, const std::string& body, int row) {
  const Eigen::Vector3d place = demo.bodies.at(body)[static_cast<size_t>(row)].translation();
  std::string nearest;
  double least = kNear;
  for (const auto& [name, poses] : demo.bodies) {
    if (name == body) continue;
    const double distance = (poses[static_cast<size_t>(row)].translation() - place).norm();
    if (distance < least) {
      least = distance;
      nearest = name;
    }
  }
  return nearest;
}

// Returns the body that moves with the hand, of those that move.
std::string MovedIn(const Demonstration& demo, const Span& rows) {
  std::string moved;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [name, poses] : demo.bodies) {
    const BodyMotion motion = MotionOf(demo, poses, rows);
    if (!motion.moved || motion.slip >= least) continue;
    least = motion.slip;
    moved = name;
  }
  return moved;
}

}  // namespace

bool IsFreePhase(std::string_view phase) {
  const auto has = [&](const auto& names) {
    return std::ranges::find(names, phase) != std::ranges::end(names);
  };
  return has(FreeSkillPhases()) || has(kOtherFreePhases);
}

bool HasSegmentLabels(const Demonstration& demo) {
  return std::ranges::any_of(
      demo.phase, [&](int phase) { return IsFreePhase(demo.phases[static_cast<size_t>(phase)]); });
}

std::vector<DemoSegment> FindSegments(const Demonstration& demo) {
  std::vector<DemoSegment> segments;
  int free_since = 0;
  for (const Span& span : HasSegmentLabels(demo) ? SpansOfLabels(demo) : SpansOfGripper(demo)) {
    DemoSegment segment{.first = span.first, .end = span.end};
    segment.held = CarriedIn(demo, {free_since, span.first});
    if (segment.held.empty()) {
      segment.reference = MovedIn(demo, span);
      if (segment.reference.empty()) continue;  // a grasp of nothing, which was repeated
    } else {
      segment.reference = NearestTo(demo, segment.held, std::min(span.end, demo.rows() - 1));
    }
    segments.push_back(std::move(segment));
    free_since = span.end;
  }
  return segments;
}

}  // namespace robocell::internal
