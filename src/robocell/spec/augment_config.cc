#include "robocell/spec/augment_config.h"

#include <fmt/format.h>

#include <numbers>

#include "robocell/spec/validate.h"

namespace robocell {

void AugmentConfig::Validate(Problems& problems) const {
  ValidateNotEmpty(dataset, "dataset", "the dataset with the source episodes", problems);
  constexpr double kMostTranslation = 0.25, kMostRotation = std::numbers::pi / 2;
  if (translation_noise > kMostTranslation)
    problems.AddAt("translation_noise", fmt::format("is more than {:g} m", kMostTranslation));
  if (rotation_noise > kMostRotation) problems.AddAt("rotation_noise", "is more than pi/2");
}

}  // namespace robocell
