#include "robocell/spec/split_place.h"

#include <algorithm>
#include <cctype>

namespace robocell {
namespace {

constexpr std::string_view kEnd = ": ";

// Takes ":12" off the end; false when there is none.
bool CutNumber(std::string_view& text) {
  const size_t colon = text.rfind(':');
  if (colon == std::string_view::npos || colon + 1 == text.size()) return false;
  const std::string_view digits = text.substr(colon + 1);
  text = text.substr(0, colon);
  return std::all_of(digits.begin(), digits.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

}  // namespace

std::pair<std::string, std::string> SplitPlace(std::string_view message) {
  const size_t end = message.find(kEnd);
  std::string_view file = message.substr(0, std::min(end, message.size()));
  const std::string place(file);
  const bool found = end != std::string_view::npos && CutNumber(file) && CutNumber(file) &&
                     !file.empty() && file.find('\n') == std::string_view::npos;
  if (!found) return {"", std::string(message)};
  return {place, std::string(message.substr(end + kEnd.size()))};
}

std::string WithPlace(const std::string& place, const std::string& message) {
  if (place.empty() || !SplitPlace(message).first.empty()) return message;
  return place + ": " + message;
}

}  // namespace robocell
