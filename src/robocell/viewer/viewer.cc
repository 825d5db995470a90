#include "robocell/viewer/viewer.h"

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/step_gate.h"
#include "robocell/viewer/scene_view.h"
#include "robocell/viewer/viewer_impl.h"
#include "robocell/viewer/window.h"

namespace robocell {
namespace {

constexpr const char* kGateKey = "viewer";

}  // namespace

Viewer Viewer::Open(const Scene& scene, const ViewerOptions& options) {
  return Open(scene, std::vector<Robot>(), options);
}

Viewer Viewer::Open(const Robot& robot, const ViewerOptions& options) {
  return Open(robot.scene(), {robot}, options);
}

Viewer Viewer::Open(const Scene& scene, const std::vector<Robot>& robots,
                    const ViewerOptions& options) {
  if (scene.closed()) throw ClosedError("scene '" + scene.name() + "' is closed");
  if (options.width < 64 || options.height < 64) {
    throw ArgumentError(
        fmt::format("viewer: expected a window of at least 64 x 64 pixels, got {} x {}",
                    options.width, options.height));
  }
  for (const auto& observer : scene.FindObservers(kGateKey)) {
    const auto other = std::dynamic_pointer_cast<Impl>(observer);
    if (!other) continue;
    if (other->is_running()) {
      throw Error(fmt::format(
          "scene '{}' has the viewer '{}' already; close() it first. The window of an environment "
          "does not open with `headless: true` and without render_mode='human'",
          scene.name(), other->title()));
    }
    other->Detach();  // the user closed it; the new one counts now
  }
  ViewerOptions chosen = options;
  // The episodes of whoever steps the scene do not end by a window.
  if (scene.FindObserver(internal::kEpisodesKey)) chosen.stops_scene = false;
  auto impl = std::make_shared<Impl>(scene, robots, chosen);
  Scene(scene).AddObserver(impl, kGateKey);
  return Viewer(std::move(impl));
}

Viewer::Viewer(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
Viewer::Viewer(Viewer&&) noexcept = default;
Viewer& Viewer::operator=(Viewer&&) noexcept = default;
Viewer::~Viewer() = default;

Viewer::Impl& Viewer::open() const {
  if (impl_->detached()) throw ClosedError(fmt::format("viewer '{}' is closed", impl_->title()));
  return *impl_;
}

const Scene& Viewer::scene() const { return impl_->scene(); }
const std::string& Viewer::title() const { return impl_->title(); }
bool Viewer::Step() { return impl_->Step(); }
bool Viewer::Show() { return impl_->Show(); }
bool Viewer::is_running() const { return impl_->is_running(); }
void Viewer::Close() { impl_->Detach(); }
double Viewer::realtime_factor() const { return impl_->pacing().factor(); }
void Viewer::set_realtime_factor(double factor) { impl_->pacing().set_factor(factor); }
double Viewer::measured_factor() const { return impl_->pacing().measured(); }
bool Viewer::paused() const { return impl_->paused(); }
void Viewer::set_paused(bool paused) { impl_->SetPaused(paused); }
SceneView& Viewer::view() { return open().view(); }
void Viewer::DragTcp(const Robot& robot, bool commands) { open().DragTcp(robot, commands); }

void Viewer::StartRecording(const std::string& path, int fps, VideoSize size,
                            std::string_view camera) {
  Impl& impl = open();
  impl.video().Start(impl.view(), path, fps, size, camera);
}

std::string Viewer::StopRecording() { return impl_->video().Stop(); }
size_t Viewer::scenes_held() const { return impl_->scenes_held(); }
bool Viewer::recording() const { return impl_->video().recording(); }
void Viewer::SaveScreenshot(const std::string& path) { impl_->SaveScreenshot(path); }
std::vector<uint8_t> Viewer::Pixels(int* width, int* height) {
  return impl_->Pixels(width, height);
}
void Viewer::Post(const InputEvent& event) { impl_->Post(event); }
std::pair<double, double> Viewer::PlaceOf(std::string_view section, std::string_view item) {
  return impl_->PlaceOf(section, item);
}
void Viewer::set_text(const std::string& text) { impl_->text = text; }
const std::string& Viewer::text() const { return impl_->text; }
std::vector<int> Viewer::TakeKeys() { return impl_->TakeKeys(); }
bool Viewer::panels_shown() const { return impl_->panels_shown(); }
void Viewer::SetPanelsShown(bool shown) { impl_->SetPanelsShown(shown); }
void Viewer::ShowPanels(std::string_view left, std::string_view right) {
  impl_->ShowPanels(left, right);
}

}  // namespace robocell
