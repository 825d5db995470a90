#include "robocell/mujoco/version.h"

#include <mujoco/mujoco.h>

#include "robocell/base/error.h"

namespace robocell {
namespace version_internal {

std::string VersionText(int version) {
  return std::to_string(version / 1000000) + "." + std::to_string(version / 1000 % 1000) + "." +
         std::to_string(version % 1000);
}

void RequireVersions(int compiled, int loaded) {
  if (compiled == loaded) return;
  const std::string want = VersionText(compiled);
  throw Error("robocell was built for MuJoCo " + want + " but MuJoCo " + VersionText(loaded) +
              " is loaded. Install the right one (pip install mujoco==" + want +
              ") or build robocell against the one you have.");
}

}  // namespace version_internal

void RequireEngineVersion() { version_internal::RequireVersions(mjVERSION_HEADER, mj_version()); }

std::string CompiledEngineVersion() { return version_internal::VersionText(mjVERSION_HEADER); }

std::string LoadedEngineVersion() { return version_internal::VersionText(mj_version()); }

}  // namespace robocell
