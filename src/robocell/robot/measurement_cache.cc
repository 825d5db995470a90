#include "robocell/robot/measurement_cache.h"

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "robocell/base/hash.h"
#include "robocell/mujoco/compile.h"

namespace robocell::internal {
namespace {

// Keyed by generation, which no two models of a process share: the oldest entry goes first.
using MeasurementName = std::pair<uint64_t, std::string>;
constexpr size_t kMostMeasurements = 1024;

struct Measurement {
  std::weak_ptr<const CompiledScene> model;
  std::vector<double> values;
};

struct Measurements {
  std::mutex mutex;
  std::map<MeasurementName, Measurement> kept;
};

Measurements& AllMeasurements() {
  static Measurements measurements;
  return measurements;
}

std::optional<std::vector<double>> KeptMeasurement(const MeasurementName& name) {
  Measurements& all = AllMeasurements();
  const std::lock_guard lock(all.mutex);
  const auto found = all.kept.find(name);
  if (found == all.kept.end()) return std::nullopt;
  return found->second.values;
}

}  // namespace

std::vector<double> CachedMeasurement(const std::shared_ptr<const CompiledScene>& compiled,
                                      const std::string& what,
                                      const std::function<std::vector<double>()>& measure) {
  if (!compiled->frozen()) return measure();
  const MeasurementName name(compiled->generation(), what);
  if (std::optional<std::vector<double>> kept = KeptMeasurement(name)) return *std::move(kept);
  std::vector<double> measured = measure();
  Measurements& all = AllMeasurements();
  const std::lock_guard lock(all.mutex);
  // Small blocks that are never used again would keep the memory of models around them.
  std::erase_if(all.kept, [](const auto& entry) { return entry.second.model.expired(); });
  all.kept[name] = {compiled, measured};
  if (all.kept.size() > kMostMeasurements) all.kept.erase(all.kept.begin());
  return measured;
}

std::vector<double> MeasurementOfEqualModels(const mjModel* model, const std::string& what,
                                             const std::function<MeasuredValues()>& measure) {
  static std::mutex mutex;
  static std::map<std::string, std::vector<double>> kept;
  const std::string key = Fingerprint(SaveBinaryString(model)) + " " + what;
  {
    const std::lock_guard lock(mutex);
    if (const auto found = kept.find(key); found != kept.end()) return found->second;
  }
  MeasuredValues measured = measure();
  if (!measured.is_kept) return std::move(measured.values);
  const std::lock_guard lock(mutex);
  if (kept.size() >= kMostMeasurements) kept.erase(kept.begin());
  return kept[key] = std::move(measured.values);
}

size_t MeasurementCount() {
  Measurements& all = AllMeasurements();
  const std::lock_guard lock(all.mutex);
  return all.kept.size();
}

}  // namespace robocell::internal
