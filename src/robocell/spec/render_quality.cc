#include "robocell/spec/render_quality.h"

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"

namespace robocell {

std::vector<std::string> RenderQualities() { return {"fast", "standard", "high"}; }

RenderQuality NamedQuality(std::string_view name) {
  if (name == "fast") return {};
  if (name == "standard") return {.shadows = true, .multisamples = 4, .shadow_size = 2048};
  if (name == "high") {
    return {.shadows = true, .reflections = true, .multisamples = 8, .shadow_size = 4096};
  }
  throw NotFoundError(NoSuchName("images", "quality", name, RenderQualities()));
}

}  // namespace robocell
