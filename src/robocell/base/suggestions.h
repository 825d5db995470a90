// Texts of messages: the nearest names of a missing one, short listings, counted nouns.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace robocell {

// Returns the candidates closest to `name`, best first, at most `count`; only likely typing errors:
// at most 2 edits or a third of the length (case does not count, swapped neighbours count once), or
// one name contained in the other. Among equals the nearest number comes first: joint7 before
// joint1 for joint8.
std::vector<std::string> NearestNames(std::string_view name,
                                      const std::vector<std::string>& candidates, int count = 3);

// Returns "joint1 ... joint7" for a numbered run, else "a, b, c" with at most `limit` names and
// "and 12 more".
std::string ListNames(const std::vector<std::string>& names, int limit = 12);

// Returns "1 joint", "2 joints", "0 joints"; the noun is in the singular.
std::string Counted(int64_t count, std::string_view noun);

// Returns " Did you mean 'joint7'?", or "" if no name is near.
std::string DidYouMean(std::string_view name, const std::vector<std::string>& candidates);

// Returns "<place>: no <kind> '<name>'. Its <kinds>: <list>. Did you mean '<nearest>'?". Without a
// place "Known <kinds>" introduces the list.
std::string NoSuchName(std::string_view place, std::string_view kind, std::string_view name,
                       const std::vector<std::string>& candidates);

}  // namespace robocell
