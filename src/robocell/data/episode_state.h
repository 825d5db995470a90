// Is this episode there? The one answer that datasets, verify and generation share.
//
// An episode is complete or absent. It is there when its folder holds episode.json, which is
// written last, before the folder gets its name. What has an episode's name and is none (a folder
// that a careless copy left half, a file) neither counts nor is overwritten: it is named, with what
// to do about it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace robocell::internal {

enum class EpisodeState {
  kAbsent,  // nothing has its name, or an empty folder that a commit replaces
  kWhole,   // it is there, and its files have their sizes
  kBroken,  // something has its name and is no whole episode
};

struct EpisodeLook {
  EpisodeState state = EpisodeState::kAbsent;
  bool success = false;      // of a whole one
  std::string problem = {};  // the reason if the episode is broken, with the folder
};

// End of messages about intact folders that have the name of an episode.
inline constexpr std::string_view kMoveAway = "move it away yourself";
// End of messages about folders that repair never touches.
inline constexpr std::string_view kLeftAlone = "repair leaves it alone, move it away yourself";

EpisodeLook LookAtEpisode(const std::filesystem::path& folder);

// Whether a folder is listed as an episode, that is, contains episode.json.
bool IsCommitted(const std::filesystem::path& folder);
// The id that an episode's description gives it, when that is not its folder's name: the folder was
// copied or renamed. Reads no more than the beginning; unset when nothing can be said.
std::optional<std::string> OtherIdIn(const std::filesystem::path& folder);
// Returns the message about a misnamed folder, which is not an episode of its dataset.
std::string MisnamedText(const std::filesystem::path& folder, const std::string& id);
// Whether a folder has an episode's name and is or was one, instead of something that a user put
// there. A folder that cannot be listed counts as one; LookAtEpisode and Verify report why.
bool IsEpisodeFolder(const std::filesystem::path& folder);

}  // namespace robocell::internal
