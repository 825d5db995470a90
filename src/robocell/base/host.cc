#include "robocell/base/host.h"

#include <unistd.h>
#include <fmt/format.h>

#include <fstream>
#include <sstream>

namespace robocell::internal {

std::string HostName() {
  char name[256] = "";
  return gethostname(name, sizeof name - 1) == 0 ? name : "";
}

std::optional<uint64_t> ProcessStart(int64_t process) {
  constexpr int kFieldsBefore = 19;  // proc(5): "7 (name) S 1 ...", from the state on
  std::ifstream file(fmt::format("/proc/{}/stat", process));
  std::string line, field;
  std::getline(file, line);
  const size_t name = line.rfind(')');  // it may contain anything, also ") "
  if (name == std::string::npos) return std::nullopt;
  std::istringstream fields(line.substr(name + 1));
  for (int i = 0; i < kFieldsBefore; ++i) fields >> field;
  uint64_t start = 0;
  return fields >> start ? std::optional(start) : std::nullopt;
}

}  // namespace robocell::internal
