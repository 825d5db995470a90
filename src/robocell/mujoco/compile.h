// Converts text or file -> spec -> model, and back to files; errors become exceptions and warnings
// are kept.
//
//   SpecPtr spec = ParseXmlFile("arm.xml", "robot 'left'");
//   ModelPtr model = Compile(spec.get(), nullptr, "scene 'pick'");
//   SaveXml(spec.get(), "scene.xml", "scene 'pick'");
//   SaveBinary(model.get(), "scene.mjb", "scene 'pick'");
//
// Throws SpecError for wrong content (the engine's text names element and line), IoError for files
// that cannot be read or written, EngineError for the engine's fatal errors. `context` begins each
// message. A virtual file system given to Parse must be given to Compile too; it may be null.
//
// Every resulting model has the engine's automatic reset switched off (a diverged simulation would
// continue from the start as if nothing had happened; step.h reports divergence instead). Except
// with JacobianGuard::kOff, no model has a sparse Jacobian with a solver that is known to be wrong
// with one (engine_defects.h). Compile sets both in the spec too, so that saved files behave the
// same.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/mujoco/engine_defects.h"
#include "robocell/mujoco/forward.h"
#include "robocell/mujoco/owners.h"

namespace robocell {

SpecPtr ParseXmlFile(const std::filesystem::path& path, std::string_view context = {},
                     mjVFS* vfs = nullptr);
SpecPtr ParseXmlString(const std::string& xml, std::string_view context = {}, mjVFS* vfs = nullptr);

// Puts warnings into `warnings` if given, else into the log. The spec can be edited and compiled
// again afterwards.
ModelPtr Compile(mjSpec* spec, mjVFS* vfs = nullptr, std::string_view context = {},
                 std::vector<std::string>* warnings = nullptr,
                 JacobianGuard guard = JacobianGuard::kOn);

// Requires that the spec was compiled after its last change. Numbers are text: about six digits
// survive.
std::string SaveXmlString(const mjSpec* spec, std::string_view context = {});
void SaveXml(const mjSpec* spec, const std::filesystem::path& path, std::string_view context = {});

// Returns the engine's binary format (.mjb): exact, but only for this version of MuJoCo, and
// without a spec.
std::string SaveBinaryString(const mjModel* model);
void SaveBinary(const mjModel* model, const std::filesystem::path& path,
                std::string_view context = {});
ModelPtr LoadBinary(const std::filesystem::path& path, std::string_view context = {},
                    JacobianGuard guard = JacobianGuard::kOn);
ModelPtr LoadBinaryString(std::string_view bytes, std::string_view context = {},
                          JacobianGuard guard = JacobianGuard::kOn);

}  // namespace robocell
