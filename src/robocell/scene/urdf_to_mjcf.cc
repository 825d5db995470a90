#include "robocell/scene/urdf_to_mjcf.h"

#include <mujoco/mujoco.h>

#include "robocell/assets/urdf.h"
#include "robocell/mujoco/compile.h"
#include "robocell/scene/spec_tree.h"
#include "robocell/scene/urdf_model.h"

namespace robocell {

std::string UrdfToMjcf(const std::filesystem::path& file, const std::filesystem::path& folder,
                       std::vector<std::string>* notes) {
  const internal::Urdf urdf = internal::ReadUrdf(file);
  const SpecPtr spec = internal::MakeUrdfSpec(urdf);
  const std::vector<std::string> servos = internal::AddUrdfServos(urdf, spec.get());
  if (notes) {
    notes->insert(notes->end(), urdf.notes.begin(), urdf.notes.end());
    notes->insert(notes->end(), servos.begin(), servos.end());
  }
  const std::filesystem::path from = std::filesystem::absolute(folder).lexically_normal();
  for (mjsElement* element : internal::SpecElements(spec.get(), mjOBJ_MESH)) {
    mjsMesh* mesh = mjs_asMesh(element);
    const std::filesystem::path path = mjs_getString(mesh->file);
    mjs_setString(mesh->file, path.lexically_relative(from).c_str());
  }
  mjs_setString(spec->modelfiledir, from.c_str());
  // Scenes do the same: Euler's method takes the damping of servos explicitly and may diverge.
  if (urdf.mujoco.find("<option") == std::string::npos)
    spec->option.integrator = mjINT_IMPLICITFAST;
  Compile(spec.get(), nullptr, urdf.file.string());
  return SaveXmlString(spec.get(), urdf.file.string());
}

}  // namespace robocell
