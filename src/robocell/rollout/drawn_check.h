// DrawnCheck: checks that the images of a row show the state of its numbers. It compares the poses of
// objects and the joints of arms; everything else that moves comes from the same state.
//
//   const DrawnCheck check(scene, features.observed());
//   drawer.Draw(state);
//   check.Require("episode-000000", row, observed, drawer);
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "robocell/data/feature_schema.h"
#include "robocell/robot/robot.h"
#include "robocell/rollout/state_drawer.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

class DrawnCheck {
 public:
  DrawnCheck(const Scene& scene, const FeatureSchema& observed);
  // Throws Error with the row and the object or joint that differ. `drawer` has drawn the row.
  void Require(const std::string& episode, int64_t row, std::span<const double> observed,
               StateDrawer& drawer) const;

 private:
  struct Object {
    std::string name;
    int body;
    size_t at;  // among the observed numbers
  };
  struct Joint {
    std::string name;
    int address;  // in qpos
    size_t at;    // among the observed numbers
  };
  void AddJoints(const Robot& robot, const Feature& feature, size_t at);

  std::vector<Object> objects_;
  std::vector<Joint> joints_;
};

}  // namespace robocell::internal
