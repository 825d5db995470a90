#include "robocell/spec/containers.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <optional>

namespace robocell {
namespace {

bool IsDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// The common parts of two names around the number in which they differ.
struct NumberedNames {
  std::string_view stem, first, last, tail;
};

// Splits at the last number of `first` that leaves the same stem and tail in both; unset if there
// is none.
std::optional<NumberedNames> SplitAtNumber(std::string_view first, std::string_view last) {
  for (size_t end = first.size(); end > 0; --end) {
    if (!IsDigit(first[end - 1])) continue;
    size_t begin = end;
    while (begin > 0 && IsDigit(first[begin - 1])) --begin;
    const std::string_view stem = first.substr(0, begin), tail = first.substr(end);
    end = begin + 1;  // end of the next number
    if (last.size() <= stem.size() + tail.size() || !last.starts_with(stem) ||
        !last.ends_with(tail)) {
      continue;
    }
    const std::string_view middle =
        last.substr(stem.size(), last.size() - stem.size() - tail.size());
    const std::string_view number = first.substr(begin, first.size() - begin - tail.size());
    if (std::all_of(middle.begin(), middle.end(), IsDigit))
      return NumberedNames{stem, number, middle, tail};
  }
  return std::nullopt;
}

}  // namespace

NameList NameList::Expand(std::string_view text) {
  const size_t dots = text.find("..");
  if (dots == std::string_view::npos) return NameList{std::string(text)};
  const auto names = SplitAtNumber(text.substr(0, dots), text.substr(dots + 2));
  const bool numbered = names && names->first.size() < 7 && names->last.size() < 7;
  const int from = numbered ? std::atoi(std::string(names->first).c_str()) : 0;
  const int to = numbered ? std::atoi(std::string(names->last).c_str()) : -1;
  const bool padded = numbered && names->first.size() > 1 && names->first[0] == '0';  // j08..j10
  if (!numbered || to < from || to - from > 1000 ||
      (padded && names->first.size() != names->last.size())) {
    throw ArgumentError("'" + std::string(text) +
                        "' is not a range of names: write it like joint1..joint7 or "
                        "arm_1_joint..arm_7_joint (rising numbers, all else the same), or list the "
                        "names");
  }
  NameList out;
  for (int k = from; k <= to; ++k) {
    std::string number = std::to_string(k);
    if (padded) number.insert(0, names->first.size() - number.size(), '0');
    out.names.push_back(std::string(names->stem) + number + std::string(names->tail));
  }
  return out;
}

}  // namespace robocell
