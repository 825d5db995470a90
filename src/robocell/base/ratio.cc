#include "robocell/base/ratio.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "robocell/base/error.h"

namespace robocell {
namespace {

constexpr double kMostDenominator = 1e9;
constexpr double kAgreement = 1e-12;
constexpr double kWhole = 1e-6;  // accuracy of 100/3 as people write it

int64_t Times(int64_t a, int64_t b) {
  int64_t product = 0;
  if (__builtin_mul_overflow(a, b, &product))
    throw ArgumentError(fmt::format("{} times {} is too large for a ratio", a, b));
  return product;
}

}  // namespace

Ratio Ratio::inverse() const {
  if (num == 0) throw ArgumentError("a ratio of 0 has no inverse");
  return num > 0 ? Ratio{den, num} : Ratio{-den, -num};
}

std::string Ratio::Text() const {
  return den == 1 ? std::to_string(num) : fmt::format("{}/{}", num, den);
}

Ratio operator*(const Ratio& a, int64_t b) {
  const int64_t shared = std::gcd(a.den, b);
  return {Times(a.num, b / shared), a.den / shared};
}

Ratio operator/(const Ratio& a, int64_t b) {
  const int64_t shared = std::gcd(a.num, b);
  return {a.num / shared, Times(a.den, b / shared)};
}

// Uses continued fractions.
Ratio RatioOf(double value) {
  if (!(value > 0) || value > 1e15)
    throw ArgumentError(fmt::format("{:g} cannot be made a ratio of whole numbers", value));
  double rest = value;
  double num = 1, den = 0, num_before = 0, den_before = 1;
  for (int i = 0; i < 64; ++i) {
    const double whole = std::floor(rest);
    const double next_num = whole * num + num_before, next_den = whole * den + den_before;
    if (next_den > kMostDenominator || next_num > 1e18) break;
    num_before = num, den_before = den;
    num = next_num, den = next_den;
    if (std::abs(num / den - value) <= kAgreement * value || rest == whole) break;
    rest = 1 / (rest - whole);
  }
  return {static_cast<int64_t>(num), static_cast<int64_t>(den)};
}

int64_t TimesIn(double whole, double part) {
  if (!(whole > 0) || !(part > 0)) return 0;
  const double times = whole / part;
  const double rounded = std::round(times);
  if (rounded < 1 || rounded > 1e15 || std::abs(times - rounded) > kWhole * rounded) return 0;
  return static_cast<int64_t>(rounded);
}

}  // namespace robocell
