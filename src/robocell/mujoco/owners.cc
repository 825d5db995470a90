#include "robocell/mujoco/owners.h"

#include <mujoco/mujoco.h>

#include <string>

#include "robocell/base/error.h"
#include "robocell/mujoco/engine_exception.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/model_watch.h"

namespace robocell {

void SpecDeleter::operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
void ModelDeleter::operator()(mjModel* model) const {
  ModelEnds(model);
  mj_deleteModel(model);
}
void DataDeleter::operator()(mjData* data) const { mj_deleteData(data); }

void VfsDeleter::operator()(mjVFS* vfs) const {
  mj_deleteVFS(vfs);
  delete vfs;
}

SpecPtr MakeSpec() {
  SpecPtr spec(internal::Tried("making an empty model", [] { return mj_makeSpec(); }));
  if (!spec) throw EngineError("making an empty model: out of memory");
  spec->compiler.degree = 0;
  return spec;
}

SpecPtr CopySpec(const mjSpec* spec) {
  SpecPtr copy(internal::Tried("copying a model's spec", [&] { return mj_copySpec(spec); }));
  if (!copy) throw EngineError("copying a model's spec: the engine refused");
  return copy;
}

ModelPtr CopyModel(const mjModel* model) {
  ModelPtr copy(internal::Guarded("copying a model", [&] { return mj_copyModel(nullptr, model); }));
  if (!copy) throw EngineError("copying a model: out of memory");
  return copy;
}

DataPtr MakeData(const mjModel* model) {
  DataPtr data(internal::Guarded("making simulation data", [&] { return mj_makeData(model); }));
  if (!data) throw EngineError("making simulation data: out of memory");
  return data;
}

DataPtr CopyData(const mjModel* model, const mjData* data) {
  DataPtr copy(internal::Guarded("copying simulation data",
                                 [&] { return mj_copyData(nullptr, model, data); }));
  if (!copy) throw EngineError("copying simulation data: out of memory");
  return copy;
}

VfsPtr MakeVfs() {
  auto* vfs = new mjVFS;
  mj_defaultVFS(vfs);
  return VfsPtr(vfs);
}

void AddBuffer(mjVFS* vfs, std::string_view name, std::string_view content) {
  const std::string file(name);
  const int rc = internal::Tried("adding '" + file + "' to the virtual file system", [&] {
    return mj_addBufferVFS(vfs, file.c_str(), content.data(), static_cast<int>(content.size()));
  });
  if (rc == 2) throw ArgumentError("virtual file system: there is already a file '" + file + "'");
  if (rc != 0) throw EngineError("virtual file system: could not add '" + file + "'");
}

}  // namespace robocell
