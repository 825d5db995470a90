// For tests only: a packed dataset of one episode 'e', written by hand.
#pragma once

#include <filesystem>
#include <string>

#include "robocell/base/checked_json.h"
#include "robocell/base/files.h"
#include "robocell/base/hash.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {

// The shard "--{}..abc" has episode.json and steps.h5 of the episode; dataset.json is beside it.
class SamplePack {
 public:
  explicit SamplePack(const std::filesystem::path& folder) : folder_(folder) {
    AtomicWrite(folder_ / "s.zip", "--{}..abc");
    AtomicWrite(folder_ / "dataset.json", "{}");
    Write(Shards());
  }

  static std::string Shards() {
    return R"([{"file": "s.zip", "bytes": 9, "rest_sha256": ")" + Sha256("--..") +
           R"(", "files": {"e/episode.json": {"offset": 2, "bytes": 2, "sha256": ")" +
           Sha256("{}") + R"("}, "e/steps.h5": {"offset": 6, "bytes": 3, "sha256": ")" +
           Sha256("abc") + R"("}}}])";
  }

  void Write(const std::string& shards, const std::string& episodes = R"(["e"])",
             int version = 2) const {
    const std::string text =
        R"({"format": "robocell-packed", "format_version": )" + std::to_string(version) +
        R"(, "episodes": )" + episodes + R"(, "shards": )" + shards +
        R"(, "files": {"dataset.json": {"bytes": 2, "sha256": ")" + Sha256("{}") + R"("}},)" +
        "\"json_sha256\": \"" + std::string(kHashPlaceholder) + "\"}";
    AtomicWrite(folder_ / "packed.json", InsertSelfHash(text));
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace robocell::internal
