#include "robocell/data/changed_models.h"

#include <optional>
#include <set>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/data/dataset.h"
#include "robocell/data/model_store.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

using SumsByName = std::map<std::string, std::set<std::string>>;

// "table.xml" of "room/table.xml (2)", as run_inputs.cc numbers files of one name.
std::string OwnName(const std::string& file) {
  const std::string name = fs::path(file).filename().string();
  const size_t number = name.rfind(" (");
  return number != std::string::npos && name.ends_with(')') ? name.substr(0, number) : name;
}

SumsByName SumsOfRun(const fs::path& dataset) {
  SumsByName sums;
  try {
    const auto manifest = ReadManifest(dataset);
    if (!manifest) return sums;
    const auto files = nlohmann::json::parse(*manifest).value("files", nlohmann::json::object());
    for (const auto& [name, sum] : files.items())
      sums[OwnName(name)].insert(sum.get<std::string>());
  } catch (const Error&) {  // told by itself
  } catch (const nlohmann::json::exception&) {
    return {};  // of another making
  }
  return sums;
}

// The first file that the run had otherwise.
std::optional<std::string> ChangedFile(const FileSums& model, const SumsByName& run) {
  for (const auto& [name, sum] : model) {
    const auto it = run.find(fs::path(name).filename().string());
    if (it != run.end() && !it->second.contains(sum)) return name;
  }
  return std::nullopt;
}

}  // namespace

std::map<std::string, std::string> ChangedModels(const fs::path& dataset) {
  std::map<std::string, std::string> changed;
  const SumsByName run = SumsOfRun(dataset);
  if (run.empty()) return changed;
  std::vector<std::string> folders;
  try {
    folders = StoredModels(dataset);
  } catch (const Error&) {  // told by itself
  }
  for (const std::string& folder : folders) {
    try {
      if (auto file = ChangedFile(SumsOfStoredModel(dataset, folder), run))
        changed[folder] = std::move(*file);
    } catch (const Error&) {  // damage is told by itself
    }
  }
  return changed;
}

bool IsModelOfRun(const fs::path& dataset, const std::string& path) {
  const SumsByName run = SumsOfRun(dataset);
  if (run.empty() || !IsStored(dataset, path)) return false;
  try {
    return !ChangedFile(SumsOfStoredModel(dataset, path), run);
  } catch (const Error&) {
    return false;
  }
}

}  // namespace robocell
