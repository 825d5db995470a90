// What to say when a name is missing: the nearest names, short listings, whole messages.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace robocell {

// The candidates closest to `name`, best first, at most `count`; only those that may be a likely
// slip: at most 2 edits or a third of the length (case does not count, swapped neighbours count
// once), or one name contained in the other. Among equals the nearest number comes first: joint7
// before joint1 for joint8.
std::vector<std::string> NearestNames(std::string_view name,
                                      const std::vector<std::string>& candidates, int count = 3);

// "joint1 ... joint7" for a numbered run, else "a, b, c" with at most `limit` names and "and 12
// more".
std::string ListNames(const std::vector<std::string>& names, int limit = 12);

// " Did you mean 'joint7'?" or "" when nothing is near.
std::string DidYouMean(std::string_view name, const std::vector<std::string>& candidates);

// "<place>: no <kind> '<name>'. Its <kinds>: <list>. Did you mean '<nearest>'?" Without a place the
// list is introduced by "Known <kinds>".
std::string NoSuchName(std::string_view place, std::string_view kind, std::string_view name,
                       const std::vector<std::string>& candidates);

}  // namespace robocell
