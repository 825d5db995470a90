#include "robocell/motion/joint_path.h"

#include <algorithm>
#include <cmath>

namespace robocell {
namespace {

// Returns k with reversed bits: checks an edge coarsely first, so that blocked edges are detected
// early.
unsigned Reversed(unsigned k, unsigned bits) {
  unsigned r = 0;
  for (unsigned i = 0; i < bits; ++i) r |= ((k >> i) & 1u) << (bits - 1 - i);
  return r;
}

class Tree {
 public:
  explicit Tree(const JointVector& root) : nodes_{root}, parents_{-1} {}

  size_t Nearest(const JointVector& q) const {
    size_t best = 0;
    for (size_t i = 1; i < nodes_.size(); ++i) {
      if (JointDistance(nodes_[i], q) < JointDistance(nodes_[best], q)) best = i;
    }
    return best;
  }
  void Add(const JointVector& q, size_t parent) {
    nodes_.push_back(q);
    parents_.push_back(static_cast<int>(parent));
  }
  const JointVector& node(size_t i) const { return nodes_[i]; }
  const JointVector& newest() const { return nodes_.back(); }
  // Returns the path from the newest node to the root.
  JointPath Back() const {
    JointPath path;
    for (int i = static_cast<int>(nodes_.size()) - 1; i >= 0; i = parents_[i])
      path.push_back(nodes_[i]);
    return path;
  }

 private:
  JointPath nodes_;
  std::vector<int> parents_;
};

enum class Growth { kTrapped, kAdvanced, kReached };

Growth Extend(Tree& tree, const JointVector& towards, const FreeFunction& is_free, double step) {
  const size_t from = tree.Nearest(towards);
  const double distance = JointDistance(tree.node(from), towards);
  if (distance < 1e-9) return Growth::kTrapped;  // already there: nothing new
  const bool reaches = distance <= step;
  const JointVector next = reaches ? towards : Blend(tree.node(from), towards, step / distance);
  if (!EdgeIsFree(tree.node(from), next, is_free)) return Growth::kTrapped;
  tree.Add(next, from);
  return reaches ? Growth::kReached : Growth::kAdvanced;
}

void Shorten(JointPath& path, const FreeFunction& is_free, Rng& rng, int tries) {
  for (int t = 0; t < tries && path.size() > 2; ++t) {
    const size_t a = rng.UniformInt(path.size()), b = rng.UniformInt(path.size());
    const size_t i = std::min(a, b), j = std::max(a, b);
    if (j - i < 2 || !EdgeIsFree(path[i], path[j], is_free)) continue;
    path.erase(path.begin() + static_cast<std::ptrdiff_t>(i) + 1,
               path.begin() + static_cast<std::ptrdiff_t>(j));
  }
}

JointVector Draw(const JointVector& a, const JointVector& b, const std::vector<Interval>& limits,
                 double beyond, Rng& rng) {
  JointVector q(a.size());
  for (int i = 0; i < q.size(); ++i) {
    const double low = std::max(std::min(a[i], b[i]) - beyond, limits[i].lower);
    const double high = std::min(std::max(a[i], b[i]) + beyond, limits[i].upper);
    q[i] = low < high ? rng.Uniform(low, high) : low;
  }
  return q;
}

}  // namespace

double JointDistance(const JointVector& a, const JointVector& b) {
  double most = 0;
  for (int i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

JointVector Blend(const JointVector& a, const JointVector& b, double part) {
  JointVector q(a.size());
  for (int i = 0; i < q.size(); ++i) q[i] = a[i] + part * (b[i] - a[i]);
  return q;
}

bool EdgeIsFree(const JointVector& a, const JointVector& b, const FreeFunction& is_free,
                double step) {
  const unsigned n = std::max(1u, static_cast<unsigned>(std::ceil(JointDistance(a, b) / step)));
  if (!is_free(b)) return false;
  unsigned bits = 0;
  while ((1u << bits) < n) ++bits;
  for (unsigned i = 1; i < (1u << bits); ++i) {
    const unsigned k = Reversed(i, bits);
    if (k < n && !is_free(Blend(a, b, static_cast<double>(k) / n))) return false;
  }
  return true;
}

std::optional<JointPath> ConnectTrees(const JointVector& start, const JointVector& goal,
                                      const std::vector<Interval>& limits,
                                      const FreeFunction& is_free, Rng& rng,
                                      const TreeOptions& options) {
  Tree trees[2] = {Tree(start), Tree(goal)};
  for (int i = 0; i < options.iterations; ++i) {
    Tree& grown = trees[i % 2];
    Tree& other = trees[1 - i % 2];
    const JointVector drawn = Draw(start, goal, limits, options.beyond, rng);
    if (Extend(grown, drawn, is_free, options.step) == Growth::kTrapped) continue;
    const JointVector meeting = grown.newest();
    Growth growth = Growth::kAdvanced;
    while (growth == Growth::kAdvanced) growth = Extend(other, meeting, is_free, options.step);
    if (growth != Growth::kReached) continue;
    JointPath path = trees[0].Back();
    std::reverse(path.begin(), path.end());
    const JointPath rest = trees[1].Back();
    path.insert(path.end(), rest.begin() + 1, rest.end());  // both have the meeting point
    Shorten(path, is_free, rng, options.shortcuts);
    return path;
  }
  return std::nullopt;
}

}  // namespace robocell
