#include "robocell/scenes/built_in_sources.h"

namespace robocell::internal {
namespace {

class TabletopSource final : public SceneSource {
 public:
  explicit TabletopSource(const TabletopScenes& /*fields*/) {}

  std::optional<int> size() const override { return std::nullopt; }
  SceneSpec Make(int /*index*/) override {
    return {.base = "tabletop", .add_floor = true, .add_skybox = true};
  }
};

}  // namespace

std::shared_ptr<const SceneSourceKind> MakeTabletopKind() {
  return std::make_shared<SceneSourceKindOf<TabletopScenes, TabletopSource>>();
}

}  // namespace robocell::internal
