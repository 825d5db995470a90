// Exact rates and periods: ratios of whole numbers, such as 1/480 s or 500/33 per second.
//
//   const Ratio period = RatioOf(0.1 / 48);   // {1, 480}
//   const Ratio rate = (period * 16).inverse();  // {30, 1}
//
// Ratios are in lowest terms with a positive denominator. Throws ArgumentError for results that do
// not fit into 64 bits.
#pragma once

#include <cstdint>
#include <string>

namespace robocell {

struct Ratio {
  int64_t num = 0;
  int64_t den = 1;

  double value() const { return static_cast<double>(num) / static_cast<double>(den); }
  Ratio inverse() const;  // throws ArgumentError for 0
  // Returns "30" or "500/33".
  std::string Text() const;
  bool operator==(const Ratio&) const = default;
};

Ratio operator*(const Ratio& a, int64_t b);
Ratio operator/(const Ratio& a, int64_t b);

// Returns the simplest ratio that a number stands for: within 1e-12 of it, with a denominator up to
// 1e9. 0.002 is 1/500, and the number nearest to 1/480 is 1/480. The number must be positive.
Ratio RatioOf(double value);

// Returns how often `part` fits into `whole`, if that is a whole number to six digits, like 33.3333
// for 100/3; else 0.
int64_t TimesIn(double whole, double part);

}  // namespace robocell
