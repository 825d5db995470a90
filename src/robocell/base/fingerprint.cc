#include "robocell/base/fingerprint.h"

#include <memory>

#define XXH_INLINE_ALL
#include <xxhash.h>
#include <fmt/format.h>

#include "robocell/base/error.h"
#include "robocell/base/files.h"

namespace robocell {
namespace {

struct FreeState {
  void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
};

std::string Hex(XXH128_hash_t hash) {
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

std::string Fingerprint(std::string_view bytes) {
  return Hex(XXH3_128bits(bytes.data(), bytes.size()));
}

std::string FingerprintFile(const std::filesystem::path& path) {
  const std::unique_ptr<XXH3_state_t, FreeState> state(XXH3_createState());
  if (!state || XXH3_128bits_reset(state.get()) != XXH_OK) throw Error("XXH3: out of memory");
  ReadBlocks(path, [&](std::string_view block) {
    XXH3_128bits_update(state.get(), block.data(), block.size());
  });
  return Hex(XXH3_128bits_digest(state.get()));
}

}  // namespace robocell
