#include "robocell/data/report_origin.h"

#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/hash.h"
#include "robocell/data/dataset.h"

namespace robocell {

using nlohmann::json;

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
