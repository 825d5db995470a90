#include "robocell/data/column.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace robocell {

size_t SizeOf(ColumnType type) {
  switch (type) {
    case ColumnType::kFloat64:
    case ColumnType::kInt64:
      return 8;
    case ColumnType::kFloat32:
    case ColumnType::kInt32:
      return 4;
    default:
      return 1;
  }
}

std::string_view NameOf(ColumnType type) {
  switch (type) {
    case ColumnType::kFloat64:
      return "float64";
    case ColumnType::kFloat32:
      return "float32";
    case ColumnType::kInt64:
      return "int64";
    case ColumnType::kInt32:
      return "int32";
    case ColumnType::kUint8:
      return "uint8";
    default:
      return "bool";
  }
}

int64_t RowValues(const std::vector<int64_t>& shape) {
  int64_t count = 1;
  for (const int64_t size : shape) count *= size;
  return count;
}

std::string ShapeText(const std::vector<int64_t>& shape) {
  return fmt::format("({})", fmt::join(shape, ", "));
}

}  // namespace robocell
