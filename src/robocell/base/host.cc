#include "robocell/base/host.h"

#include <unistd.h>

namespace robocell {

std::string HostName() {
  char name[256] = "";
  return gethostname(name, sizeof name - 1) == 0 ? name : "";
}

}  // namespace robocell
