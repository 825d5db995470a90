// Text or file -> spec -> model, and back to files; everything with errors as exceptions and
// warnings kept.
//
//   SpecPtr spec = ParseXmlFile("arm.xml", "robot 'left'");
//   ModelPtr model = Compile(spec.get(), nullptr, "scene 'pick'");
//   SaveXml(spec.get(), "scene.xml", "scene 'pick'");
//   SaveBinary(model.get(), "scene.mjb", "scene 'pick'");
//
// Errors: SpecError for content that is wrong (the engine's text names element and line), IoError
// for files that cannot be read or written, EngineError for what the engine calls fatal. `context`
// begins each message. A virtual file system given to Parse must be given to Compile too; it may be
// null.
//
// Every model that comes out of here has the engine's automatic reset switched off (a diverged
// simulation would go on from the start as if nothing had happened; step.h reports divergence
// instead). Unless JacobianGuard::kOff asks for it, no model has a sparse Jacobian with a solver
// that is known to be wrong with one (engine_defects.h). Compile sets both in the spec too, so that
// saved files behave the same.
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

// Warnings go to `warnings` when given, else to the log. The spec can be edited and compiled again
// afterwards.
ModelPtr Compile(mjSpec* spec, mjVFS* vfs = nullptr, std::string_view context = {},
                 std::vector<std::string>* warnings = nullptr,
                 JacobianGuard guard = JacobianGuard::kOn);

// The spec must have been compiled since it was last changed. Numbers are text: about six digits
// survive.
std::string SaveXmlString(const mjSpec* spec, std::string_view context = {});
void SaveXml(const mjSpec* spec, const std::filesystem::path& path, std::string_view context = {});

// The engine's binary format (.mjb): exact, but only for this version of MuJoCo, and without a
// spec.
std::string SaveBinaryString(const mjModel* model);
void SaveBinary(const mjModel* model, const std::filesystem::path& path,
                std::string_view context = {});
ModelPtr LoadBinary(const std::filesystem::path& path, std::string_view context = {},
                    JacobianGuard guard = JacobianGuard::kOn);
ModelPtr LoadBinaryString(std::string_view bytes, std::string_view context = {},
                          JacobianGuard guard = JacobianGuard::kOn);

}  // namespace robocell
