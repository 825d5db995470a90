#include "robocell/render/served_canvas.h"

#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/render/gl_canvas.h"
#include "robocell/render/testing/gl_pictures.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/skip.h"

namespace robocell::internal {
namespace {

constexpr int kW = 64, kH = 48;

class ServedCanvases : public testing::Test {
 protected:
  void SetUp() override {
    try {
      OwnCanvas own(GlBackend::kAuto, kGlStyles[1]);
      own.SetModel(scene_.model());
      own.Paint(scene_.Picture(30, kW, kH, expected_));
    } catch (const Error& error) {
      SKIP_OR_FAIL(error.what());
    }
  }
  RawImages Take(ServedCanvas& canvas) {
    RawImages images;
    canvas.Paint(scene_.Picture(30, kW, kH, images));
    return images;
  }
  std::unique_ptr<ServedCanvas> Make() {
    auto canvas = std::make_unique<ServedCanvas>(GlBackend::kAuto, kGlStyles[1]);
    canvas->SetModel(scene_.model());
    return canvas;
  }

  ListedScene scene_;
  RawImages expected_;  // in a context of its own
};

TEST_F(ServedCanvases, DrawTheBytesOfAContextOfTheirOwn) {
  for (const GlStyle& style : kGlStyles) {
    OwnCanvas own(GlBackend::kAuto, style);
    ServedCanvas served(GlBackend::kAuto, style);
    EXPECT_EQ(served.description(), own.description());
    own.SetModel(scene_.model());
    served.SetModel(scene_.model());
    for (const auto& [width, height] : {std::pair{64, 48}, {201, 133}, {33, 17}, {64, 48}}) {
      RawImages a, b;
      own.Paint(scene_.Picture(width, width, height, a));
      served.Paint(scene_.Picture(width, width, height, b));
      EXPECT_EQ(a, b) << width << " x " << height << ", samples " << style.multisamples;
    }
  }
}

// The request of a picture has been sent when its service is killed.
TEST_F(ServedCanvases, AKilledServiceIsReplacedAndThePictureDrawnAgain) {
  const auto canvas = Make();
  EXPECT_EQ(Take(*canvas), expected_);
  std::vector<std::string> log;
  const ScopedLogSink capture([&](LogLevel, std::string_view text) { log.emplace_back(text); });
  for (int i = 0; i < 2; ++i) {
    const pid_t before = canvas->service();
    ASSERT_GT(before, 0);
    ASSERT_EQ(kill(before, SIGSTOP), 0);
    std::thread killer([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      kill(before, SIGKILL);
    });
    EXPECT_EQ(Take(*canvas), expected_);
    killer.join();
    EXPECT_NE(canvas->service(), before);
  }
  EXPECT_THAT(log, testing::Contains(testing::HasSubstr("another one draws its pictures again")));
}

TEST_F(ServedCanvases, OfSeveralThreadsShareAServiceAndDrawWhatTheyDrawAlone) {
  constexpr int kThreads = 3, kPictures = 6;
  std::vector<RawImages> alone, together(kThreads * kPictures);
  OwnCanvas own(GlBackend::kAuto, kGlStyles[0]);
  own.SetModel(scene_.model());
  for (int i = 0; i < kThreads * kPictures; ++i)
    own.Paint(scene_.Picture(17 * i, kW + i, kH, alone.emplace_back()));
  std::vector<std::thread> threads;
  std::vector<pid_t> services(kThreads);
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      ListedScene scene;
      ServedCanvas canvas(GlBackend::kAuto, kGlStyles[0]);
      canvas.SetModel(scene.model());
      for (int i = t * kPictures; i < (t + 1) * kPictures; ++i)
        canvas.Paint(scene.Picture(17 * i, kW + i, kH, together[static_cast<size_t>(i)]));
      services[static_cast<size_t>(t)] = canvas.service();
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(together, alone);
  EXPECT_THAT(services, testing::Each(services[0]));
}

TEST_F(ServedCanvases, AForkHasAConnectionOfItsOwn) {
  const auto canvas = Make();
  EXPECT_EQ(Take(*canvas), expected_);
  const pid_t child = fork();
  if (child == 0) _exit(Take(*canvas) == expected_ ? 0 : 1);
  EXPECT_EQ(Take(*canvas), expected_);
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST_F(ServedCanvases, ReportWhyTheServiceCannotDraw) {
  setenv("ROBOCELL_EGL_DEVICE", "77", 1);
  ExpectThrow<Error>([] { ServedCanvas canvas(GlBackend::kEgl, {}); },
                     "ROBOCELL_EGL_DEVICE=77 chooses none of the");
  unsetenv("ROBOCELL_EGL_DEVICE");
}

TEST(ServedModels, HaveNoShapesThatBend) {
  ListedScene rigid;
  EXPECT_TRUE(ServedCanvas::CanDraw(rigid.model()));
  ListedScene cloth(R"(<mujoco><worldbody>
    <flexcomp name="cloth" type="grid" dim="2" count="3 3 1" spacing=".1 .1 .1" radius=".01">
      <contact selfcollide="none"/></flexcomp></worldbody></mujoco>)");
  EXPECT_FALSE(ServedCanvas::CanDraw(cloth.model()));
}

}  // namespace
}  // namespace robocell::internal
