#include "robocell/scene/inspection/findings.h"

#include "robocell/spec/locations.h"

namespace robocell::internal {

void Findings::WarnAbout(const std::string& field, const std::string& text, std::string edit) {
  auto [source, rest] = SplitPlace(text);
  if (source.empty())
    Warn(field, field + ": " + text, std::move(edit));
  else
    WarnAt(std::move(source), std::move(rest), std::move(edit));
}

}  // namespace robocell::internal
