#include "robocell/render/drawing_service.h"

#include <poll.h>
#include <sys/socket.h>
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/hash.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/owners.h"
#include "robocell/render/drawing_protocol.h"
#include "robocell/render/egl_devices.h"
#include "robocell/render/gl_context.h"
#include "robocell/render/gl_painter.h"
#include "robocell/render/pixel_buffer.h"

namespace robocell {

// The program's main function, which it declares itself: the library shows no name of
// robocell::internal.
int DrawingServiceMain(int argc, char** argv);

namespace internal {
namespace {

// A model on the card, shared by all clients that have it in the same style.
struct Upload {
  ModelPtr model;
  std::unique_ptr<GlPainter> painter;
};

struct Client {
  explicit Client(FileHandle socket) : channel(std::move(socket)) {}

  DrawingChannel channel;
  std::shared_ptr<Upload> upload = {};
  std::unique_ptr<SharedMemory> memory = {};
  ReceivedPicture received = {};
  std::unique_ptr<PixelBuffer> pixels = {};
  bool has_gone = false;
};

class Service {
 public:
  Service(FileHandle listener, const DrawingServiceOptions& options)
      : listener_(std::move(listener)), options_(options) {}
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  void Run() {
    const auto idle_ms = static_cast<int>(1000 * options_.idle_s);
    while (Wait(clients_.empty() ? idle_ms : -1)) {
      Paint(Receive());
      clients_.remove_if([](const Client& client) { return client.has_gone; });
    }
  }

 private:
  struct Job {
    Client* client;
    GlPicture picture;
  };

  // Returns false if nothing came in time.
  bool Wait(int timeout_ms) {
    polled_.assign(1, {*listener_, POLLIN, 0});
    for (const Client& client : clients_) polled_.push_back({client.channel.socket(), POLLIN, 0});
    const int ready = poll(polled_.data(), polled_.size(), timeout_ms);
    if (ready <= 0) return ready < 0;
    if (polled_[0].revents != 0) Accept();
    return true;
  }

  void Accept() {
    FileHandle socket(accept4(*listener_, nullptr, nullptr, SOCK_CLOEXEC));
    if (!socket) return;
    Client& client = clients_.emplace_back(std::move(socket));
    client.has_gone = client.channel.peer() < 0;
  }

  // Answers all requests that have come, but for pictures, which it returns.
  std::vector<Job> Receive() {
    std::vector<Job> jobs;
    size_t at = 0;
    for (Client& client : clients_) {
      if (++at >= polled_.size() || polled_[at].revents == 0) continue;  // accepted just now
      FileHandle came;
      const auto request = client.channel.Receive<DrawingRequest>(0, &came);
      if (!request) {
        client.has_gone = true;
        continue;
      }
      Answer(client, [&] { return Do(client, *request, std::move(came), &jobs); });
    }
    return jobs;
  }

  // Sends what `action` returns, or why it failed. It may leave the answer to later. Returns false
  // if it failed.
  template <class Action>
  static bool Answer(Client& client, const Action& action) {
    std::optional<DrawingReply> reply;
    try {
      if (const std::optional<std::string> text = action()) reply = DrawingReply::Of(true, *text);
    } catch (const std::exception& error) {
      reply = DrawingReply::Of(false, error.what());
    }
    if (reply && !client.channel.Send(*reply)) client.has_gone = true;
    return !reply || reply->ok != 0;
  }

  std::optional<std::string> Do(Client& client, const DrawingRequest& request, FileHandle came,
                                std::vector<Job>* jobs) {
    const GlContext& context = Context();
    switch (request.call) {
      case DrawingCall::kDescribe:
        return context.description();
      case DrawingCall::kUpload:
        client.upload.reset();
        client.upload = UploadOf(request, std::move(came));
        return "";
      case DrawingCall::kPaint:
        if (came) client.memory = std::make_unique<SharedMemory>(std::move(came));
        if (!client.upload || !client.memory) throw ArgumentError("drawing service: no model");
        jobs->push_back({&client, client.received.Get(client.memory->bytes())});
        return std::nullopt;
    }
    throw ArgumentError("drawing service: no such request");
  }

  GlContext& Context() {
    if (!context_) {
      context_ = GlContext::Create(GlBackendFromName(options_.gl, "drawing service"));
      current_.emplace(*context_);
    }
    return *context_;
  }

  std::shared_ptr<Upload> UploadOf(const DrawingRequest& request, FileHandle came) {
    const SharedMemory memory(std::move(came));
    const std::string_view bytes(reinterpret_cast<const char*>(memory.bytes().data()),
                                 memory.bytes().size());
    const std::string key = fmt::format("{} {} {} {}", Sha256(bytes), request.multisamples,
                                        request.shadow_size, request.things);
    std::erase_if(uploads_, [](const auto& entry) { return entry.second.expired(); });
    if (std::shared_ptr<Upload> known = uploads_[key].lock()) return known;
    auto made = std::make_shared<Upload>();
    made->model = LoadBinaryString(bytes, "drawing service");
    made->painter =
        std::make_unique<GlPainter>(made->model.get(), GlStyle{.multisamples = request.multisamples,
                                                               .shadow_size = request.shadow_size,
                                                               .things = request.things != 0});
    uploads_[key] = made;
    return made;
  }

  // The card draws all pictures before the images of the first one are copied.
  void Paint(const std::vector<Job>& jobs) {
    std::vector<const Job*> begun;
    for (const Job& job : jobs) {
      Client& client = *job.client;
      const bool is_begun = Answer(client, [&]() -> std::optional<std::string> {
        if (!client.pixels) client.pixels = std::make_unique<PixelBuffer>(Context());
        client.upload->painter->Begin(job.picture, *client.pixels);
        return std::nullopt;
      });
      if (is_begun) begun.push_back(&job);
    }
    for (const Job* job : begun) {
      Answer(*job->client, [&]() -> std::optional<std::string> {
        GlPainter::Finish(job->picture, *job->client->pixels);
        return "";
      });
    }
  }

  FileHandle listener_;
  DrawingServiceOptions options_;
  // Current from its beginning to the end: changing contexts costs time on a card.
  std::unique_ptr<GlContext> context_;
  std::optional<GlContext::Current> current_;
  std::map<std::string, std::weak_ptr<Upload>> uploads_;
  std::list<Client> clients_;  // ends while the context is current
  std::vector<pollfd> polled_;
};

}  // namespace

bool ServeDrawings(const std::string& name, const DrawingServiceOptions& options) {
  std::optional<FileHandle> listener = TakeDrawingName(name);
  if (!listener) return false;
  Service(std::move(*listener), options).Run();
  return true;
}

}  // namespace internal

int DrawingServiceMain(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    std::fputs("usage: robocell_drawing_service NAME [auto|egl|osmesa]\n", stderr);
    return 2;
  }
  try {
    return internal::ServeDrawings(argv[1], {.gl = argc > 2 ? argv[2] : "auto"}) ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "robocell_drawing_service: %s\n", error.what());
    return 1;
  }
}

}  // namespace robocell
