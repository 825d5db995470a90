// CollisionModel: which configurations of a robot are free of collisions, many at once.
//
//   CollisionModel model(robot, joints, {.clearance = 0.001});
//   const bool free = !model.FindContact(q);              // by the engine's distances
//   uint32_t hits = model.MayHit(rows, 8, kCautious);     // by spheres, in a tenth of the time
//
// Two judges look at the same pairs of geoms. Spheres that contain the geoms (sphere_cover.h) say
// "surely free" or "perhaps not"; the engine's distances decide about the pairs that the spheres
// leave. Objects are where they were at the last Update(), except attached ones, which move with
// their link. Pairs of the robot's own parts that overlap at the last Update() may always touch.
//
// Only geoms that collide in the model count, and of the robot only Robot::collision_geom_ids().
// Planes do not count for a moving base, which stands on them.
// One thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robocell/motion/moving_links.h"
#include "robocell/motion/sphere_kernel.h"
#include "robocell/mujoco/owners.h"
#include "robocell/robot/robot.h"

namespace robocell::internal {

struct CollisionOptions {
  double clearance = 0;  // to everything that is not the robot, m
  // Bodies, with their subtrees, that may touch each other; an empty name stands for everything.
  std::vector<std::pair<std::string, std::string>> allowed{};
  // Bodies, with their subtrees, that move with another body, and that body.
  std::vector<std::pair<std::string, std::string>> attached{};
};

struct GeomContact {
  int geom = -1, other = -1;  // the first one moves
  double distance = 0;        // m; below 0 for an overlap
};

// How spheres judge. Cautious: nothing is missed. Bold: parts of the robot may come nearer to each
// other than their spheres, so that tight postures pass; the engine has to look at the result.
enum class SphereJudge { kCautious, kBold };

class CollisionModel {
 public:
  // `joints`: ids of the moving joints. Throws as MovingLinks does, and NotFoundError for unknown
  // bodies.
  CollisionModel(const Robot& robot, std::span<const int> joints, const CollisionOptions& options);
  ~CollisionModel();

  // Copies the scene's present state. Throws Error after objects were added to it or removed.
  void Update();

  const Robot& robot() const;
  const mjModel* model() const;
  const MovingLinks& links() const;
  int n_dofs() const { return links().n_dofs(); }
  // Returns the values of the joints at the last Update().
  const std::vector<double>& present() const;
  const SphereTable& spheres() const;

  // Returns a bit for each of up to kLanes configurations, row by row, that may be nearer to
  // something than the clearance and `more`; with `any`, the search ends at the first.
  uint32_t MayHit(std::span<const double> rows, int count, SphereJudge judge, bool any = false,
                  double more = 0);
  // Returns a bit for each that is nearer, by the engine's distances.
  uint32_t Hit(std::span<const double> rows, int count, bool any = false, double more = 0);
  // Returns the nearest pair that is too near; unset for a free configuration.
  std::optional<GeomContact> FindContact(std::span<const double> q);
  // Returns the smallest distance of what moves to everything else, and of own parts to each
  // other, over all pairs within `horizon`, by the engine.
  double Distance(std::span<const double> q, double horizon);
  // Returns "'link5' and 'table'" for messages: the bodies of a contact.
  std::string Describe(const GeomContact& contact) const;

  // Numbers of configurations that were judged by spheres, and of distances by the engine.
  struct Counts {
    int64_t configurations = 0, distances = 0;
  };
  const Counts& counts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace robocell::internal
