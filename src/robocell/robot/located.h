// Private to robot: errors of a robot's configuration say where it stands in the robot's file.
#pragma once

#include <string>

#include "robocell/base/error.h"
#include "robocell/spec/locations.h"
#include "robocell/spec/robot_config.h"

namespace robocell {

// What `f` returns. What it throws begins with the place of `field` in the file, unless it has one.
template <class F>
auto Located(const RobotConfig& config, const std::string& field, F&& f) {
  const auto place = [&](const Error& error) {
    return WithPlace(config.locations.At(field), error.what());
  };
  try {
    return f();
  } catch (const ArgumentError& error) {
    throw ArgumentError(place(error));
  } catch (const NotFoundError& error) {
    throw NotFoundError(place(error));
  }
}

}  // namespace robocell
