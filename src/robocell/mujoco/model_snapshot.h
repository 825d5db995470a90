// ModelSnapshots: a model's values as they were at an instant, for whoever reads them later or on
// another thread while the owner of the model goes on changing colours, sizes or lights.
//
//   ModelSnapshots snapshots(model);
//   std::shared_ptr<const ModelSnapshot> now = snapshots.Take();
//   model->geom_rgba[0] = 1;
//   now->model();   // a model with the old colour
//
// A snapshot that equals the last one is the same object, and costs a comparison: microseconds for
// a robot cell. Assets (meshes, height fields, textures) and names are not copied: they are those
// of the model itself, which must live as long as its snapshots. Take reads the model like any
// other call on the thread that owns it; snapshots may be read on any thread.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "robocell/mujoco/forward.h"

namespace robocell::internal {

class ModelSnapshot {
 public:
  explicit ModelSnapshot(const mjModel* model);
  ~ModelSnapshot();
  ModelSnapshot(const ModelSnapshot&) = delete;
  ModelSnapshot& operator=(const ModelSnapshot&) = delete;

  const mjModel& model() const { return *model_; }
  // Whether `model`, of which this was taken, still has these values.
  bool IsOf(const mjModel* model) const;

 private:
  std::unique_ptr<mjModel> model_;   // with pointers into values_
  std::unique_ptr<mjModel> origin_;  // the structure as it was
  std::vector<std::byte> values_;
};

class ModelSnapshots {
 public:
  explicit ModelSnapshots(const mjModel* model) : model_(model) {}
  std::shared_ptr<const ModelSnapshot> Take();

 private:
  const mjModel* model_;
  std::shared_ptr<const ModelSnapshot> last_;
};

}  // namespace robocell::internal
