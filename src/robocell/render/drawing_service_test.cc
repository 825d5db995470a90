#include "robocell/render/drawing_service.h"

#include <stdlib.h>
#include <unistd.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "robocell/base/error.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/owners.h"
#include "robocell/render/drawing_protocol.h"
#include "robocell/render/renderer.h"
#include "robocell/render/testing/gl_pictures.h"
#include "robocell/render/testing/soft_images.h"
#include "robocell/testing/skip.h"

namespace robocell {
namespace {

std::string OwnName() { return "robocell-test-" + std::to_string(getpid()); }

TEST(DrawingServices, EndWithoutClients) {
  EXPECT_TRUE(internal::ServeDrawings(OwnName(), {.idle_s = 0.01}));
}

TEST(DrawingServices, LeaveANameToWhoHasIt) {
  const auto owner = internal::TakeDrawingName(OwnName());
  EXPECT_FALSE(internal::ServeDrawings(OwnName(), {.idle_s = 0.01}));
}

TEST(DrawingServices, ReportWrongRequestsAndGoOn) {
  std::thread service([] { internal::ServeDrawings(OwnName(), {.idle_s = 0.2}); });
  {
    std::optional<internal::FileHandle> socket;
    while (!socket) socket = internal::ConnectToDrawingName(OwnName());
    const internal::DrawingChannel channel(std::move(*socket));
    const auto ask = [&](internal::DrawingCall call, int descriptor) {
      EXPECT_TRUE(channel.Send(internal::DrawingRequest{.call = call}, descriptor));
      const auto reply = channel.Receive<internal::DrawingReply>(60000);
      return reply ? std::string(reply->text.data()) : "no reply";
    };
    const std::string description = ask(internal::DrawingCall::kDescribe, -1);
    if (description.find("no OpenGL") == std::string::npos) {
      EXPECT_EQ(ask(internal::DrawingCall::kPaint, -1), "drawing service: no model");
      EXPECT_NE(ask(internal::DrawingCall::kUpload, -1).find("no shared memory"),
                std::string::npos);
      const internal::SharedMemory noise(1000);
      EXPECT_NE(ask(internal::DrawingCall::kUpload, noise.descriptor()).find("binary model"),
                std::string::npos);
      EXPECT_EQ(ask(internal::DrawingCall::kDescribe, -1), description);
    }
  }
  service.join();
}

// With the variable, and for what the service cannot draw, images are those of `gl`.
TEST(DrawingServices, DoNotChangeTheImagesOfARenderer) {
  constexpr char kCloth[] = R"(<mujoco><worldbody><light pos="0 0 3"/>
    <flexcomp name="cloth" type="grid" dim="2" count="4 4 1" spacing=".3 .3 .1" pos="0 0 .4" radius=".01" rgba=".8 .2 .2 1">
      <contact selfcollide="none"/></flexcomp></worldbody></mujoco>)";
  const RendererOptions options{
      .backend = "gl", .quality = {.shadows = true, .multisamples = 4, .shadow_size = 256}};
  std::unique_ptr<Renderer> own, served;
  try {
    own = MakeRenderer(options);
  } catch (const Error& error) {
    SKIP_OR_FAIL(error.what());
  }
  setenv("ROBOCELL_GL_SERVICE", "1", 1);
  served = MakeRenderer(options);
  unsetenv("ROBOCELL_GL_SERVICE");
  EXPECT_EQ(served->description(), own->description());
  for (const char* xml : {internal::kBallsAndMesh, kCloth, internal::kBallsAndMesh}) {
    const ModelPtr model = Compile(ParseXmlString(xml).get());
    const DataPtr data = MakeData(model.get());
    own->SetModel(model.get());
    served->SetModel(model.get());
    const SoftImages a = TakeOf(*own, data.get(), OrbitCamera{.lookat = {0, 0, 0.4}}),
                     b = TakeOf(*served, data.get(), OrbitCamera{.lookat = {0, 0, 0.4}});
    EXPECT_EQ(a.rgb, b.rgb);
    EXPECT_EQ(a.depth, b.depth);
    EXPECT_EQ(a.ids, b.ids);
    // Colours are those of the model at each call.
    model->geom_rgba[0] = 0.9f;
    EXPECT_EQ(TakeOf(*own, data.get(), OrbitCamera{}).rgb,
              TakeOf(*served, data.get(), OrbitCamera{}).rgb);
  }
}

}  // namespace
}  // namespace robocell
