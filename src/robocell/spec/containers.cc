#include "robocell/spec/containers.h"

#include <cctype>
#include <cstdlib>

namespace robocell {
namespace {

size_t NumberStart(std::string_view name) {
  size_t i = name.size();
  while (i > 0 && std::isdigit(static_cast<unsigned char>(name[i - 1]))) --i;
  return i;
}

}  // namespace

NameList NameList::Expand(std::string_view text) {
  const size_t dots = text.find("..");
  if (dots == std::string_view::npos) return NameList{std::string(text)};
  const std::string_view first = text.substr(0, dots), last = text.substr(dots + 2);
  const size_t a = NumberStart(first), b = NumberStart(last);
  const std::string stem(first.substr(0, a));
  const size_t digits_a = first.size() - a, digits_b = last.size() - b;
  const bool numbered = digits_a > 0 && digits_b > 0 && digits_a < 7 && digits_b < 7;
  const int from = numbered ? std::atoi(std::string(first.substr(a)).c_str()) : 0;
  const int to = numbered ? std::atoi(std::string(last.substr(b)).c_str()) : -1;
  const bool padded = digits_a > 1 && first[a] == '0';  // j08..j10
  if (!numbered || stem != last.substr(0, b) || to < from || to - from > 1000 ||
      (padded && digits_a != digits_b)) {
    throw ArgumentError("'" + std::string(text) +
                        "' is not a range of names: write it like joint1..joint7 (same stem, "
                        "rising numbers), or list the names");
  }
  NameList out;
  for (int k = from; k <= to; ++k) {
    std::string number = std::to_string(k);
    if (padded) number.insert(0, digits_a - number.size(), '0');
    out.names.push_back(stem + number);
  }
  return out;
}

}  // namespace robocell
