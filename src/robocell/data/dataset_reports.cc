#include "robocell/data/dataset_reports.h"

#include <algorithm>
#include <set>
#include <string_view>
#include <nlohmann/json.hpp>

#include "robocell/base/checked_json.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/hash.h"
#include "robocell/base/packed_index.h"
#include "robocell/base/real_file.h"
#include "robocell/data/dataset.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/episode_state.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Ignores a report that is damaged or belongs to another run: Verify reports it separately.
void AddSuccesses(const fs::path& dataset, const std::string& name, std::set<std::string>& ids) {
  try {
    const std::string text = internal::ReadRealFile(dataset / name);
    if (JsonDamage(text) || OtherRunOf(text, dataset)) return;
    const json account = json::parse(text);
    for (const json& episode : account.at("episodes")) {
      if (episode.at("success") == true) ids.insert(episode.at("id").get<std::string>());
    }
  } catch (const IoError&) {
  } catch (const json::exception&) {
  }
}

// Returns true for the id itself, one of its attempts that are kept side by side
// ("s0003_e0001_a02"), or either with the number that the quarantine gives to a second one (".1").
bool IsOf(std::string_view id, std::string_view name) {
  if (!name.starts_with(id)) return false;
  name.remove_prefix(id.size());
  return name.empty() || name.front() == '.' || name.starts_with("_a");
}

// Failed attempts are kept beside a success.
bool MayBeASuccess(const fs::path& episode) {
  const internal::EpisodeLook look = internal::LookAtEpisode(episode);
  return look.success || look.state == internal::EpisodeState::kBroken;
}

// Returns true if one of an id's names, among sorted ones, fits.
template <class Fits>
bool AnyOf(const std::vector<std::string>& names, const std::string& id, const Fits& fits) {
  auto it = std::lower_bound(names.begin(), names.end(), id);
  for (; it != names.end() && it->starts_with(id); ++it) {
    if (IsOf(id, *it) && fits(*it)) return true;
  }
  return false;
}

class Present {
 public:
  explicit Present(const fs::path& dataset) : dataset_(dataset), names_(FolderNames(dataset)) {
    if (const auto packed = internal::PackedIndexOf(dataset)) names_ = packed->episodes;
    if (fs::is_directory(fs::symlink_status(dataset / kQuarantineFolder)))
      aside_ = FolderNames(dataset / kQuarantineFolder);
  }

  bool Has(const std::string& id) const {
    return AnyOf(aside_, id, [](const std::string&) { return true; }) ||
           AnyOf(names_, id,
                 [&](const std::string& name) { return MayBeASuccess(dataset_ / name); });
  }

 private:
  const fs::path& dataset_;
  std::vector<std::string> names_, aside_;
};

}  // namespace

std::vector<std::string> LostEpisodes(const fs::path& dataset) {
  std::set<std::string> reported;
  for (const std::string& name : FolderNames(dataset)) {
    if (IsReportFile(name)) AddSuccesses(dataset, name, reported);
  }
  const Present present(dataset);
  std::erase_if(reported, [&](const std::string& id) { return present.Has(id); });
  return {reported.begin(), reported.end()};
}

std::optional<std::vector<int>> HousesOfReports(const fs::path& dataset) {
  std::optional<std::vector<int>> latest;
  std::string latest_end;  // UTC, ISO 8601: the order of texts is that of times
  for (const std::string& name : FolderNames(dataset)) {
    if (!IsReportFile(name)) continue;
    try {
      const std::string text = internal::ReadRealFile(dataset / name);
      if (JsonDamage(text)) continue;
      const json report = json::parse(text);
      const json& commands = report.at("commands");
      if (!report.contains("houses") || report.at("houses").is_null() || commands.empty()) continue;
      const auto end = commands.back().at("finished").get<std::string>();
      if (latest && end <= latest_end) continue;
      std::vector<int> houses;
      for (const json& house : report.at("houses")) houses.push_back(house.get<int>());
      latest = std::move(houses);
      latest_end = end;
    } catch (const IoError&) {
    } catch (const json::exception&) {
    }
  }
  return latest;
}

std::optional<std::string> OtherRunOf(const std::string& report,
                                      const std::filesystem::path& dataset) try {
  const std::optional<std::string> manifest = ReadManifest(dataset);
  if (!manifest) return std::nullopt;
  const json account = json::parse(report), own = json::parse(*manifest);
  if (!account.contains("identity") || !own.contains("identity")) return std::nullopt;
  if (account.at("identity") == Sha256(own.at("identity").get<std::string>())) return std::nullopt;
  const auto run = account.find("run");
  return run != account.end() && run->is_string() ? run->get<std::string>() : "";
} catch (const IoError&) {
  return std::nullopt;
} catch (const json::exception&) {
  return std::nullopt;
}

}  // namespace robocell
