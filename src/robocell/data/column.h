// A column: one named quantity with a value in every row of an episode's table.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace robocell {

enum class ColumnType { kFloat64, kFloat32, kInt64, kInt32, kUint8, kBool };

// Describes a column for readers of the file. The file stores the name as the path of the array,
// the rest as its attributes.
struct ColumnSpec {
  std::string name;  // a path such as "robots/xarm7/arm/qpos"; unique in the episode
  ColumnType type = ColumnType::kFloat64;
  std::vector<int64_t>
      shape;          // shape of one row; {} is a single number, {4, 4} a matrix in row-major order
  std::string units;  // "rad", "m", "1"; "m, 1" for positions with quaternions
  std::string frame;  // frame of the values: "world", "base of xarm7"
  std::vector<std::string>
      names;  // names of the components along the last axis: joint names, "x" "y" "z"
  std::vector<std::string> values;  // names of the integer values 0, 1, ... (phases)
  std::string description;          // one sentence, if the name does not explain it
};

size_t SizeOf(ColumnType type);            // bytes of one value
std::string_view NameOf(ColumnType type);  // numpy's: "float64", "bool"

// Returns the number of values in one row.
int64_t RowValues(const std::vector<int64_t>& shape);
// Formats "(7)", "(4, 4)", "()".
std::string ShapeText(const std::vector<int64_t>& shape);

// The column type that holds a C++ type.
template <typename T>
constexpr ColumnType ColumnTypeOf() {
  if constexpr (std::is_same_v<T, double>) return ColumnType::kFloat64;
  if constexpr (std::is_same_v<T, float>) return ColumnType::kFloat32;
  if constexpr (std::is_same_v<T, int64_t>) return ColumnType::kInt64;
  if constexpr (std::is_same_v<T, int32_t>) return ColumnType::kInt32;
  if constexpr (std::is_same_v<T, uint8_t>) return ColumnType::kUint8;
  if constexpr (std::is_same_v<T, bool>) return ColumnType::kBool;
}

}  // namespace robocell
