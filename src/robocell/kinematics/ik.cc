#include "robocell/kinematics/ik.h"

#include <fmt/format.h>

#include <cmath>

#include "robocell/base/error.h"
#include "robocell/kinematics/ik_choice.h"
#include "robocell/kinematics/ik_task.h"
#include "robocell/kinematics/lane_solver.h"

namespace robocell {

namespace {

IkResult ChooseOne(const Chain& chain, const Transform& target, const IkOptions& options,
                   const std::function<void()>& poll) {
  const internal::LaneQuery query{.target = target, .seed = options.seed};
  std::array<internal::IkChoice::Search, internal::IkChoice::kSearches> searches;
  IkResult answer;
  internal::IkChoice choice(chain, options, {&query, 1}, searches, {&answer, 1});
  const std::atomic<bool> ended = false;
  do {
    choice.Run(0, 1, ended, poll);
  } while (choice.Choose());
  return answer;
}

void RequireCount(std::string_view what, int value) {
  if (value < 0)
    throw ArgumentError(
        fmt::format("inverse kinematics: {} is {}; it must be 0 or more", what, value));
}

void RequirePreference(const Chain& chain, const IkOptions& options) {
  if (options.prefer == IkPrefer::kSeed && options.seed.empty()) {
    throw ArgumentError(
        "inverse kinematics: the solution near the seed is preferred, but there is no seed. Give "
        "one, or a posture instead");
  }
  if (options.prefer != IkPrefer::kPosture) {
    if (options.posture.empty()) return;
    throw ArgumentError(
        "inverse kinematics: a posture is given, but prefer is not 'posture'; set prefer to "
        "kPosture");
  }
  chain.RequireJointValues("inverse kinematics: posture", options.posture);
}

}  // namespace

LockedJoints LockJoints(const Chain& chain, std::span<const std::string> names) {
  LockedJoints locked{};
  for (const std::string& name : names) locked[chain.joint_index(name)] = true;
  return locked;
}

void RequireIkTarget(const Pose& tip_in_base, std::string_view name) {
  if (!IsFinite(tip_in_base)) RefuseIkTarget(name);
}

void RefuseIkTarget(std::string_view name) {
  throw ArgumentError(fmt::format("inverse kinematics: {} has a number that is not finite", name));
}

void RequireIkOptions(const Chain& chain, const IkOptions& options) {
  const JointVector& seed = options.seed;
  if (!seed.empty() && seed.size() != chain.n_joints()) {
    throw ArgumentError(
        fmt::format("inverse kinematics of {}: seed: expected {} joint values, got {}",
                    chain.description(), chain.n_joints(), seed.size()));
  }
  for (int i = 0; i < chain.n_joints(); ++i) {
    const std::string& name = chain.joints()[i].name;
    if (!seed.empty() && !std::isfinite(seed[i])) {
      throw ArgumentError(
          fmt::format("inverse kinematics: seed of joint '{}' is {}", name, seed[i]));
    }
    if (seed.empty() && options.locked[i]) {
      throw ArgumentError(
          fmt::format("inverse kinematics: joint '{}' is locked, but there is no seed that says "
                      "where. Give a seed.",
                      name));
    }
  }
  if (!(options.tolerance > 0 && std::isfinite(options.tolerance))) {
    throw ArgumentError(fmt::format("inverse kinematics: tolerance is {}; it must be more than 0",
                                    options.tolerance));
  }
  internal::RequireIkTask(options);
  RequirePreference(chain, options);
  RequireCount("max_restarts", options.max_restarts);
  RequireCount("max_iterations", options.max_iterations);
}

IkResult Ik(const Chain& chain, const Pose& tip_in_base, const IkOptions& options,
            const std::function<void()>& poll) {
  RequireIkTarget(tip_in_base, "target");
  RequireIkOptions(chain, options);
  const Transform target = ToTransform(tip_in_base);
  return internal::IsChosen(options) ? ChooseOne(chain, target, options, poll)
                                     : internal::SearchInLanes(chain, target, options, poll);
}

}  // namespace robocell
