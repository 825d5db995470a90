// JSON texts that carry a hash of themselves: any byte that changes later is found. The hash is of
// the text with zeros in its place; the key `json_sha256` may stand at any depth, once. In
// episode.json it is in the `run` block, the only part that differs between two runs of the same
// episode.
//
//   object[kJsonHash] = kUnsigned;
//   const std::string text = SignJson(object.dump(2));
//   if (const auto damage = JsonDamage(text)) throw IoError(path + ": " + *damage);
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace robocell {

inline constexpr const char* kJsonHash = "json_sha256";
// Stands where the hash goes.
inline constexpr std::string_view kUnsigned =
    "0000000000000000000000000000000000000000000000000000000000000000";

// Puts the hash in. Error unless the text has the place for it, written as `"json_sha256":
// "000..."`.
std::string SignJson(std::string text);
// Why the text is not exactly what was signed ("its text is not ..."); nothing when it is.
std::optional<std::string> JsonDamage(const std::string& text);

}  // namespace robocell
