#include "robocell/task/held_relation.h"

#include <mujoco/mujoco.h>

#include <memory>
#include <string>

#include "robocell/mujoco/names.h"
#include "robocell/scenes/landmarks.h"
#include "robocell/scenes/relations.h"
#include "robocell/task/held.h"
#include "robocell/task/pouring.h"
#include "robocell/task/two_arm_relations.h"
#include "robocell/task/wiping.h"

namespace robocell::internal {
namespace {

class Held final : public BoundRelation {
 public:
  Held(const Scene& scene, const StatedRelation& stated)
      : scene_(scene.inner()),
        body_(ElementName(scene.model(), mjOBJ_BODY, RequireObjectOrBody(scene, stated.subject))) {}
  bool Holds() const override { return IsHeld(scene_, body_); }
  RelationSamples Sample(Rng& /*rng*/, int /*count*/) const override { return {}; }

 private:
  Scene scene_;
  std::string body_;
};

}  // namespace

void RegisterTaskRelations() {
  static const bool once = [] {
    RegisterRelation("held", {.words = "pick up the {0}",
                              .bind = [](const Scene& scene, const StatedRelation& stated) {
                                return std::make_unique<Held>(scene, stated);
                              }});
    RegisterRelation("handed_over", HandedOverRelation());
    RegisterRelation("carried", CarriedRelation());
    RegisterRelation("wiped", WipedRelation());
    RegisterRelation("poured_into", PouredIntoRelation());
    return true;
  }();
  (void)once;
}

}  // namespace robocell::internal
