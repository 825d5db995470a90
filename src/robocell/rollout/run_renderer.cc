#include "robocell/rollout/run_renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <thread>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/data/dataset.h"
#include "robocell/data/episode_reader.h"
#include "robocell/render/renderer_backends.h"

namespace robocell::internal {
namespace {

using Json = nlohmann::json;

constexpr const char* kOpen = "auto";

// Returns the name in "soft: AVX2"; "" for another text.
std::string NameIn(const std::string& description) {
  const size_t colon = description.find(": ");
  return colon == std::string::npos ? "" : description.substr(0, colon);
}

// Returns the back end of the first episode that has images; "" if none has.
std::string BackendOfEpisodes(const std::filesystem::path& dataset) {
  try {
    for (const Episode& episode : Dataset(dataset)) {
      const Json metadata = Json::parse(episode.metadata_json());
      if (metadata.contains("renderer")) return NameIn(metadata.at("renderer").get<std::string>());
    }
  } catch (const Error&) {  // no dataset yet; `verify` reports a damaged one
  } catch (const Json::exception&) {
  }
  return "";
}

// Returns a text in the manifest; "" if it has none of that name.
std::string Stored(const RunConfig& run, const char* name) {
  if (run.output.empty()) return "";
  const std::optional<std::string> manifest = ReadManifest(run.output);
  if (!manifest) return "";
  const Json json = Json::parse(*manifest, nullptr, false);
  if (!json.is_object() || !json.contains(name) || !json[name].is_string()) return "";
  return json[name].get<std::string>();
}

}  // namespace

std::string BackendOf(const RunConfig& run) {
  const std::string& backend = run.cameras.renderer.backend;
  if (backend != kOpen) return backend;
  const std::string stored = Stored(run, "renderer");
  return stored.empty() ? backend : stored;
}

std::string BackendToBeginWith(const RunConfig& run) {
  if (run.cameras.drawn().empty()) return "";
  const std::string& backend = run.cameras.renderer.backend;
  if (backend != kOpen) return backend;
  const std::string drawn = BackendOfEpisodes(run.output);
  return drawn.empty() ? RendererBackendHere() : drawn;
}

RenderWhen RenderOf(const RunConfig& run) {
  if (run.render) return *run.render;
  return Stored(run, "render") == ToString(RenderWhen::kKept) ? RenderWhen::kKept
                                                              : RenderWhen::kAlways;
}

std::unique_ptr<Renderer> MakeRendererOf(const RunConfig& run, const Visibility& visibility) {
  const std::string backend = BackendOf(run);
  try {
    return MakeRenderer(
        {.backend = backend, .quality = run.cameras.renderer.quality, .visibility = visibility});
  } catch (const Error& error) {
    if (backend == run.cameras.renderer.backend) throw;
    throw Error(
        fmt::format("run '{}': the images of the dataset '{}' are drawn with '{}', which does not "
                    "work here: {}\nGo on where it works, or give another `output` to start a new "
                    "dataset",
                    run.run, run.output, backend, error.what()));
  }
}

int DrawingThreads(const RunConfig& run, const Renderer& renderer, int cores) {
  constexpr int kMost = 3;
  if (NameIn(renderer.description()) != "soft") return 1;
  if (cores == 0) cores = static_cast<int>(std::thread::hardware_concurrency());
  return std::clamp(cores / std::max(run.workers, 1), 1, kMost);
}

}  // namespace robocell::internal
