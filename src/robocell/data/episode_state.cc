#include "robocell/data/episode_state.h"

#include <fmt/format.h>

#include <system_error>

#include "robocell/base/error.h"
#include "robocell/base/io_error.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/episode_reader.h"
#include "robocell/data/episode_writer.h"

namespace robocell {

namespace fs = std::filesystem;

namespace {

EpisodeLook Broken(std::string problem) {
  return {.state = EpisodeState::kBroken, .problem = std::move(problem)};
}

bool LooksLikeEpisode(const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const fs::path name = it->path().filename();
    if (name == kEpisodeFile || name == kStepsFile || name.extension() == ".mp4") return true;
  }
  return static_cast<bool>(error);  // one bad folder must not hide the others
}

}  // namespace

bool IsCommitted(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / kEpisodeFile, ignored);
}

bool IsEpisodeFolder(const fs::path& folder) {
  std::error_code error;
  return IsEpisodeId(folder.filename().string()) && fs::is_directory(folder, error) &&
         LooksLikeEpisode(folder);
}

EpisodeLook LookAtEpisode(const fs::path& folder) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(folder, error);
  if (status.type() == fs::file_type::not_found) return {};
  if (error) ThrowIoError("look at", folder, error.value());
  constexpr const char* kMoveAway = "repair leaves it alone, move it away yourself";
  if (!fs::is_directory(folder, error)) {
    return Broken(
        fmt::format("'{}' has an episode's name and is no folder: {}", folder.string(), kMoveAway));
  }
  if (fs::is_empty(folder, error)) return {};
  if (error)
    return Broken(fmt::format("'{}' cannot be listed: {}", folder.string(), error.message()));
  if (!IsCommitted(folder)) {
    return Broken(
        LooksLikeEpisode(folder)
            ? fmt::format("'{}' is half an episode: episode.json is missing", folder.string())
            : fmt::format("'{}' has an episode's name and holds other things: {}", folder.string(),
                          kMoveAway));
  }
  try {
    return {.state = EpisodeState::kWhole, .success = Episode(folder).success()};
  } catch (const Error& damage) {
    return Broken(damage.what());
  }
}

}  // namespace robocell
