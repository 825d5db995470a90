#include "robocell/testing/instruction_sets.h"

#include <gtest/gtest.h>

// The targets of lane_kernel.cc and of operational_space.cc.
#define HWY_WANT_AVX3_DL
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#include <hwy/targets.h>

namespace robocell {
namespace {

// Makes kernels use the best of these targets; 0 for all.
void Allow(int64_t targets) {
  hwy::SetSupportedTargetsForTest(targets);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace

void OnEveryInstructionSet(const std::function<void(const std::string& name)>& test) {
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    const std::string name = hwy::TargetName(target);
    SCOPED_TRACE(name);
    Allow(-target);  // and the plainer ones of higher bits, for kernels that lack it
    test(name);
    Allow(0);
  }
}

}  // namespace robocell
