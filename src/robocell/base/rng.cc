#include "robocell/base/rng.h"

#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "robocell/base/error.h"

namespace robocell {
namespace {

// Changing this, or anything below, changes every stream: the tests pin them.
constexpr Hash128 kRoot = {0x6c6c65636f626f72, 0x31762073676e7220};  // "robocell rngs v1"

std::array<char, 9> EncodeNumber(char kind, uint64_t number) {
  std::array<char, 9> bytes = {kind};
  for (int i = 0; i < 8; ++i) bytes[i + 1] = static_cast<char>(number >> (8 * i) & 0xff);
  return bytes;
}

Hash128 HashNumber(const Hash128& id, char kind, uint64_t number) {
  const std::array<char, 9> bytes = EncodeNumber(kind, number);
  return SipHash128(id, {bytes.data(), bytes.size()});
}

// Computes the logarithm of x > 0 from IEEE basic operations only, to about 1e-16 relative: libm's
// differs between versions and between processors with and without fused multiply-add. log m = 2
// atanh((m - 1) / (m + 1)) for m near 1.
double PortableLog(double x) {
  int exponent = 0;
  double m = std::frexp(x, &exponent);  // [0.5, 1)
  if (m < 0.70710678118654752) {
    m *= 2;
    --exponent;
  }
  const double t = (m - 1) / (m + 1), tt = t * t;
  double series = 0;
  for (int k = 23; k >= 1; k -= 2) series = series * tt + 1.0 / k;
  return exponent * 0.69314718055994531 + 2 * t * series;
}

}  // namespace

Rng::Rng(const Hash128& id) : id_(id) {
  const Hash128 a = SipHash128(id, "state 0"), b = SipHash128(id, "state 1");
  state_ = {a[0], a[1], b[0], b[1]};
  if ((a[0] | a[1] | b[0] | b[1]) == 0) state_[0] = 1;  // the one state xoshiro never leaves
}

Rng Rng::Stream(uint64_t run_seed, std::span<const RngKey> keys) {
  Rng rng(HashNumber(kRoot, 'r', run_seed));
  for (const RngKey& key : keys) rng = rng.Fork(key);
  return rng;
}

Rng Rng::Fork(const RngKey& purpose) const {
  if (purpose.kind_ != RngKey::kText) return Rng(HashNumber(id_, purpose.kind_, purpose.number_));
  // Texts are hashed under another key than numbers.
  return Rng(SipHash128(HashNumber(id_, RngKey::kText, purpose.text_.size()), purpose.text_));
}

uint64_t Rng::NextBits() {
  const uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
  const uint64_t t = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= t;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

double Rng::Uniform() { return static_cast<double>(NextBits() >> 11) * 0x1.0p-53; }

double Rng::Uniform(double low, double high) {
  if (!(low <= high) || !std::isfinite(high - low)) {
    throw ArgumentError(fmt::format("Rng::Uniform: [{}, {}) is not a finite range", low, high));
  }
  const double value = low + (high - low) * Uniform();
  return value < high ? value : low;  // rounding may reach high; the chance is below 2^-50
}

uint64_t Rng::UniformInt(uint64_t count) {
  if (count == 0) throw ArgumentError("Rng::UniformInt: cannot choose among 0 elements");
  const uint64_t unfair = (0 - count) % count;  // 2^64 mod count
  uint64_t bits = NextBits();
  while (bits < unfair) bits = NextBits();
  return bits % count;
}

// G. Marsaglia's polar method; the second number is dropped so that a stream has no hidden state.
double Rng::Normal() {
  for (;;) {
    const double u = 2 * Uniform() - 1, v = 2 * Uniform() - 1;
    const double s = u * u + v * v;
    if (s > 0 && s < 1) return u * std::sqrt(-2 * PortableLog(s) / s);
  }
}

size_t Rng::WeightedIndex(std::span<const double> weights) {
  double total = 0;
  for (size_t i = 0; i < weights.size(); ++i) {
    if (!(weights[i] >= 0)) {
      throw ArgumentError(
          fmt::format("Rng::WeightedIndex: weight {} is {}, not >= 0", i, weights[i]));
    }
    total += weights[i];
  }
  if (!(total > 0) || !std::isfinite(total)) {
    throw ArgumentError(
        fmt::format("Rng::WeightedIndex: the {} weights sum to {}", weights.size(), total));
  }
  double rest = Uniform() * total;
  size_t chosen = 0;
  for (size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) continue;
    chosen = i;
    if ((rest -= weights[i]) < 0) break;
  }
  return chosen;
}

}  // namespace robocell
