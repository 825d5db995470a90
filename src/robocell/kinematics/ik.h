// Inverse kinematics of one pose: joint values that put the tip of a chain where it shall be.
//
// The target is the pose of the tip in the base frame. The search starts at the seed, whose answer
// goes before all others; where it is far or slow, others are made meanwhile in lanes of a vector
// register, near the target and from points that fill the joint space evenly. The same question has
// the same answer, on every thread and at every time (another instruction set may find another
// solution). Limits are always obeyed. The answer is judged by a fresh forward kinematics.
//
// Not finding a solution is a value (success = false, with the best joint values met), never an
// exception; it takes bounded time (at most max_iterations steps for the seed and each restart, and
// twice that to choose; a step is below a microsecond). Where 100 restarts or more are allowed, and
// all of them failed but one came near (a tenth of a radian or of the chain's length), 400 more are
// made: most of such targets lie in corners of the limits. A chain of too few joints makes none.
// ArgumentError: a target or seed that is not finite, a wrong number of seed values, locked joints
// without a seed, options out of range.
//
// Joints without limits: hinges start anywhere in a turn, slides within the chain's length; nothing
// is clipped. Nor are hinges with limits that are a whole turn apart or more, but in the search
// from the seed. Of positions that are whole turns apart and in the limits, the one nearest to the
// seed is returned.
//
// Nothing is allocated (but by a filter), but for a table of starts that a chain makes once, when a
// seed is first not near enough to search alone. Method: damped least squares with joints that
// press on a limit taken out (after T. Sugihara, "Solvability-Unconcerned Inverse Kinematics by the
// Levenberg-Marquardt Method", 2011), many short tries instead of a few long ones. lane_solver.h
// has one question in all lanes, ik_batch.h one question per lane.
//
//   IkResult found = Ik(chain, target, {.seed = JointVector(q_now)});
//   if (found.success) Command(found.q);
//   // The tip's z axis within 0.2 rad of the target's, the elbow as free as it can be:
//   found = Ik(chain, target, {.axis = Eigen::Vector3d::UnitZ(), .cone = 0.2,
//                              .prefer = IkPrefer::kAwayFromLimits});
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/ik_targets.h"

namespace robocell {

// Which joints of a chain must stay where the seed has them.
using LockedJoints = std::array<bool, kMaxChainJoints>;

// Which of the solutions is wanted. What is not kFirst compares sixteen, and moves redundant joints:
// some tens of microseconds, kManipulability, which climbs, about twice as many. Without joints to
// spare the best is one of a few: starts go on beyond max_restarts until 256 in a row have led to
// no better one (2000 more at most), which takes some tenths of a millisecond. Not where
// max_restarts is below 47, which gives a near one in a seventh of that.
enum class IkPrefer {
  kFirst,           // the first that is found
  kSeed,            // near the seed, which has to be given
  kPosture,         // near options.posture
  kAwayFromLimits,  // in the middle of the limits, by the sum of squared shares of the half range
  kManipulability,  // where the tip can move best (manipulability.h)
};

// Says which configurations may be an answer: `q` holds `count` of them row by row, `keep` is set
// to 1 or 0 for each, whatever the others are. Called on the thread that asks.
using IkFilter = std::function<void(std::span<const double> q, int count, std::span<uint8_t> keep)>;

struct IkOptions {
  // Largest position error (m) and rotation error (rad), each as a norm.
  double tolerance = 1e-5;
  // Where to start, and where locked joints are. Values outside the limits are moved to them, but
  // those of locked joints are kept exactly. Empty: the middle of the limits, 0 for joints without.
  JointVector seed{};
  // Needs a seed. See LockJoints.
  LockedJoints locked{};
  // Reach the target's position with any rotation.
  bool position_only = false;
  // What an error along (m) or about (rad) each axis of the target counts: it is multiplied by
  // this. 0: any value will do. With one 0 among the rotations only the direction of that axis is
  // asked for.
  std::array<double, 3> position_weights = {1, 1, 1}, rotation_weights = {1, 1, 1};
  // Of the rotation only this direction in the tip's frame is asked for: it points where the
  // target's points, or off by at most `cone` rad.
  std::optional<Eigen::Vector3d> axis{};
  double cone = 0;
  IkPrefer prefer = IkPrefer::kFirst;
  JointVector posture{};  // of IkPrefer::kPosture; values outside the limits are moved to them
  // Solutions that it does not keep are none; of positions that are whole turns apart it sees the
  // one nearest to the seed. When it keeps none, the answer is one of them with
  // success = false. Starts are tried until one is kept.
  IkFilter filter{};
  // Starts after the one from the seed, to find a solution. From 100 on there are 400 more where
  // the best came near; some preferences go on to look for a better solution (IkPrefer).
  int max_restarts = 100;
  // Most steps of one start; starts that get nowhere end earlier.
  int max_iterations = 40;
};

struct IkResult {
  JointVector q{};
  bool success = false;
  double position_error = 0;  // m, of q; of what is asked for, weights taken into account
  double rotation_error = 0;  // rad; the whole one, not judged, when only the position is asked for
  int iterations = 0;         // steps; those that lanes take at once count as one
  int restarts = 0;           // starts before the first that led to this solution
};

// Locks the named joints; NotFoundError lists the chain's.
LockedJoints LockJoints(const Chain& chain, std::span<const std::string> names);

// `poll` is called now and then where many starts are needed; what it throws ends the search and
// comes out of it.
IkResult Ik(const Chain& chain, const Pose& tip_in_base, const IkOptions& options = {},
            const std::function<void()>& poll = {});

// What Ik refuses with ArgumentError, for callers that check many questions before the work. `name`
// begins the message.
void RequireIkTarget(const Pose& tip_in_base, std::string_view name);
[[noreturn]] void RefuseIkTarget(std::string_view name);  // which is not finite
void RequireIkOptions(const Chain& chain, const IkOptions& options);

}  // namespace robocell
