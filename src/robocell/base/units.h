// Conversions at the few places where the convention is degrees: euler, fovy, free-camera angles.
#pragma once

namespace robocell::internal {

inline constexpr double kPi = 3.14159265358979323846;

constexpr double Radians(double degrees) { return degrees * (kPi / 180.0); }
constexpr double Degrees(double radians) { return radians * (180.0 / kPi); }

}  // namespace robocell::internal
