// ServedCanvas: draws in the drawing service (drawing_service.h), which it starts if nobody has. A
// service that dies is started again, and the picture drawn again: the images are the same.
//
//   if (IsServiceWanted() && ServedCanvas::CanDraw(model)) ...
//   ServedCanvas canvas(GlBackend::kAuto, style);
//   canvas.SetModel(model);
//   canvas.Paint(picture);
//
// Throws Error if the service cannot be started, what the service reports, and Error when a picture
// has ended it several times. Internal to render/.
#pragma once

#include <sys/types.h>

#include <memory>
#include <optional>
#include <string>

#include "robocell/render/drawing_protocol.h"
#include "robocell/render/gl_canvas.h"

namespace robocell::internal {

// Returns true if the environment variable ROBOCELL_GL_SERVICE is 1.
bool IsServiceWanted();

class ServedCanvas final : public GlCanvas {
 public:
  ServedCanvas(GlBackend backend, const GlStyle& style);

  // Returns false for models with skins or flexes, whose shapes change with each picture.
  static bool CanDraw(const mjModel* model);

  void SetModel(const mjModel* model) override;
  void Paint(const GlPicture& picture) override;
  const std::string& description() const override { return description_; }
  // Returns the process that draws; -1 while there is none.
  pid_t service() const { return channel_ ? channel_->peer() : -1; }

 private:
  // Repeats an action whose service has died.
  template <class Action>
  void WithService(const Action& action);
  void Connect();
  void Forget();
  void Upload();
  DrawingReply Ask(const DrawingRequest& request, int descriptor = -1);

  GlBackend backend_;
  GlStyle style_;
  std::string name_, description_;
  std::optional<DrawingChannel> channel_;
  std::unique_ptr<SharedMemory> memory_;
  const mjModel* model_ = nullptr;
  bool is_uploaded_ = false, has_memory_ = false;  // at the present service
  pid_t owner_;                                    // a fork needs a connection of its own
};

}  // namespace robocell::internal
