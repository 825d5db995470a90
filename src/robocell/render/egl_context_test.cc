#include <stdlib.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <thread>

#include "robocell/base/error.h"
#include "robocell/render/gl_backends.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/skip.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class EglContextTest : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      context_ = CreateEglContext();
    } catch (const Error& error) {
      SKIP_OR_FAIL(error.what());
    }
  }
  std::unique_ptr<GlContext> context_;
};

TEST_F(EglContextTest, DescribesItsRenderer) {
  EXPECT_EQ(context_->backend(), GlBackend::kEgl);
  EXPECT_THAT(context_->description(), StartsWith("egl: "));
  EXPECT_THAT(context_->description(), HasSubstr(", OpenGL "));
}

TEST_F(EglContextTest, ContextsAreTheirOwn) {
  const auto other = CreateEglContext();
  const GlContext::Current here(*context_);
  std::thread([&] { const GlContext::Current there(*other); }).join();
}

// A scope makes the previous context current again: another thread still cannot take the outer
// context, and can take the inner one.
TEST_F(EglContextTest, AScopeRestoresTheContextBeforeIt) {
  const auto inner = CreateEglContext();
  const GlContext::Current outside(*context_);
  { const GlContext::Current inside(*inner); }
  std::thread([&] {
    const GlContext::Current there(*inner);
    ExpectThrow<Error>([&] { const GlContext::Current taken(*context_); },
                       "eglMakeCurrent failed: EGL_BAD_ACCESS");
  }).join();
}

TEST_F(EglContextTest, ADeviceThatIsNotThereIsAnErrorWithTheDevices) {
  setenv("ROBOCELL_EGL_DEVICE", "99", 1);
  std::string message;
  try {
    CreateEglContext();
  } catch (const Error& error) {
    message = error.what();
  }
  unsetenv("ROBOCELL_EGL_DEVICE");
  EXPECT_THAT(message, HasSubstr("99"));
}

}  // namespace
}  // namespace robocell::internal
