// Fuzzes the YAML reader with any bytes: it returns a spec or an Error, and can write a spec and
// read it again. The first byte selects the kind of spec.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "robocell/base/error.h"
#include "robocell/spec/robot_config.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/scene_spec.h"
#include "robocell/spec/yaml.h"

namespace {

template <class T>
void Read(std::string_view text) {
  std::string written;
  try {
    written = robocell::ToYaml(robocell::ParseYaml<T>(text));
  } catch (const robocell::Error&) {
    return;  // a rejection is fine
  }
  if (robocell::ToYaml(robocell::ParseYaml<T>(written)) != written) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  switch (data[0] % 3) {
    case 0:
      Read<robocell::RobotConfig>(text);
      break;
    case 1:
      Read<robocell::RunConfig>(text);
      break;
    default:
      Read<robocell::SceneSpec>(text);
  }
  return 0;
}
