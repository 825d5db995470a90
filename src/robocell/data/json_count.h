// Private to data: whole numbers of JSON that somebody else may have written. The parser's own
// conversion takes 5e81 for an integer too, and what comes of that is undefined.
//
//   const uint64_t bytes = JsonCount<uint64_t>(facts.at("bytes"));
//
// Throws the parser's exceptions, as reading anything else does, for what is not a whole number
// from 0 to the largest Count.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace robocell {

// `Count` is int, int64_t or uint64_t.
template <class Count>
Count JsonCount(const nlohmann::ordered_json& json);

}  // namespace robocell
