#include "robocell/data/json_count.h"

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

namespace robocell {

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
