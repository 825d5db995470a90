// Records in files: NumPy's .npy, as numpy.lib.format describes it.
#include <fmt/format.h>

#include <cstdint>
#include <cstring>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/env/env_record.h"
#include "robocell/env/number_list.h"

namespace robocell {
namespace {

constexpr std::string_view kMagic("\x93NUMPY\x01\x00", 8);  // with the format's version
constexpr size_t kAligned = 64;                             // bytes; where the numbers begin

std::string NpyBytes(std::span<const double> row) {
  std::string header =
      fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({},), }}", row.size());
  const size_t before = kMagic.size() + sizeof(uint16_t);
  header.resize((before + header.size() + kAligned) / kAligned * kAligned - before, ' ');
  header.back() = '\n';
  const auto length = static_cast<uint16_t>(header.size());
  std::string bytes(kMagic);
  bytes += {static_cast<char>(length & 0xff), static_cast<char>(length >> 8)};
  bytes += header;
  bytes.append(reinterpret_cast<const char*>(row.data()), row.size_bytes());
  return bytes;
}

// The numbers of a file that NpyBytes or NumPy wrote.
std::vector<double> NpyRow(std::string_view bytes) {
  const auto require = [](bool good) {
    if (!good) throw ArgumentError("it is no .npy with one row of float64");
  };
  const size_t before = kMagic.size() + sizeof(uint16_t);
  require(bytes.size() > before && bytes.starts_with(kMagic));
  const auto length = static_cast<size_t>(static_cast<uint8_t>(bytes[kMagic.size()])) +
                      256 * static_cast<size_t>(static_cast<uint8_t>(bytes[kMagic.size() + 1]));
  require(bytes.size() >= before + length);
  const std::string_view header = bytes.substr(before, length),
                         body = bytes.substr(before + length);
  std::vector<double> row(body.size() / sizeof(double));
  require(header.find("'<f8'") != std::string_view::npos);
  require(header.find(fmt::format("({},)", row.size())) != std::string_view::npos);
  require(body.size() == row.size() * sizeof(double));
  std::memcpy(row.data(), body.data(), body.size());
  return row;
}

EnvRecord FromRow(std::span<const double> row) {
  NumberReader reader(row, "record of an environment");
  EnvRecord record;
  record.start = EnvState::FromNumbers(reader.List());
  record.actions = reader.List();
  record.observations = reader.List();
  record.rewards = reader.List();
  reader.RequireEnd();
  return record;
}

}  // namespace

void EnvRecord::Save(const std::string& file) const {
  std::vector<double> row;
  PutList(start.numbers(), row);
  for (const std::vector<double>* list : {&actions, &observations, &rewards}) PutList(*list, row);
  AtomicWrite(file, NpyBytes(row));
}

EnvRecord EnvRecord::Load(const std::string& file) {
  const std::string bytes = ReadFile(file);
  try {
    return FromRow(NpyRow(bytes));
  } catch (const ArgumentError& error) {
    throw IoError(fmt::format("'{}' is no record of an environment: {}", file, error.what()));
  }
}

}  // namespace robocell
