#include "robocell/base/packed_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <iterator>
#include <system_error>
#include <utility>
#include <nlohmann/json.hpp>

#include "robocell/base/checked_json.h"
#include "robocell/base/error.h"
#include "robocell/base/idle_pool.h"
#include "robocell/base/io_error.h"
#include "robocell/base/paths.h"
#include "robocell/base/real_file.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;  // one that keeps the order finds a key among n in n steps

constexpr const char* kFormat = "robocell-packed";
constexpr int kVersion = 2;
constexpr uint64_t kMostIndexBytes = uint64_t{1} << 30;

struct KnownIndex {
  std::string identity;  // of packed.json
  std::shared_ptr<const PackedIndex> index;
};

IdlePool<KnownIndex>& KnownIndices() {
  static IdlePool<KnownIndex> pool(16);
  return pool;
}

// Unlike the parser's own conversion, throws its exceptions for -3 and 5e81.
uint64_t CountIn(const Json& json) { return json.get_ref<const Json::number_unsigned_t&>(); }

// Returns true for "models/rc7/rc7.xml": a path that stays in the folder and is not hidden in it.
bool IsInside(std::string_view name) {
  if (name.starts_with('.')) return false;
  while (true) {
    const size_t slash = name.find('/');
    const std::string_view part = name.substr(0, slash);
    if (!ValidFileName(part)) return false;
    if (slash == std::string_view::npos) return true;
    name.remove_prefix(slash + 1);
  }
}

class Parser {
 public:
  explicit Parser(const fs::path& folder) : folder_(folder), file_(folder / kPackedFile) {}

  PackedIndex Parse(const std::string& text) {
    if (const auto damage = JsonDamage(text)) ThrowDamaged(*damage);
    try {
      const Json json = Json::parse(text);
      if (json.at("format") != kFormat || json.at("format_version") != kVersion) {
        throw IoError(
            fmt::format("'{}' is not of format version {}, which this robocell reads. Unpack it "
                        "with the version that packed it",
                        file_.string(), kVersion));
      }
      Read(json);
    } catch (const nlohmann::json::exception& error) {
      ThrowDamaged("its hash is right, but it does not describe a packed dataset");
    }
    return std::move(index_);
  }

 private:
  [[noreturn]] void ThrowDamaged(const std::string& reason) const {
    throw IoError(
        fmt::format("'{}' is damaged: {}. Copy the packed dataset again; the shards beside it are "
                    "zip files of its episodes",
                    file_.string(), reason));
  }

  [[noreturn]] void ThrowOutside(const std::string& name, const PackedShard& shard) const {
    ThrowDamaged(fmt::format("the bytes of '{}' are not in '{}'", name, shard.file));
  }

  const std::string& Inside(const std::string& name) const {
    if (IsInside(name)) return name;
    throw IoError(
        fmt::format("'{}' names '{}', which is not inside a dataset", file_.string(), name));
  }

  void Read(const Json& json) {
    index_.episodes = json.at("episodes").get<std::vector<std::string>>();
    std::ranges::sort(index_.episodes);
    for (const Json& shard : json.at("shards")) ReadShard(shard);
    for (const auto& [name, facts] : json.at("files").items())
      index_.files[Inside(name)] = {CountIn(facts.at("bytes")), facts.at("sha256")};
    for (const std::string& id : index_.episodes) {
      if (!index_.parts.contains(id + "/episode.json"))
        ThrowDamaged(fmt::format("it lists no episode.json of episode '{}'", id));
    }
  }

  void ReadShard(const Json& json) {
    PackedShard shard{.file = json.at("file"),
                      .bytes = CountIn(json.at("bytes")),
                      .rest_sha256 = json.at("rest_sha256"),
                      .parts = {}};
    const fs::path place = folder_ / Inside(shard.file);
    for (const auto& [name, facts] : json.at("files").items()) {
      const FilePart part{.shard = place,
                          .begin = CountIn(facts.at("offset")),
                          .bytes = CountIn(facts.at("bytes")),
                          .sha256 = facts.at("sha256")};
      if (part.begin > shard.bytes || part.bytes > shard.bytes - part.begin)
        ThrowOutside(name, shard);
      if (!index_.parts.emplace(Inside(name), part).second)
        ThrowDamaged(fmt::format("it lists '{}' twice", name));
      shard.parts.push_back(name);
    }
    std::ranges::sort(shard.parts, {}, [&](const std::string& name) {
      const FilePart& part = index_.parts.at(name);
      return std::pair(part.begin, part.bytes);
    });
    uint64_t end = 0;
    for (const std::string& name : shard.parts) {
      const FilePart& part = index_.parts.at(name);
      if (part.begin < end) ThrowOutside(name, shard);
      end = part.begin + part.bytes;
    }
    index_.shards.push_back(std::move(shard));
  }

  fs::path folder_, file_;
  PackedIndex index_;
};

}  // namespace

bool PackedIndex::Contains(std::string_view episode) const {
  return std::ranges::binary_search(episodes, episode);
}

std::vector<std::string> PackedIndex::FilesOf(std::string_view episode) const {
  const std::string prefix = std::string(episode) + "/";
  std::vector<std::string> names;
  for (auto it = parts.lower_bound(prefix); it != parts.end() && it->first.starts_with(prefix);
       ++it) {
    names.push_back(it->first.substr(prefix.size()));
  }
  return names;
}

bool IsPacked(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / kPackedFile, ignored);
}

std::shared_ptr<const PackedIndex> PackedIndexOf(const fs::path& folder) {
  if (!IsPacked(folder)) return nullptr;
  const fs::path file = folder / kPackedFile;
  std::string identity = FileIdentity(file);
  const auto same = [&](const KnownIndex& known) { return known.identity == identity; };
  if (const auto known = KnownIndices().Copy(same)) return known->index;
  const std::string text = ReadRealFile(file, kMostIndexBytes);
  auto index = std::make_shared<const PackedIndex>(Parser(folder).Parse(text));
  if (const auto known = KnownIndices().Copy(same)) return known->index;  // of another thread
  KnownIndices().Give(KnownIndex{std::move(identity), index});
  return index;
}

std::shared_ptr<const PackedIndex> IndexAround(const fs::path& file) {
  return PackedIndexOf(file.parent_path().parent_path());
}

void RequireNotPacked(const fs::path& folder, std::string_view action) {
  if (!IsPacked(folder)) return;
  throw ArgumentError(
      fmt::format("cannot {} in '{}': it is a packed dataset, which is only read. `robocell unpack "
                  "{} OUT` makes the dataset again in OUT, which can be changed",
                  action, folder.string(), ShellWord(folder.string())));
}

}  // namespace robocell::internal
