// A window in memory: the off-screen buffer of a GL context.
#include "robocell/render/gl_context.h"
#include "robocell/viewer/window.h"

#include <optional>
#include <utility>

namespace robocell {
namespace {

class OffscreenWindow final : public ViewerWindow {
 public:
  OffscreenWindow(int width, int height)
      : width_(width), height_(height), context_(GlContext::Create()) {}
  ~OffscreenWindow() override { GlContext::GiveBack(std::move(context_)); }

  int width() const override { return width_; }
  int height() const override { return height_; }
  bool offscreen() const override { return true; }
  std::vector<InputEvent> Poll() override { return std::exchange(posted_, {}); }
  void Show() override {}
  void SetTitle(const std::string& title) override { static_cast<void>(title); }

 private:
  void Enter() override { current_.emplace(*context_); }
  void Leave() noexcept override { current_.reset(); }

  int width_, height_;
  std::unique_ptr<GlContext> context_;
  std::optional<GlContext::Current> current_;
};

}  // namespace

std::unique_ptr<ViewerWindow> OpenOffscreenWindow(int width, int height) {
  return std::make_unique<OffscreenWindow>(width, height);
}

}  // namespace robocell
