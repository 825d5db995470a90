// JSON that other programs may have changed or written: texts that contain their own hash, so that
// any byte that changes later is found, and whole numbers within the range of their type. The hash
// is computed with zeros in its place; the key `json_sha256` stands once, at any depth. In
// episode.json it is in the `run` block, the only part that differs between two runs of the same
// episode.
//
//   object[kJsonHash] = kHashPlaceholder;
//   const std::string text = InsertSelfHash(object.dump(2));
//   if (const auto damage = JsonDamage(text)) throw IoError(path + ": " + *damage);
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <nlohmann/json_fwd.hpp>

namespace robocell {

inline constexpr const char* kJsonHash = "json_sha256";
// The text that the hash will replace.
inline constexpr std::string_view kHashPlaceholder =
    "0000000000000000000000000000000000000000000000000000000000000000";

// Replaces the placeholder by the hash. Throws Error unless the text has the placeholder, written
// as `"json_sha256": "000..."`.
std::string InsertSelfHash(std::string text);
// Returns why the text does not match its hash ("its text is not ..."), or nothing when it does.
std::optional<std::string> JsonDamage(const std::string& text);

// Returns a whole number from 0 to the largest Count (int, int64_t or uint64_t). The parser's own
// conversion also accepts 5e81 as an integer, with an undefined result.
//
//   const uint64_t bytes = JsonCount<uint64_t>(facts.at("bytes"));
//
// Throws the parser's exceptions, like any other reading, for a value that is not such a number.
template <class Count>
Count JsonCount(const nlohmann::ordered_json& json);

}  // namespace robocell
