#include "robocell/data/episode_state.h"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <system_error>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/io_error.h"
#include "robocell/base/packed_index.h"
#include "robocell/base/stored_file.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/episode_reader.h"
#include "robocell/data/episode_writer.h"

namespace robocell::internal {

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

// Returns the line of the id, `  "id": "s0000_e0003",`, as a JSON text.
std::string IdLine(std::string_view beginning) {
  constexpr std::string_view kKey = "\n  \"id\": ";
  const size_t at = beginning.find(kKey);
  if (at == std::string_view::npos) return "";
  const std::string_view value = beginning.substr(at + kKey.size());
  const size_t end = value.find('\n');
  if (end == std::string_view::npos) return "";
  return std::string(value.substr(0, value[end - 1] == ',' ? end - 1 : end));
}

EpisodeLook LookInside(const fs::path& folder) {
  if (!IsCommitted(folder)) return {};
  try {
    const Episode episode(folder);
    if (episode.id() != folder.filename().string())
      return Broken(MisnamedText(folder, episode.id()));
    return {.state = EpisodeState::kWhole, .success = episode.success()};
  } catch (const Error& damage) {
    return Broken(damage.what());
  }
}

}  // namespace

std::optional<std::string> OtherIdIn(const fs::path& folder) {
  std::array<char, 4096> block{};
  std::ifstream file(folder / kEpisodeFile, std::ios::binary);
  file.read(block.data(), block.size());
  const std::string line = IdLine({block.data(), static_cast<size_t>(file.gcount())});
  const auto id = nlohmann::json::parse(line, nullptr, false);
  if (!id.is_string() || id == folder.filename().string()) return std::nullopt;
  return id.get<std::string>();
}

std::string MisnamedText(const fs::path& folder, const std::string& id) {
  return fmt::format(
      "'{}' holds episode '{}': it was copied or renamed, and does not count. Remove the copy, or "
      "give the folder its name back",
      folder.string(), id);
}

bool IsCommitted(const fs::path& folder) { return CanReadStoredFile(folder / kEpisodeFile); }

bool IsEpisodeFolder(const fs::path& folder) {
  std::error_code error;
  if (const auto packed = PackedIndexOf(folder.parent_path()))
    return packed->Contains(folder.filename().string());
  return IsEpisodeId(folder.filename().string()) && fs::is_directory(folder, error) &&
         LooksLikeEpisode(folder);
}

EpisodeLook LookAtEpisode(const fs::path& folder) {
  if (PackedIndexOf(folder.parent_path())) return LookInside(folder);
  std::error_code error;
  const fs::file_status status = fs::symlink_status(folder, error);
  if (status.type() == fs::file_type::not_found) return {};
  if (error) ThrowIoError("look at", folder, error.value());
  if (!fs::is_directory(folder, error)) {
    return Broken(fmt::format("'{}' has the name of an episode but is not a folder: {}",
                              folder.string(), kLeftAlone));
  }
  if (fs::is_empty(folder, error)) return {};
  if (error)
    return Broken(fmt::format("'{}' cannot be listed: {}", folder.string(), error.message()));
  if (!IsCommitted(folder)) {
    return Broken(
        LooksLikeEpisode(folder)
            ? fmt::format("'{}' is half an episode: episode.json is missing", folder.string())
            : fmt::format("'{}' has an episode's name and contains something else: {}",
                          folder.string(), kLeftAlone));
  }
  return LookInside(folder);
}

}  // namespace robocell::internal
