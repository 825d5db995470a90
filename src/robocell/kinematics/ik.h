// Inverse kinematics of one pose: joint values that put the tip of a chain at a target.
//
// The target is the pose of the tip in the base frame. The search starts at the seed, whose
// solution takes precedence; if the seed is far or slow, other searches run meanwhile in lanes of a
// vector register, from starts near the target and from points that fill the joint space evenly.
// The same query has the same result, on every thread and at every time (another instruction set
// may find another solution). Limits are always obeyed. A fresh forward kinematics judges the
// result.
//
// Not finding a solution is a value (success = false, with the best joint values found), never an
// exception; it takes bounded time (at most max_iterations steps for the seed and each restart, and
// twice that to choose; a step is below a microsecond). If at least 100 restarts are allowed and
// all of them failed, but one came near (a tenth of a radian or of the chain's length), 400 more
// follow: most of such targets lie in corners of the limits. A chain of too few joints gets none.
// Throws ArgumentError for a target or seed that is not finite, a wrong number of seed values,
// locked joints without a seed, and options out of range.
//
// Joints without limits: hinges start anywhere in a turn, slides within the chain's length; nothing
// is clipped. Hinges with limits that are a whole turn apart or more are not clipped either, except
// in the search from the seed. Of positions that are whole turns apart and within the limits, the
// one nearest to the seed is returned.
//
// Nothing is allocated, except by a filter, and for a table of starts that a chain makes once, when
// a seed is first not near enough to search alone. Method: damped least squares without the joints
// that press on a limit (after T. Sugihara, "Solvability-Unconcerned Inverse Kinematics by the
// Levenberg-Marquardt Method", 2011), with many short searches instead of a few long ones.
// lane_solver.h solves one query in all lanes, ik_batch.h one query per lane.
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

// The joints of a chain that must keep the seed's values.
using LockedJoints = std::array<bool, kMaxChainJoints>;

// The preferred solution. All but kFirst compare sixteen solutions and move redundant joints: that
// takes some tens of microseconds, and about twice as long for kManipulability, which climbs.
// Without redundant joints the best is one of a few: starts continue beyond max_restarts until 256
// in a row have led to no better one (2000 more at most), which takes some tenths of a millisecond.
// With max_restarts below 47 they do not, which gives a near one in a seventh of that time.
enum class IkPrefer {
  kFirst,           // the first that is found
  kSeed,            // near the seed, which is then required
  kPosture,         // near options.posture
  kAwayFromLimits,  // the middle of the limits, by the sum of squared shares of the half range
  kManipulability,  // largest manipulability (manipulability.h)
};

// Decides which configurations may be a solution: `q` holds `count` of them row by row, and the
// filter sets `keep` to 1 or 0 for each, independently of the others. Called on the caller's
// thread.
using IkFilter = std::function<void(std::span<const double> q, int count, std::span<uint8_t> keep)>;

struct IkOptions {
  // Largest position error (m) and rotation error (rad), each as a norm.
  double tolerance = 1e-5;
  // Start of the search, and values of locked joints. Values outside the limits are moved to them,
  // but those of locked joints are kept exactly. Empty: the middle of the limits, 0 for joints
  // without.
  JointVector seed{};
  // Requires a seed. See LockJoints.
  LockedJoints locked{};
  // Reach the target's position with any rotation.
  bool position_only = false;
  // Weights of errors along (m) or about (rad) each axis of the target: an error is multiplied by
  // its weight. 0: any value is accepted. With one 0 among the rotations only the direction of that
  // axis counts.
  std::array<double, 3> position_weights = {1, 1, 1}, rotation_weights = {1, 1, 1};
  // If set, only this direction in the tip's frame counts of the rotation: it must agree with the
  // target's, up to `cone` rad.
  std::optional<Eigen::Vector3d> axis{};
  double cone = 0;
  IkPrefer prefer = IkPrefer::kFirst;
  JointVector posture{};  // posture of IkPrefer::kPosture; clamped to the limits
  // Rejects solutions; of positions that are whole turns apart it sees the one nearest to the seed.
  // If it keeps none, the result is one of them with success = false. Starts are tried until one is
  // kept.
  IkFilter filter{};
  // Starts after the one from the seed, to find a solution. From 100 on there are 400 more if the
  // best came near; some preferences continue in search of a better solution (IkPrefer).
  int max_restarts = 100;
  // Most steps of one start; starts without progress end earlier.
  int max_iterations = 40;
};

struct IkResult {
  JointVector q{};
  bool success = false;
  double position_error = 0;  // m, of q; of the requested part, with weights
  double rotation_error = 0;  // rad; the whole rotation, not judged with position_only
  int iterations = 0;         // steps; those that lanes take at once count as one
  int restarts = 0;           // starts before the one that first led to this solution
};

// Locks the named joints. Throws NotFoundError that lists the chain's.
LockedJoints LockJoints(const Chain& chain, std::span<const std::string> names);

// `poll` is called occasionally if many starts are needed; its exception ends the search and is
// rethrown.
IkResult Ik(const Chain& chain, const Pose& tip_in_base, const IkOptions& options = {},
            const std::function<void()>& poll = {});

// Throws ArgumentError for targets that Ik rejects, for callers that check many queries before the
// work. `name` begins the message.
void RequireIkTarget(const Pose& tip_in_base, std::string_view name);
[[noreturn]] void RefuseIkTarget(std::string_view name);  // is not finite
void RequireIkOptions(const Chain& chain, const IkOptions& options);

}  // namespace robocell
