#include "robocell/testing/ratio_of_times.h"

namespace robocell {

double Allowed(double optimised) {
#ifdef ROBOCELL_SLOW_BUILD
  return 30 * optimised;
#else
  return optimised;
#endif
}

}  // namespace robocell
