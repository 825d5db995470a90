// The relation `wiped`: an object has wiped a region. The region is a grid of cells; a cell counts
// once the object has been over it while it pressed on something with a force within a range.
//
//   | sentence           | holds if                                                        |
//   | A wiped B [share]  | that share of the cells of region B has been wiped with A (0.8) |
//
// The region is a geom or the largest geom of an object, a box or a cylinder. Throws NotFoundError
// for unknown names and ArgumentError for other regions. Threads: those of the scene.
#pragma once

#include <span>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/math/pose.h"
#include "robocell/scene/body_handle.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/relations.h"
#include "robocell/task/body_geoms.h"
#include "robocell/task/held_motion.h"

namespace robocell::internal {

inline constexpr double kWipeCell = 0.01;                            // m
inline constexpr double kLeastWipeForce = 0.5, kMostWipeForce = 30;  // N

// A flat region and its cells.
class WipeRegion {
 public:
  WipeRegion(const Scene& scene, const std::string& name);

  // Returns its frame in the world: in the middle of its upper face, z up.
  Pose frame() const;
  double half_x() const { return half_[0]; }
  double half_y() const { return half_[1]; }
  // Returns the middles of its cells in its frame.
  const std::vector<Eigen::Vector2d>& cells() const { return cells_; }

 private:
  Scene scene_;
  BodyHandle body_;
  int offset_ = 0;  // of the geom among those of its body
  double half_[2] = {0, 0}, height_ = 0;
  std::vector<Eigen::Vector2d> cells_;
};

class Wiped final : public BoundRelation {
 public:
  Wiped(const Scene& scene, const StatedRelation& stated);
  bool Holds() const override;
  double Progress() const override;
  RelationSamples Sample(Rng& rng, int count) const override;
  void Watch() override;
  std::vector<double> memory() const override { return wiped_; }
  void Recall(std::span<const double> memory) override;

 private:
  Scene scene_;
  BodyGeoms object_;
  WipeRegion region_;
  double share_;
  std::vector<double> wiped_;  // 1 for each cell that is, else 0
};

RelationKind WipedRelation();
// Returns paths of the object from side to side over the region, with lanes along its longer side.
std::vector<HeldPath> WipePaths(const Scene& scene, const StatedRelation& stated,
                                const Pose& lifted);

}  // namespace robocell::internal
