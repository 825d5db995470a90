#include "robocell/motion/goal_trees.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "robocell/motion/sphere_kernel.h"

namespace robocell::internal {
namespace {

constexpr double kSame = 1e-9;

void MoveTowards(std::span<const double> from, std::span<const double> to, double part,
                 std::vector<double>* out) {
  out->resize(from.size());
  for (size_t i = 0; i < from.size(); ++i) (*out)[i] = from[i] + part * (to[i] - from[i]);
}

}  // namespace

double DistanceIn(const JointSpace& space, std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double d = (a[i] - b[i]) / space.units[i];
    sum += d * d;
  }
  return std::sqrt(sum);
}

double LengthIn(const JointSpace& space, const Rows& path) {
  double length = 0;
  for (size_t k = 1; k < path.size(); ++k) length += DistanceIn(space, path[k - 1], path[k]);
  return length;
}

std::span<const double> GoalTrees::Tree::at(int node) const {
  const size_t n = space_->units.size();
  return std::span(rows_).subspan(static_cast<size_t>(node) * n, n);
}

void GoalTrees::Tree::Add(std::span<const double> q, int parent) {
  const int node = size(), n = static_cast<int>(q.size());
  if (node == stride_) {
    const int wider = std::max(16 * kLanes, 2 * stride_);
    std::vector<float> columns(static_cast<size_t>(wider) * n);
    for (int i = 0; i < n; ++i)
      std::copy_n(columns_.begin() + static_cast<std::ptrdiff_t>(i) * stride_, node,
                  columns.begin() + static_cast<std::ptrdiff_t>(i) * wider);
    columns_ = std::move(columns);
    stride_ = wider;
  }
  rows_.insert(rows_.end(), q.begin(), q.end());
  parents_.push_back(parent);
  for (int i = 0; i < n; ++i)
    columns_[static_cast<size_t>(i) * stride_ + node] = static_cast<float>(q[i] / space_->units[i]);
}

int GoalTrees::Tree::Nearest(std::span<const double> q) const {
  asked_.clear();
  for (size_t i = 0; i < q.size(); ++i)
    asked_.push_back(static_cast<float>(q[i] / space_->units[i]));
  return FindNearest(columns_.data(), stride_, size(), static_cast<int>(q.size()), asked_.data());
}

GoalTrees::GoalTrees(std::span<const double> start, const Rows& goals, const JointSpace& space,
                     EdgeJudge* judge)
    : space_(space),
      judge_(*judge),
      trees_{Tree(space), Tree(space)},
      goals_(static_cast<int>(goals.size())) {
  trees_[0].Add(start, -1);
  for (const std::vector<double>& goal : goals) trees_[1].Add(goal, -1);
}

void GoalTrees::Join(int start_node, int goal_node) {
  for (int k = start_node; k >= 0; k = trees_[0].parent(k)) {
    const std::span<const double> q = trees_[0].at(k);
    path_.emplace_back(q.begin(), q.end());
  }
  std::reverse(path_.begin(), path_.end());
  for (int k = goal_node; k >= 0; k = trees_[1].parent(k)) {
    goal_ = k;
    const std::span<const double> q = trees_[1].at(k);
    if (DistanceIn(space_, q, path_.back()) > kSame) path_.emplace_back(q.begin(), q.end());
  }
}

void GoalTrees::TryDirect(int goals) {
  std::vector<int> order(goals_);
  std::iota(order.begin(), order.end(), 0);
  const std::span<const double> start = trees_[0].at(0);
  std::ranges::stable_sort(order, {},
                           [&](int g) { return DistanceIn(space_, start, trees_[1].at(g)); });
  for (int k = 0; k < std::min(goals, goals_) && !found(); ++k) {
    if (judge_.IsFree(start, trees_[1].at(order[k]))) Join(0, order[k]);
  }
}

GoalTrees::Growth GoalTrees::Extend(Tree& tree, std::span<const double> towards) {
  const int from = tree.Nearest(towards);
  const double distance = DistanceIn(space_, tree.at(from), towards);
  if (distance < kSame) return Growth::kReached;
  const bool reaches = distance <= space_.range;
  MoveTowards(tree.at(from), towards, reaches ? 1 : space_.range / distance, &next_);
  if (!judge_.Project(next_)) return Growth::kTrapped;
  if (DistanceIn(space_, tree.at(from), next_) < 1e-4) return Growth::kTrapped;
  if (!judge_.IsFree(tree.at(from), next_)) return Growth::kTrapped;
  tree.Add(next_, from);
  return reaches && DistanceIn(space_, next_, towards) < kSame ? Growth::kReached
                                                               : Growth::kAdvanced;
}

void GoalTrees::Step(Rng& rng) {
  const int smaller = trees_[0].size() <= trees_[1].size() ? 0 : 1;
  Tree &grown = trees_[smaller], &other = trees_[1 - smaller];
  drawn_.clear();
  for (const Interval& bounds : space_.bounds)
    drawn_.push_back(rng.Uniform(bounds.lower, bounds.upper));
  if (Extend(grown, drawn_) == Growth::kTrapped) return;
  const int meeting = grown.size() - 1;
  const std::vector<double> towards(grown.at(meeting).begin(), grown.at(meeting).end());
  Growth growth = Growth::kAdvanced;
  double left = 1e300;
  while (growth == Growth::kAdvanced) {
    growth = Extend(other, towards);
    const double now = DistanceIn(space_, other.at(other.size() - 1), towards);
    if (growth == Growth::kAdvanced && now > left - 1e-6) break;  // projections may turn back
    left = now;
  }
  if (growth != Growth::kReached) return;
  const int reached = other.Nearest(towards);
  smaller == 0 ? Join(meeting, reached) : Join(reached, meeting);
}

void Shorten(Rows* path, const JointSpace& space, EdgeJudge* judge, Rng& rng, int tries) {
  // Skips to the farthest waypoint that a straight motion reaches.
  for (size_t i = 0; i + 2 < path->size(); ++i) {
    for (size_t j = path->size() - 1; j > i + 1; --j) {
      if (!judge->IsFree((*path)[i], (*path)[j])) continue;
      path->erase(path->begin() + static_cast<std::ptrdiff_t>(i) + 1,
                  path->begin() + static_cast<std::ptrdiff_t>(j));
      break;
    }
  }
  std::vector<double> ends;  // length of the path up to each waypoint
  std::vector<double> from, to;
  for (int t = 0; t < tries && path->size() > 2; ++t) {
    ends.assign(1, 0.0);
    for (size_t k = 1; k < path->size(); ++k)
      ends.push_back(ends.back() + DistanceIn(space, (*path)[k - 1], (*path)[k]));
    double a = rng.Uniform(0, ends.back()), b = rng.Uniform(0, ends.back());
    if (a > b) std::swap(a, b);
    const auto point = [&](double along, std::vector<double>* q) {
      const size_t k =
          std::min<size_t>(path->size() - 1, std::ranges::upper_bound(ends, along) - ends.begin());
      const double length = ends[k] - ends[k - 1];
      MoveTowards((*path)[k - 1], (*path)[k], length > 0 ? (along - ends[k - 1]) / length : 1, q);
      return k;
    };
    const size_t i = point(a, &from), j = point(b, &to);
    if (i == j) continue;
    const double straight = DistanceIn(space, from, to);
    if (straight > b - a - 1e-3 || !judge->IsFree(from, to)) continue;
    path->erase(path->begin() + static_cast<std::ptrdiff_t>(i),
                path->begin() + static_cast<std::ptrdiff_t>(j));
    path->insert(path->begin() + static_cast<std::ptrdiff_t>(i), {from, to});
  }
}

}  // namespace robocell::internal
