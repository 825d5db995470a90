#include "robocell/kinematics/ik_counted.h"

#include <cmath>

#include "robocell/kinematics/ik_parts.h"

namespace robocell {
namespace {

constexpr int kMostStartsMore = 2000;

}  // namespace

bool LooksForAll(const Chain& chain, const IkTask& task, const IkOptions& options) {
  return options.max_restarts + 1 >= kFewStarts &&
         !task.leaves_joints(chain.n_joints(), options.locked);
}

bool MayFindAnother(const IkOptions& options, int newest, int begun, int quiet) {
  return begun - newest <= quiet && begun - kMostStartsMore <= options.max_restarts;
}

bool AreApart(const ChainModel& chain, const JointVector& a, const JointVector& b, double least) {
  for (int i = 0; i < chain.n; ++i) {
    const double way = a[i] - b[i];
    const double apart = chain.joints[i].slide ? way / chain.length : std::remainder(way, kTurn);
    if (std::abs(apart) > least) return true;
  }
  return false;
}

}  // namespace robocell
