// NumPy's .npz files: named arrays of numbers and texts in a zip archive.
//
//   NpzArrays arrays = ReadNpz("grasps.npz");
//   const NpzArray& poses = arrays.at("transforms");       // shape {N, 4, 4}
//   WriteNpz("copy.npz", {{"transforms", NpzArray::Numbers({2, 3}, values)}});
//
// Reads what numpy.savez and numpy.savez_compressed write: numbers of any size, bools and texts, of
// either byte order and memory order. Objects, which need pickle, are rejected. Throws IoError with
// path and array for a damaged file, and for one whose arrays take more than 2 GiB in the file or in
// memory. Only the arrays that are asked for are unpacked. Any thread.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace robocell::internal {

struct NpzArray {
  static NpzArray Numbers(std::vector<size_t> shape, std::vector<double> numbers);
  static NpzArray Texts(std::vector<std::string> texts);

  std::vector<size_t> shape{};
  // One of the two, in C order.
  std::vector<double> numbers{};
  std::vector<std::string> texts{};
};

using NpzArrays = std::map<std::string, NpzArray>;

// Reads the arrays of these names that the file has; all of them if `names` is empty.
NpzArrays ReadNpz(const std::filesystem::path& path, const std::set<std::string>& names = {});
// Returns the names of a file's arrays.
std::set<std::string> NpzNames(const std::filesystem::path& path);
// Writes numbers as float64 and texts as UTF-32, like numpy, in one step: the old file or the new one.
// The same arrays give the same bytes.
void WriteNpz(const std::filesystem::path& path, const NpzArrays& arrays);

}  // namespace robocell::internal
