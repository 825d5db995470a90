// Owners of the engine's objects, and the guarded calls that create them.
//
// Each owner deletes its object. A DataPtr must not outlive the model of its data. A virtual file
// system is kept on the heap because the engine remembers its address: the owner may be moved, the
// object must not.
//
//   SpecPtr spec = MakeSpec();
//   ModelPtr model = Compile(spec.get(), nullptr, "my scene");   // mujoco/compile.h
//   DataPtr data = MakeData(model.get());
//
// The Make and Copy functions throw EngineError with the engine's text. Threads: every object has
// one user at a time, except a const mjModel, which any number of threads may read.
#pragma once

#include <memory>
#include <string_view>

#include "robocell/mujoco/forward.h"

namespace robocell {

struct SpecDeleter {
  void operator()(mjSpec* spec) const;
};
struct ModelDeleter {
  void operator()(mjModel* model) const;
};
struct DataDeleter {
  void operator()(mjData* data) const;
};
struct VfsDeleter {
  void operator()(mjVFS* vfs) const;
};

using SpecPtr = std::unique_ptr<mjSpec, SpecDeleter>;
using ModelPtr = std::unique_ptr<mjModel, ModelDeleter>;
using DataPtr = std::unique_ptr<mjData, DataDeleter>;
using VfsPtr = std::unique_ptr<mjVFS, VfsDeleter>;

// Returns an empty spec whose angles are radians (the engine's own default is degrees).
SpecPtr MakeSpec();
SpecPtr CopySpec(const mjSpec* spec);
ModelPtr CopyModel(const mjModel* model);
// Returns data in the model's reference configuration.
DataPtr MakeData(const mjModel* model);
DataPtr CopyData(const mjModel* model, const mjData* data);
VfsPtr MakeVfs();
// Adds a file held in memory. Throws ArgumentError for a name that is already used.
void AddBuffer(mjVFS* vfs, std::string_view name, std::string_view content);

}  // namespace robocell
