// The drawing service: one process draws with OpenGL for all processes of a user on one graphics
// card. A card that several processes draw on spends its time on changing between them.
//
// The program robocell_drawing_service, beside librobocell, calls it (src/programs). A renderer with back
// end `gl` starts it when it needs one (served_canvas.h). Each client sends its list of visible
// elements in shared memory and gets raw images back in it. Lists that wait are drawn one after the
// other before the first image is copied. Models are uploaded once, however many clients have them.
// An image depends on its list alone: not on other clients, their order, or what was drawn before.
#pragma once

#include <string>

namespace robocell::internal {

struct DrawingServiceOptions {
  std::string gl = "auto";  // auto, egl, osmesa
  double idle_s = 10;       // it ends after this time without a client
};

// Serves under a name (DrawingServiceName in drawing_protocol.h) until no client has been there for
// a while. Returns false if another process has the name. Throws IoError for a system without
// sockets or shared memory; what fails while drawing is reported to the client.
bool ServeDrawings(const std::string& name, const DrawingServiceOptions& options = {});

}  // namespace robocell::internal
