#include "robocell/spec/action_noise_config.h"

#include <fmt/format.h>

#include <numbers>

namespace robocell {
namespace {

constexpr double kMostNoiseMetres = 0.25, kMostStartMetres = 1;

}  // namespace

void ActionNoiseConfig::Validate(Problems& problems) const {
  constexpr double kMost = std::numbers::pi / 2;
  if (rotation > kMost) problems.AddAt("rotation", "is more than pi/2");
  if (start_rotation > kMost) problems.AddAt("start_rotation", "is more than pi/2");
  // Farther away than an arm can be moved from its path; lengths in millimetres are found, too.
  if (translation > kMostNoiseMetres)
    problems.AddAt("translation", fmt::format("is more than {:g} m", kMostNoiseMetres));
  if (start_translation > kMostStartMetres)
    problems.AddAt("start_translation", fmt::format("is more than {:g} m", kMostStartMetres));
}

}  // namespace robocell
