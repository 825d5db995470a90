#include "robocell/base/checked_json.h"

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <string_view>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/hash.h"

namespace robocell {
namespace {

constexpr std::string_view kKey = "\"json_sha256\": \"";

// Returns where the hash begins: after the last such key, because it is written last. npos if there
// is none.
size_t HashPosition(const std::string& text) {
  const size_t key = text.rfind(kKey);
  if (key == std::string::npos) return key;
  const size_t begin = key + kKey.size();
  return begin + kHashPlaceholder.size() <= text.size() ? begin : std::string::npos;
}

// Returns true if the text of an object ends before the object does.
bool IsCut(std::string_view text) {
  const size_t last = text.find_last_not_of(" \n");
  return last == std::string_view::npos || text[last] != '}';
}

}  // namespace

std::string InsertSelfHash(std::string text) {
  const size_t at = HashPosition(text);
  if (at == std::string::npos || text.compare(at, kHashPlaceholder.size(), kHashPlaceholder) != 0) {
    throw Error("a JSON text has no placeholder for its own hash");
  }
  text.replace(at, kHashPlaceholder.size(), Sha256(text));
  return text;
}

std::optional<std::string> JsonDamage(const std::string& text) {
  const size_t at = HashPosition(text);
  if (at == std::string::npos && IsCut(text))
    return fmt::format("it is cut short: its text ends after {} bytes, in the middle", text.size());
  if (at == std::string::npos)
    return "it carries no hash of itself: it was changed, or an early version of robocell wrote it";
  std::string unsigned_text = text;
  const std::string hash = text.substr(at, kHashPlaceholder.size());
  unsigned_text.replace(at, kHashPlaceholder.size(), kHashPlaceholder);
  if (Sha256(unsigned_text) == hash) return std::nullopt;
  return "its hash does not match its text";
}

template <class Count>
Count JsonCount(const nlohmann::ordered_json& json) {
  const uint64_t value = json.get_ref<const nlohmann::ordered_json::number_unsigned_t&>();
  if (value > uint64_t{std::numeric_limits<Count>::max()})
    throw nlohmann::json::out_of_range::create(406, "number overflow", nullptr);
  return static_cast<Count>(value);
}

template int JsonCount<int>(const nlohmann::ordered_json& json);
template int64_t JsonCount<int64_t>(const nlohmann::ordered_json& json);
template uint64_t JsonCount<uint64_t>(const nlohmann::ordered_json& json);

}  // namespace robocell
