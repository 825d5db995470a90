// Numbers that benchmark programs exchange, as doubles in a file, and compare. Includes nothing of
// robocell, like sides.h.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <ios>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace robocell::bench {

using Numbers = std::vector<double>;

inline Numbers ReadNumbers(const std::string& file) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) throw std::runtime_error("cannot read '" + file + "'");
  Numbers numbers(static_cast<std::size_t>(in.tellg()) / sizeof(double));
  in.seekg(0);
  in.read(reinterpret_cast<char*>(numbers.data()),
          static_cast<std::streamsize>(numbers.size() * sizeof(double)));
  return numbers;
}

inline void WriteNumbers(const std::string& file, const Numbers& numbers) {
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(numbers.data()),
            static_cast<std::streamsize>(numbers.size() * sizeof(double)));
  if (!out.flush()) throw std::runtime_error("cannot write '" + file + "'");
}

// Appends row by row.
template <typename Matrix>
void Append(const Matrix& matrix, Numbers* out) {
  for (int r = 0; r < matrix.rows(); ++r) {
    for (int c = 0; c < matrix.cols(); ++c) out->push_back(matrix(r, c));
  }
}

// Returns the difference of results that must be the same, or "".
inline std::string Difference(const Numbers& a, const Numbers& b, double tolerance) {
  double most = a.size() == b.size() ? 0 : INFINITY;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    const double apart = std::abs(a[k] - b[k]);
    most = std::isnan(apart) ? INFINITY : std::max(most, apart);
  }
  if (most < tolerance) return "";
  std::ostringstream text;
  text << "the answers differ by " << most;
  return text.str();
}

}  // namespace robocell::bench
