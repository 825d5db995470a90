// Random streams named by keys: the only source of randomness for anything that ends up in data.
//
// A stream is a pure function of its keys, the same on every machine and with every standard
// library. "Episode 17, attempt 0, object pose" gives the same numbers independent of earlier
// draws, by any code in any process.
//
//   Rng rng = Rng::Stream(run_seed, "scene", scene_name, index, attempt, "object pose");
//   const double x = rng.Uniform(-0.2, 0.2);
//   Rng noise = rng.Fork("camera noise");  // does not depend on what was drawn from rng
//
// Laws: Stream(seed, a, b) equals Stream(seed, a).Fork(b). Integer keys are equal when their values
// are, for any type; 7 and "7" are different keys. Forking twice with the same key gives the
// same stream twice.
//
// Keys are hashed with SipHash-2-4-128; numbers come from xoshiro256++ (D. Blackman and S. Vigna,
// "Scrambled linear pseudorandom number generators", 2019). A Rng is a small value without
// allocation; one thread at a time may draw from it.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "robocell/base/hash.h"

namespace robocell {

template <typename T>
concept RngInteger = std::integral<T> && !std::same_as<T, bool> && !std::same_as<T, char>;

// One part of a stream's name: a whole number or a text, converted implicitly. A text must outlive
// the call that takes the key.
class RngKey {
 public:
  template <RngInteger T>
  RngKey(T value)
      : number_(static_cast<uint64_t>(value)), kind_(value < T{0} ? kNegative : kNonNegative) {}
  RngKey(std::string_view text) : text_(text), kind_(kText) {}
  RngKey(const std::string& text) : RngKey(std::string_view(text)) {}
  RngKey(const char* text) : RngKey(std::string_view(text)) {}

 private:
  friend class Rng;
  enum Kind : char { kNonNegative = 'u', kNegative = 'n', kText = 's' };

  uint64_t number_ = 0;
  std::string_view text_;
  Kind kind_;
};

class Rng {
 public:
  // Returns the stream of these keys.
  static Rng Stream(uint64_t run_seed, std::span<const RngKey> keys);
  template <std::convertible_to<RngKey>... Keys>
  static Rng Stream(uint64_t run_seed, const Keys&... keys) {
    const std::array<RngKey, sizeof...(Keys) + 1> all = {RngKey(keys)..., RngKey(0)};
    return Stream(run_seed, std::span(all.data(), sizeof...(Keys)));
  }

  // Returns the stream of this stream's keys and one more; earlier draws from this one do not
  // matter.
  Rng Fork(const RngKey& purpose) const;

  // Returns 64 random bits.
  uint64_t NextBits();
  // Returns a number in [0, 1), a multiple of 2^-53.
  double Uniform();
  // Returns a number in [low, high); low itself if they are equal. Throws ArgumentError unless low
  // <= high and both are finite.
  double Uniform(double low, double high);
  // Returns a number in {0, ..., count - 1}, without bias. Throws ArgumentError for count 0.
  uint64_t UniformInt(uint64_t count);
  // Returns a number with mean 0 and standard deviation 1.
  double Normal();
  // Returns an index drawn with probability proportional to its weight. Throws ArgumentError unless
  // weights are finite and >= 0, and at least one is > 0.
  size_t WeightedIndex(std::span<const double> weights);

  // Returns one of the elements of a container that has size() and operator[].
  template <typename Container>
  decltype(auto) Choice(Container&& items) {
    return items[UniformInt(items.size())];
  }
  // Shuffles such that all orders are equally likely (Fisher-Yates).
  template <typename Container>
  void Shuffle(Container&& items) {
    using std::swap;
    for (size_t i = items.size(); i > 1; --i) swap(items[i - 1], items[UniformInt(i)]);
  }

 private:
  explicit Rng(const Hash128& id);

  Hash128 id_;                     // hash of the keys
  std::array<uint64_t, 4> state_;  // state of xoshiro256++
};

}  // namespace robocell
