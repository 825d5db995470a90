// Loaded before a program (LD_PRELOAD): kernels then use no wider registers than AVX2's, whatever
// the processor has.
#include <hwy/targets.h>

namespace {

// Highway gives better instruction sets lower bits.
[[gnu::constructor]] void AllowNothingWider() { hwy::DisableTargets(HWY_AVX2 - 1); }

}  // namespace
