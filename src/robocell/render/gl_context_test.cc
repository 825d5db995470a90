#include "robocell/render/gl_context.h"

#include <stdlib.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <thread>

#include "robocell/base/error.h"
#include "robocell/testing/child_test.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/skip.h"

namespace robocell {
namespace {

using testing::HasSubstr;

class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) {
    const char* old = getenv(name);
    old_ = old ? old : "";
    setenv(name, value, 1);
  }
  ~Environment() { old_.empty() ? unsetenv(name_) : setenv(name_, old_.c_str(), 1); }

 private:
  const char* name_;
  std::string old_;
};

TEST(GlBackends, AreReadFromTheEnvironmentWithTheRobocellVariableFirst) {
  const Environment ours("ROBOCELL_GL", ""), theirs("MUJOCO_GL", "glfw");
  EXPECT_EQ(GlBackendFromEnvironment(), GlBackend::kAuto);
  const Environment osmesa("MUJOCO_GL", "osmesa");
  EXPECT_EQ(GlBackendFromEnvironment(), GlBackend::kOsmesa);
  const Environment egl("ROBOCELL_GL", "EGL");
  EXPECT_EQ(GlBackendFromEnvironment(), GlBackend::kEgl);
}

TEST(GlBackends, SuggestTheNearestName) {
  const Environment ours("ROBOCELL_GL", "osmeas");
  ExpectThrow<NotFoundError>(
      [] { GlBackendFromEnvironment(); },
      "environment variable ROBOCELL_GL: no GL back end 'osmeas'. Its GL back ends: auto, egl, "
      "osmesa. Did you mean 'osmesa'?");
}

class GlContexts : public testing::Test {
 protected:
  void SetUp() override {
    try {
      GlContext::Create();
    } catch (const Error& error) {
      SKIP_OR_FAIL(error.what());
    }
  }
};

TEST_F(GlContexts, DescribeTheRenderer) {
  const auto context = GlContext::Create();
  EXPECT_THAT(context->description(), HasSubstr(GlBackendName(context->backend())));
  EXPECT_THAT(context->description(), HasSubstr("OpenGL"));
  EXPECT_EQ(DescribeGl(), context->description());
}

TEST_F(GlContexts, RejectASecondLibraryInOneProcess) {
  const auto context = GlContext::Create();
  const bool egl = context->backend() == GlBackend::kEgl;
  ExpectThrow<Error>(
      [&] { GlContext::Create(egl ? GlBackend::kOsmesa : GlBackend::kEgl); },
      "MuJoCo can use only one OpenGL library per process. Start a new process for the other one.");
}

TEST_F(GlContexts, MoveBetweenThreadsButAreCurrentOnOne) {
  const auto context = GlContext::Create();
  { const GlContext::Current here(*context); }
  std::thread([&] { const GlContext::Current there(*context); }).join();
  const GlContext::Current here(*context);
  const GlContext::Current nested(*context);
  if (context->backend() != GlBackend::kEgl) return;  // OSMesa does not notice
  std::thread([&] {
    ExpectThrow<Error>([&] { const GlContext::Current there(*context); }, "one thread at a time");
  }).join();
}

TEST_F(GlContexts, AReturnedContextIsReused) {
  auto context = GlContext::Create();
  const GlContext* first = context.get();
  const auto other = GlContext::Create();
  EXPECT_NE(other.get(), first);
  GlContext::GiveBack(std::move(context));
  context = GlContext::Create();
  EXPECT_EQ(context.get(), first);
  std::thread([&] { const GlContext::Current there(*context); }).join();
}

TEST_F(GlContexts, AReturnedContextIsNotReusedForAnotherDevice) {
  const auto context = GlContext::Create();
  if (context->backend() != GlBackend::kEgl) SKIP_OR_FAIL("OSMesa has no devices");
  GlContext::GiveBack(GlContext::Create());
  const Environment device("ROBOCELL_EGL_DEVICE", "99");
  ExpectThrow<ArgumentError>([] { GlContext::Create(); },
                             "ROBOCELL_EGL_DEVICE=99 chooses none of the");
}

// The tests below run it again in child processes, and read its output.
TEST(DescribeGl, DescribesTheRendererOrThrows) {
  try {
    const std::string text = DescribeGl();
    EXPECT_FALSE(text.empty());
    printf("draws: %s\n", text.c_str());
  } catch (const Error& error) {
    printf("thrown: %s\n", error.what());
  }
}

bool HasNoGl(const ChildRun& run) {
  return run.output.find("thrown: no OpenGL") != std::string::npos;
}

TEST(GlContextsInChild, FallBackToOsmesaWhenEglDoesNotWork) {
  const ChildRun run =
      RunTestsInChild("DescribeGl.*", "ROBOCELL_GL= MUJOCO_GL= __EGL_VENDOR_LIBRARY_FILENAMES=/no");
  if (HasNoGl(run)) SKIP_OR_FAIL("no OSMesa (libosmesa6):\n" + run.output);
  EXPECT_THAT(run.output, HasSubstr("draws: osmesa: llvmpipe"));
}

TEST(GlContextsInChild, ReportTriedBackEndsAndPackagesToInstall) {
  const ChildRun run =
      RunTestsInChild("DescribeGl.*", "ROBOCELL_GL=egl __EGL_VENDOR_LIBRARY_FILENAMES=/no");
  EXPECT_THAT(run.output, HasSubstr("thrown: no OpenGL for off-screen rendering. Tried:\n  egl: "));
  EXPECT_THAT(
      run.output,
      HasSubstr("Install one of them (Debian, Ubuntu): apt-get install libegl1 libgl1-mesa-dri"));
}

TEST(GlContextsInChild, RejectAMissingDevice) {
  const ChildRun run =
      RunTestsInChild("DescribeGl.*", "ROBOCELL_GL= MUJOCO_GL=egl MUJOCO_EGL_DEVICE_ID=99");
  if (HasNoGl(run)) SKIP_OR_FAIL("no EGL:\n" + run.output);
  EXPECT_THAT(run.output, HasSubstr("MUJOCO_EGL_DEVICE_ID=99 chooses none of the"));
}

}  // namespace
}  // namespace robocell
