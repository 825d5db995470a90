// Grasps for two arms at once: pairs of grasps at the two ends of a wide object.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/task/grasp.h"

namespace robocell::internal {

// One grasp for each of two arms, in the order of the arms.
struct PairGrasp {
  std::array<Grasp, 2> of;
  std::array<size_t, 2> number = {};  // of each among those of its arm in all pairs
  double cost = 0;                    // lower is better
};

// Returns the pairs of grasps from above by which two arms can hold a body at its two ends, the longer
// ones of its horizontal extents; best first. Each arm has the end that is nearer to its TCP. Reach and
// surroundings play no part. Empty for a body that is too short for two hands.
std::vector<PairGrasp> PairGrasps(const Scene& scene, const std::array<Robot, 2>& arms,
                                  const std::string& body);

}  // namespace robocell::internal
