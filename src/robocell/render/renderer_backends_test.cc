#include "robocell/render/renderer_backends.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/spec/render_quality.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/scoped_env.h"

namespace robocell::internal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

TEST(RendererBackends, AreKnownByName) {
  EXPECT_THAT(RendererBackends(), ElementsAre("gl", "soft"));
  for (const RendererBackend& backend : RendererBackendList()) {
    EXPECT_THAT(backend.purpose, testing::EndsWith("."));
  }
  EXPECT_THAT(MakeRenderer({.backend = "soft"})->description(), StartsWith("soft: "));
}

TEST(RendererBackends, AnUnknownNameErrorListsTheBackEnds) {
  ExpectThrow<NotFoundError>([] { MakeRenderer({.backend = "sofd"}); },
                             "renderer: no back end 'sofd'. Its back ends: auto, gl, soft. Did you "
                             "mean 'soft'?");
  ExpectThrow<NotFoundError>(
      [] { MakeRenderer({.backend = "filament"}); },
      "renderer: the back end 'filament', MuJoCo's physically based renderer, "
      "is not offered: in MuJoCo 4.0 the same state gives other bytes");
  const ScopedEnv chosen("ROBOCELL_RENDERER", "vulkan");
  ExpectThrow<NotFoundError>([] { MakeRenderer(); },
                             "environment variable ROBOCELL_RENDERER: no back end 'vulkan'");
}

TEST(RendererBackends, TheEnvironmentSelectsTheDefault) {
  const ScopedEnv chosen("ROBOCELL_RENDERER", "soft");
  EXPECT_THAT(MakeRenderer()->description(), StartsWith("soft: "));
}

TEST(RenderQuality, HasNames) {
  EXPECT_FALSE(NamedQuality("fast").shadows);
  EXPECT_TRUE(NamedQuality("standard").shadows);
  EXPECT_EQ(NamedQuality("standard").multisamples, 4);
  EXPECT_TRUE(NamedQuality("high").reflections);
  ExpectThrow<NotFoundError>([] { NamedQuality("fats"); },
                             "images: no quality 'fats'. Its qualities: fast, standard, high. Did "
                             "you mean 'fast'?");
}

}  // namespace
}  // namespace robocell::internal
