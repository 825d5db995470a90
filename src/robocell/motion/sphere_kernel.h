// Checks configurations against a SphereTable, eight at once, one in each lane of vector registers.
//
// Link by link: the link's pose, its large ball, then smaller ones only where that one hits. The
// answer for a configuration depends neither on the others nor on the instruction set.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "robocell/motion/sphere_table.h"

namespace robocell::internal {

struct DemandOfSpheres {
  float clearance = 0;      // to everything that is not the robot, m
  float own_clearance = 0;  // between parts of the robot, m
  // Share of SphereTable::Tree::shrink by which spheres shrink where the robot meets itself.
  float shrunk = 0;
};

// A pair of geoms that is nearer than demanded, as far as spheres can tell.
struct SpherePair {
  int32_t geom = -1, other = -1;
  uint32_t lanes = 0;  // bit per configuration
  bool own = false;
};

// Scratch memory of one thread.
class SphereScratch {
 public:
  struct alignas(64) Lanes {
    float at[kLanes];
  };
  void Fit(const SphereTable& table);

  std::vector<Lanes> frames;    // 12 per link
  std::vector<Lanes> balls;     // 3 per link: centre of its ball
  std::vector<Lanes> centres;   // 3 per node
  std::vector<uint32_t> known;  // per node: the group whose centres are there
  std::vector<int32_t> active;
  uint32_t group = 0;
};

// Returns a bit for each of up to kLanes configurations (row by row) that may be in collision. With
// `any` the rest is left out once one is found. The other bits are surely free.
uint32_t FindSphereHits(const SphereTable& table, const DemandOfSpheres& demand,
                        std::span<const double> q, int count, bool any, SphereScratch* scratch);
// Finds all pairs of geoms that may be nearer than demanded.
void FindSpherePairs(const SphereTable& table, const DemandOfSpheres& demand,
                     std::span<const double> q, int count, SphereScratch* scratch,
                     std::vector<SpherePair>* pairs);

// Returns the index of the point nearest to `q`, the first of equals. `points`: one column for each
// coordinate, `stride` apart: a multiple of kLanes, at least `count`.
int FindNearest(const float* points, int stride, int count, int dofs, const float* q);

}  // namespace robocell::internal
