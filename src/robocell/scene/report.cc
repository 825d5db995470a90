#include "robocell/scene/report.h"

#include <fmt/format.h>

#include "robocell/base/error.h"

namespace robocell {

void Report::Problem(const std::string& place, const std::string& message) {
  only_missing_ = false;
  problems_.push_back({place, message});
}

void Report::Missing(const std::string& place, const std::string& message) {
  problems_.push_back({place, message});
}

void Report::Warn(const std::string& place, const std::string& message) {
  warnings_.push_back(place.empty() ? message : place + ": " + message);
}

void Report::Throw(const std::string& scene) const {
  if (ok()) return;
  std::string text;
  if (problems_.size() == 1) {
    const Entry& only = problems_[0];
    text = fmt::format("scene '{}'{}{}: {}", scene, only.place.empty() ? "" : " / ", only.place,
                       only.message);
  } else {
    text = fmt::format("scene '{}' has {} problems:", scene, problems_.size());
    for (const Entry& entry : problems_) {
      text += "\n  " + (entry.place.empty() ? "" : entry.place + ": ") + entry.message;
    }
  }
  if (only_missing_) throw NotFoundError(text);
  throw SpecError(text);
}

}  // namespace robocell
