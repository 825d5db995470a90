// Checks whether an episode exists: the one check that datasets, verify and generation share.
//
// An episode is complete or absent. It exists if its folder contains episode.json, which is written
// last, before the folder gets its name. Another entry with an episode's name (an incomplete copy
// of a folder, a file) neither counts nor is overwritten: it is reported, with what to do about it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace robocell::internal {

enum class EpisodeState {
  kAbsent,  // no entry, or an empty folder that a commit replaces
  kWhole,   // it exists, and its files have their sizes
  kBroken,  // there is an entry that is not a complete episode
};

struct EpisodeLook {
  EpisodeState state = EpisodeState::kAbsent;
  bool success = false;      // success of a complete episode
  std::string problem = {};  // the reason if the episode is broken, with the folder
};

// End of messages about intact folders that have the name of an episode.
inline constexpr std::string_view kMoveAway = "move it away yourself";
// End of messages about folders that repair never touches.
inline constexpr std::string_view kLeftAlone = "repair leaves it alone, move it away yourself";

EpisodeLook LookAtEpisode(const std::filesystem::path& folder);

// Returns true if a folder is listed as an episode, that is, contains episode.json.
bool IsCommitted(const std::filesystem::path& folder);
// Returns the id in an episode's description if it is not its folder's name: the folder was copied
// or renamed. Reads only the beginning; unset if it is unknown.
std::optional<std::string> OtherIdIn(const std::filesystem::path& folder);
// Returns the message about a misnamed folder, which is not an episode of its dataset.
std::string MisnamedText(const std::filesystem::path& folder, const std::string& id);
// Returns true if a folder has an episode's name and is or was one, rather than a user's own
// folder. A folder that cannot be listed counts as one; LookAtEpisode and Verify report why.
bool IsEpisodeFolder(const std::filesystem::path& folder);

}  // namespace robocell::internal
