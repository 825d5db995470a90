#include "robocell/hardware/arm_port.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <string>
#include <thread>
#include <vector>

#include "robocell/base/error.h"

namespace robocell {
namespace {

struct Field {
  const char* name;
  std::vector<double> ArmLimits::*values;
};
constexpr Field kFields[] = {{"lower", &ArmLimits::lower},
                             {"upper", &ArmLimits::upper},
                             {"velocity", &ArmLimits::velocity},
                             {"acceleration", &ArmLimits::acceleration},
                             {"force", &ArmLimits::force}};

void RequireSize(const std::vector<double>& values, const char* name, size_t joints,
                 const std::string& place) {
  if (values.size() == joints) return;
  throw ArgumentError(fmt::format("{}: `{}` of its limits has {} values; the arm has {} joints",
                                  place, name, values.size(), joints));
}

}  // namespace

void RequireValid(const ArmLimits& limits, const std::vector<std::string>& joints,
                  const std::string& place) {
  for (const Field& field : kFields)
    RequireSize(limits.*field.values, field.name, joints.size(), place);
  for (size_t i = 0; i < joints.size(); ++i) {
    if (!(limits.lower[i] <= limits.upper[i])) {
      throw ArgumentError(
          fmt::format("{}: joint '{}' has the limits {} to {}; expected a lower "
                      "limit that is not above the upper one",
                      place, joints[i], limits.lower[i], limits.upper[i]));
    }
    for (const Field& field : {kFields[2], kFields[3], kFields[4]}) {
      const double value = (limits.*field.values)[i];
      if (value > 0) continue;
      throw ArgumentError(
          fmt::format("{}: the {} limit of joint '{}' is {}; expected a value "
                      "above 0",
                      place, field.name, joints[i], value));
    }
    if (!std::isfinite(limits.velocity[i]) || !std::isfinite(limits.acceleration[i])) {
      throw ArgumentError(
          fmt::format("{}: joint '{}' needs a finite velocity and acceleration "
                      "limit, got {} and {}",
                      place, joints[i], limits.velocity[i], limits.acceleration[i]));
    }
  }
}

ArmLimits Narrowed(const ArmLimits& limits, const ArmLimits& narrower,
                   const std::vector<std::string>& joints, const std::string& place) {
  ArmLimits both = limits;
  for (const Field& field : kFields) {
    const std::vector<double>& own = narrower.*field.values;
    if (own.empty()) continue;
    RequireSize(own, field.name, joints.size(), place);
    std::vector<double>& values = both.*field.values;
    RequireSize(values, field.name, joints.size(), place);
    for (size_t i = 0; i < own.size(); ++i) {
      // NaN of either stays, for RequireValid.
      const bool takes_own =
          field.values == &ArmLimits::lower ? !(own[i] <= values[i]) : !(own[i] >= values[i]);
      if (takes_own) values[i] = own[i];
    }
  }
  RequireValid(both, joints, place);
  return both;
}

double ArmPort::now() const {
  const auto since = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double>(since).count();
}

void ArmPort::WaitUntil(double time) {
  const double seconds = time - now();
  if (seconds > 0) std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

}  // namespace robocell
