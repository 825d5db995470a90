#include "robocell/datagen/prepare.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/io_error.h"
#include "robocell/base/version.h"
#include "robocell/data/dataset.h"
#include "robocell/datagen/plan.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostLines = 30;

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::string Manifest(const RunConfig& run) {
  return nlohmann::json{{"format", "robocell-dataset"},
                        {"run", run.run},
                        {"seed", run.seed},
                        {"task", ToString(run.task.kind)},
                        {"identity", RunIdentity(run)},
                        {"versions", {{"robocell", Version()}, {"mujoco", mj_versionString()}}}}
             .dump(2) +
         "\n";
}

void CreateFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) ThrowIoError("create the dataset's folder", folder, error.value());
  // Whether it can be written shows only when one tries.
  fs::remove(MakeTempDirectory(folder, "probe"), error);
}

// Anything that was not left behind by an interrupted write.
std::string FirstEntry(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (!IsTemporaryName(name)) names.push_back(name);
  }
  if (error) ThrowIoError("list the dataset's folder", folder, error.value());
  return names.empty() ? "" : *std::min_element(names.begin(), names.end());
}

void RequireSameRun(const RunConfig& run, const std::string& manifest) {
  const nlohmann::json json = nlohmann::json::parse(manifest);
  const auto found = json.find("identity");
  const std::string before =
      found != json.end() && found->is_string() ? found->get<std::string>() : "";
  const std::string now = RunIdentity(run);
  if (before == now) return;
  std::vector<std::string> lines = DifferingLines(before, now);
  if (lines.size() > kMostLines) {
    const size_t more = lines.size() - kMostLines;
    lines.resize(kMostLines);
    lines.push_back(fmt::format("... and {} lines more", more));
  }
  throw SpecError(fmt::format(
      "run '{}': the dataset '{}' was begun with another configuration (- then, + now):\n  {}\n"
      "Change these back to go on with it, or give another `output` to start a new dataset",
      run.run, run.output, fmt::join(lines, "\n  ")));
}

}  // namespace

std::vector<std::string> DifferingLines(const std::string& old_text, const std::string& new_text) {
  const std::vector<std::string> a = Lines(old_text), b = Lines(new_text);
  // length[i][j]: of the longest common subsequence of a from i and b from j.
  std::vector<std::vector<int>> length(a.size() + 1, std::vector<int>(b.size() + 1, 0));
  for (size_t i = a.size(); i-- > 0;) {
    for (size_t j = b.size(); j-- > 0;) {
      length[i][j] =
          a[i] == b[j] ? length[i + 1][j + 1] + 1 : std::max(length[i + 1][j], length[i][j + 1]);
    }
  }
  std::vector<std::string> lines;
  size_t i = 0, j = 0;
  while (i < a.size() || j < b.size()) {
    if (i < a.size() && j < b.size() && a[i] == b[j]) {
      ++i, ++j;
    } else if (j == b.size() || (i < a.size() && length[i + 1][j] >= length[i][j + 1])) {
      lines.push_back("- " + a[i++]);
    } else {
      lines.push_back("+ " + b[j++]);
    }
  }
  return lines;
}

void PrepareDataset(const RunConfig& run) {
  if (run.output.empty()) {
    throw SpecError("run '" + run.run +
                    "': output: where should the dataset go? Give the folder, for example "
                    "`output: experiment_output/" +
                    run.run + "`");
  }
  const fs::path folder = run.output;
  CreateFolder(folder);
  if (const std::optional<std::string> manifest = ReadManifest(folder))
    return RequireSameRun(run, *manifest);
  if (const std::string entry = FirstEntry(folder); !entry.empty() && !ReadManifest(folder)) {
    throw SpecError(fmt::format(
        "run '{}': output: the folder '{}' holds '{}' and is no dataset; give a new folder",
        run.run, run.output, entry));
  }
  WriteManifest(folder, Manifest(run));
}

}  // namespace robocell
