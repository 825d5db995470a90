#include "robocell/data/packed_verifier.h"

#include <fmt/format.h>

#include <optional>
#include <string_view>

#include "robocell/base/error.h"
#include "robocell/base/hash.h"
#include "robocell/base/real_file.h"
#include "robocell/base/stored_file.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

std::string WrongSize(uint64_t bytes, uint64_t expected) {
  if (bytes < expected)
    return fmt::format("it is cut short: {} of {} bytes are there", bytes, expected);
  return fmt::format("{} bytes, expected {}", bytes, expected);
}

// Returns the hash of the bytes that are of no episode.
std::string RestOf(const fs::path& path, const PackedShard& shard, const PackedIndex& index) {
  Sha256Stream stream;
  const auto add = [&](std::string_view block) { stream.Update(block); };
  uint64_t at = 0;
  for (const std::string& name : shard.parts) {
    const FilePart& part = index.parts.at(name);
    ReadRange(path, at, part.begin - at, add);
    at = part.begin + part.bytes;
  }
  ReadRange(path, at, shard.bytes - at, add);
  return stream.Hex();
}

std::optional<std::string> DamageOf(const fs::path& dataset, const PackedShard& shard,
                                    const PackedIndex& index) {
  const fs::path path = dataset / shard.file;
  if (WhatIsAt(path) == "nothing") return "it is missing";
  if (!CanReadFile(path)) return fmt::format("it is {}, not a file", WhatIsAt(path));
  if (const uint64_t bytes = StoredFileBytes(path); bytes != shard.bytes)
    return WrongSize(bytes, shard.bytes);
  if (RestOf(path, shard, index) != shard.rest_sha256)
    return "the zip file's own tables are damaged; its episodes are read without them";
  return std::nullopt;
}

std::optional<std::string> DamageOf(const fs::path& path, const PackedFacts& facts) {
  if (WhatIsAt(path) == "nothing") return fmt::format("it is missing: {} lists it", kPackedFile);
  if (!CanReadFile(path)) return fmt::format("it is {}, not a file", WhatIsAt(path));
  if (const uint64_t bytes = StoredFileBytes(path); bytes != facts.bytes)
    return WrongSize(bytes, facts.bytes);
  if (Sha256RealFile(path) != facts.sha256) return "its hash does not match its bytes";
  return std::nullopt;
}

}  // namespace

void VerifyPack(const fs::path& dataset, const PackedIndex& index, const PackReport& report) {
  const auto check = [&](const std::string& name, const auto& damage) {
    try {
      if (const std::optional<std::string> reason = damage()) report(name, *reason, nullptr);
    } catch (const Error& error) {
      report(name, error.what(), &error);
    }
  };
  for (const PackedShard& shard : index.shards)
    check(shard.file, [&] { return DamageOf(dataset, shard, index); });
  for (const auto& [name, part] : index.parts) {
    if (index.Contains(std::string_view(name).substr(0, name.find('/')))) continue;
    check(name, [&, &part = part]() -> std::optional<std::string> {
      Sha256Stream stream;
      ReadRange(part.shard, part.begin, part.bytes,
                [&](std::string_view block) { stream.Update(block); });
      if (stream.Hex() == part.sha256) return std::nullopt;
      return "its hash does not match its bytes";
    });
  }
  for (const auto& [name, facts] : index.files)
    check(name, [&, &name = name, &facts = facts] { return DamageOf(dataset / name, facts); });
}

}  // namespace robocell::internal
