// Private to scene: the pool: objects that are added and removed without compiling
// (SceneObject::parked).
//
// They are always in the model. A parked object is far above everything, where no camera looks,
// without contacts, weight and velocity, so that it costs little and moves nothing.
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <string>
#include <vector>

#include "robocell/math/pose.h"
#include "robocell/scene/compiled_scene.h"

namespace robocell::internal {

// Position and quaternion wxyz in the layout of a free joint.
using FreeJointPos = std::array<mjtNum, 7>;

// Returns the parking place of the i-th object of a scene.
FreeJointPos ParkingPlace(size_t object);

// One object of the pool in one compiled scene. Members do not allocate.
class PooledObject {
 public:
  // `record` belongs to the model's scene, is the `number`-th of its objects, and outlives this.
  PooledObject(const mjModel* m, const ObjectRecord& record, size_t number);

  const std::string& name() const { return record_->name; }
  int body() const { return bodies_.first; }
  bool parked_after_reset() const { return record_->pool->parked; }
  const mjtNum* home(const mjModel* m) const { return m->qpos0 + qpos_.first; }
  const FreeJointPos& parking_place() const { return place_; }
  // Returns true if the object is at its parking place in `qpos`: only the height counts, as wind
  // may have moved it aside.
  bool IsParkedAt(const mjtNum* qpos) const;

  // Removes contacts and weight, or restores those of its file.
  void Switch(mjModel* m, bool parked) const;
  // Returns true if the model has the contacts and weight of a reset, for any `parked`.
  bool IsAsAfterReset(const mjModel* m) const;
  // Puts it at rest, with the joints and controls of key `home`, and the free joint at `pos`.
  void Put(const mjModel* m, mjData* d, int home_key, const mjtNum* pos) const;

  bool parked;

 private:
  struct Range {
    int first = 0, count = 0;
  };
  const ObjectRecord* record_;
  FreeJointPos place_;
  Range bodies_, geoms_, qpos_, dofs_;  // the free joint's first
  std::vector<int> actuators_;
};

// Reads the properties of a pool object from a newly compiled model.
PoolRecord ReadPoolRecord(const mjModel* m, const ObjectRecord& record, bool parked);

// Returns those of a compiled scene in the state after a reset.
std::vector<PooledObject> PoolOf(const CompiledScene& compiled);

// Call it after writing body_gravcomp: the engine looks at the count first.
void CountCompensatedBodies(mjModel* m);

}  // namespace robocell::internal
