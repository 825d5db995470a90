// Private to data: whole numbers of JSON that somebody else may have written. The parser's own
// conversion takes 5e81 for an integer too, and what comes of that is undefined.
//
//   const uint64_t bytes = JsonCount<uint64_t>(facts.at("bytes"));
//
// Throws the parser's exceptions, as reading anything else does, for what is not a whole number
// from 0 to the largest Count.
#pragma once

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

namespace robocell {

template <class Count, class Json>
Count JsonCount(const Json& json) {
  const uint64_t value = json.template get_ref<const typename Json::number_unsigned_t&>();
  if (value > uint64_t{std::numeric_limits<Count>::max()})
    throw nlohmann::json::out_of_range::create(406, "number overflow", nullptr);
  return static_cast<Count>(value);
}

}  // namespace robocell
