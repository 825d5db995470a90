#include "robocell/features/chosen_features.h"

#include <algorithm>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/name_pattern.h"
#include "robocell/base/suggestions.h"
#include "robocell/features/cell_features.h"
#include "robocell/features/own_features.h"

namespace robocell::internal {
namespace {

constexpr std::string_view kOwnPath = "features/";

std::string KeyOf(const std::string& name) {
  return name.starts_with(kOwnPath) ? name.substr(kOwnPath.size()) : name;
}

}  // namespace

std::vector<std::string> OwnAmong(const std::vector<std::string>& names) {
  std::vector<std::string> own;
  std::ranges::copy_if(names, std::back_inserter(own), IsOwnFeature);
  return own;
}

ChosenFeatures::ChosenFeatures(const Scene& scene, const std::vector<Robot>& robots,
                               const std::vector<std::string>& names)
    : FeatureSource(scene) {
  if (names.empty()) return;
  std::vector<std::string> objects;
  for (const ObjectRecord& object : scene.compiled()->objects()) objects.push_back(object.name);
  std::vector<std::unique_ptr<FeatureSource>> all =
      SourcesOfCell(scene, robots, objects, OwnAmong(names));
  for (const std::string& name : names) Choose(name, all);
  for (size_t i = 0; i < all.size(); ++i) {
    const bool is_read =
        std::ranges::any_of(parts_, [&](const Part& part) { return part.source == i; });
    numbers_.emplace_back(is_read ? static_cast<size_t>(all[i]->size()) : 0);
    sources_.push_back(is_read ? std::move(all[i]) : nullptr);
  }
}

void ChosenFeatures::Choose(const std::string& name,
                            const std::vector<std::unique_ptr<FeatureSource>>& all) {
  bool found = false;
  std::vector<std::string> known = OwnFeatures();
  for (size_t source = 0; source < all.size(); ++source) {
    size_t begin = 0;
    for (const Feature& feature : all[source]->features()) {
      const std::string& full = feature.column.name;
      if (KeyOf(full) == name || FitsPattern(name, full)) {
        found = true;
        AddPart(source, begin, feature);
      }
      known.push_back(KeyOf(full));
      begin += static_cast<size_t>(feature.size());
    }
  }
  if (!found) throw NotFoundError(NoSuchName("", "feature", name, known));
}

void ChosenFeatures::AddPart(size_t source, size_t begin, const Feature& feature) {
  if (std::ranges::find(keys_, KeyOf(feature.column.name)) != keys_.end()) return;
  keys_.push_back(KeyOf(feature.column.name));
  parts_.push_back({source, begin, static_cast<size_t>(feature.size())});
  Add(feature);
}

void ChosenFeatures::ReadNumbers(std::span<double> out) {
  for (size_t i = 0; i < sources_.size(); ++i) {
    if (sources_[i]) sources_[i]->Read(numbers_[i]);
  }
  for (const Part& part : parts_) {
    std::copy_n(numbers_[part.source].begin() + static_cast<std::ptrdiff_t>(part.begin), part.size,
                out.begin());
    out = out.subspan(part.size);
  }
}

}  // namespace robocell::internal
