#include "robocell/spec/action_noise_config.h"

#include <numbers>

namespace robocell {

void ActionNoiseConfig::Validate(Problems& problems) const {
  constexpr double kMost = std::numbers::pi / 2;
  if (rotation > kMost) problems.AddAt("rotation", "is more than pi/2");
  if (start_rotation > kMost) problems.AddAt("start_rotation", "is more than pi/2");
}

}  // namespace robocell
