#include "robocell/base/suggestions.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <limits>
#include <tuple>
#include <utility>

namespace robocell {
namespace {

std::string Lower(std::string_view s) {
  std::string out(s);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

// Optimal string alignment distance (Levenshtein with adjacent transpositions).
int EditDistance(const std::string& a, const std::string& b) {
  const int n = static_cast<int>(a.size()), m = static_cast<int>(b.size());
  std::vector<std::vector<int>> d(n + 1, std::vector<int>(m + 1));
  for (int i = 0; i <= n; ++i) d[i][0] = i;
  for (int j = 0; j <= m; ++j) d[0][j] = j;
  for (int i = 1; i <= n; ++i) {
    for (int j = 1; j <= m; ++j) {
      d[i][j] =
          std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    }
  }
  return d[n][m];
}

// Returns true if one may be a typing error for the other: few edits, or one contained in the
// other.
bool IsNear(const std::string& wanted, const std::string& have, int distance) {
  const int longest = static_cast<int>(std::max(wanted.size(), have.size()));
  const bool nothing_in_common = distance >= longest;
  if (distance <= std::max(2, longest / 3) && !nothing_in_common) return true;
  return wanted.size() >= 3 && have.size() >= 3 &&
         (have.find(wanted) != std::string::npos || wanted.find(have) != std::string::npos);
}

// Splits "joint12" into ("joint", 12); number is -1 if there is none.
std::pair<std::string, int> SplitNumber(const std::string& name) {
  size_t digits = name.size();
  while (digits > 0 && std::isdigit(static_cast<unsigned char>(name[digits - 1]))) --digits;
  if (digits == name.size() || name.size() - digits > 6) return {name, -1};
  return {name.substr(0, digits), std::atoi(name.c_str() + digits)};
}

// Returns the difference between the numbers of names like "joint7" and "joint8"; the largest value
// for other pairs.
int NumberGap(const std::string& a, const std::string& b) {
  const auto [stem_a, number_a] = SplitNumber(a);
  const auto [stem_b, number_b] = SplitNumber(b);
  if (stem_a != stem_b || number_a < 0 || number_b < 0) return std::numeric_limits<int>::max();
  return std::abs(number_a - number_b);
}

std::string Plural(std::string_view noun) {
  // "object or body" -> "objects or bodies", "kind of object" -> "kinds of object"
  if (const size_t o = noun.find(" or "); o != std::string_view::npos)
    return Plural(noun.substr(0, o)) + " or " + Plural(noun.substr(o + 4));
  if (const size_t of = noun.find(" of "); of != std::string_view::npos)
    return Plural(noun.substr(0, of)) + std::string(noun.substr(of));
  const auto ends = [&](std::string_view end) { return noun.ends_with(end); };
  const bool vowel = noun.size() >= 2 && std::string_view("aeiou").find(noun[noun.size() - 2]) !=
                                             std::string_view::npos;
  if (ends("y") && !vowel) return std::string(noun.substr(0, noun.size() - 1)) + "ies";
  const bool hissing = ends("s") || ends("x") || ends("ch") || ends("sh");
  return std::string(noun) + (hissing ? "es" : "s");
}

bool IsNumberedRun(const std::vector<std::string>& names) {
  if (names.size() < 4) return false;
  const auto [stem, first] = SplitNumber(names.front());
  if (first < 0) return false;
  for (size_t i = 1; i < names.size(); ++i) {
    const auto [s, k] = SplitNumber(names[i]);
    if (s != stem || k != first + static_cast<int>(i)) return false;
  }
  return true;
}

}  // namespace

namespace {

struct ScoredName {
  int distance, gap;  // edits, and between the numbers at the ends
  std::string name;
};

// Returns the names that are near, the nearest first; equal ones keep their order.
std::vector<ScoredName> ScoredNames(std::string_view name,
                                    const std::vector<std::string>& candidates) {
  const std::string wanted = Lower(name);
  std::vector<ScoredName> scored;
  for (const std::string& candidate : candidates) {
    const std::string have = Lower(candidate);
    const int distance = EditDistance(wanted, have);
    if (!IsNear(wanted, have, distance)) continue;
    scored.push_back({distance, NumberGap(wanted, have), candidate});
  }
  std::stable_sort(scored.begin(), scored.end(), [](const ScoredName& a, const ScoredName& b) {
    return std::tie(a.distance, a.gap) < std::tie(b.distance, b.gap);
  });
  return scored;
}

}  // namespace

std::vector<std::string> NearestNames(std::string_view name,
                                      const std::vector<std::string>& candidates, int count) {
  std::vector<std::string> out;
  for (const ScoredName& near : ScoredNames(name, candidates)) {
    if (static_cast<int>(out.size()) == count) break;
    if (std::find(out.begin(), out.end(), near.name) == out.end()) out.push_back(near.name);
  }
  return out;
}

std::string ListNames(const std::vector<std::string>& names, int limit) {
  if (names.empty()) return "(none)";
  if (IsNumberedRun(names)) return names.front() + " ... " + names.back();
  std::string out;
  const int shown = std::min<int>(limit, static_cast<int>(names.size()));
  for (int i = 0; i < shown; ++i) out += (i ? ", " : "") + (names[i].empty() ? "''" : names[i]);
  const int more = static_cast<int>(names.size()) - shown;
  if (more > 0) out += " and " + std::to_string(more) + " more";
  return out;
}

std::string Counted(int64_t count, std::string_view noun) {
  return std::to_string(count) + " " + (count == 1 ? std::string(noun) : Plural(noun));
}

std::string DidYouMean(std::string_view name, const std::vector<std::string>& candidates) {
  const std::vector<ScoredName> near = ScoredNames(name, candidates);
  if (near.empty()) return "";
  // A slip between a name and its longer form, such as "goalz", may mean either: "goal", "goals".
  const std::string& first = near.front().name;
  for (const ScoredName& other : near) {
    const bool is_equal = other.distance == near.front().distance && other.gap == near.front().gap;
    const bool is_form = other.name.starts_with(first) || first.starts_with(other.name);
    if (is_equal && is_form && other.name != first)
      return " Did you mean '" + first + "' or '" + other.name + "'?";
  }
  return " Did you mean '" + first + "'?";
}

std::string NoSuchName(std::string_view place, std::string_view kind, std::string_view name,
                       const std::vector<std::string>& candidates) {
  std::string out;
  if (!place.empty()) out += std::string(place) + ": ";
  out += "no " + std::string(kind) + " '" + std::string(name) + "'. ";
  out += (place.empty() ? "Known " : "Its ") + Plural(kind) + ": " + ListNames(candidates) + ".";
  return out + DidYouMean(name, candidates);
}

}  // namespace robocell
