// SipHash-2-4 with a 128-bit key and result: turns the names of random streams into seeds
// (base/rng.h). Not for files (base/hash.h).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace robocell {

// Two little-endian words, low word first.
using Hash128 = std::array<uint64_t, 2>;

// J.-P. Aumasson and D. J. Bernstein, "SipHash: a fast short-input PRF", 2012; 128-bit variant of
// the reference code (github.com/veorq/SipHash). Same result on every machine.
Hash128 SipHash128(const Hash128& key, std::string_view bytes);

}  // namespace robocell
