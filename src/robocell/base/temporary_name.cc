#include "robocell/base/temporary_name.h"

#include <fmt/format.h>

#include <charconv>

namespace robocell::internal {
namespace {

constexpr size_t kLongest = 180;  // part of the 255 bytes of a name

// Removes ".<number>" from the end.
template <class T>
bool TakeNumber(std::string_view& text, T& value) {
  const size_t dot = text.rfind('.');
  if (dot == std::string_view::npos) return false;
  const std::string_view digits = text.substr(dot + 1);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  text = text.substr(0, dot);
  return error == std::errc() && end == digits.data() + digits.size();
}

}  // namespace

std::string TemporaryName::Text() const {
  return fmt::format(".{}.{}.{}{}", name.substr(0, kLongest), process, number, kSuffix);
}

std::optional<TemporaryName> TemporaryName::Parse(std::string_view file_name) {
  if (!file_name.starts_with('.') || !file_name.ends_with(kSuffix)) return std::nullopt;
  std::string_view rest = file_name.substr(1, file_name.size() - 1 - kSuffix.size());
  TemporaryName parsed;
  if (!TakeNumber(rest, parsed.number) || !TakeNumber(rest, parsed.process)) return std::nullopt;
  parsed.name = rest;
  return parsed;
}

}  // namespace robocell::internal
