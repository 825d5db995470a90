// Private to scene: the pool, objects that come and go without compiling (SceneObject::parked).
//
// They are always in the model. What is parked stands far above everything, where no camera looks,
// without contacts, weight and velocity, so that it costs little and moves nothing.
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <string>
#include <vector>

#include "robocell/math/pose.h"
#include "robocell/scene/compiled_scene.h"

namespace robocell::internal {

// Position and quaternion wxyz, as a free joint has them.
using FreeJointPos = std::array<mjtNum, 7>;

// The place of the i-th object of a scene.
FreeJointPos ParkingPlace(size_t object);

// One object of the pool in one compiled scene. Members allocate nothing.
class PooledObject {
 public:
  // `record` is one of the model's scene, the `number`-th of its objects, and outlives this.
  PooledObject(const mjModel* m, const ObjectRecord& record, size_t number);

  const std::string& name() const { return record_->name; }
  int body() const { return bodies_.first; }
  bool parked_after_reset() const { return record_->pool->parked; }
  const mjtNum* home(const mjModel* m) const { return m->qpos0 + qpos_.first; }
  const FreeJointPos& parking_place() const { return place_; }
  // Returns true if `qpos` has it at its parking place: at that height, as a wind may have taken it
  // aside.
  bool IsParkedAt(const mjtNum* qpos) const;

  // Takes contacts and weight away, or gives back those of its file.
  void Switch(mjModel* m, bool parked) const;
  // Returns true if the model has contacts and weight as a reset leaves them, whatever `parked` is.
  bool IsAsAfterReset(const mjModel* m) const;
  // At rest, with the joints and controls that key `home` has, and the free joint at `pos`.
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

// Reads the properties of a pool object from a model that was just compiled.
PoolRecord ReadPoolRecord(const mjModel* m, const ObjectRecord& record, bool parked);

// Those of a compiled scene, as a reset leaves them.
std::vector<PooledObject> PoolOf(const CompiledScene& compiled);

// To be called after body_gravcomp was written to: the engine looks at the count first.
void CountCompensatedBodies(mjModel* m);

}  // namespace robocell::internal
