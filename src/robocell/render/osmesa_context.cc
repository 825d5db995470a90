#include "robocell/render/gl_backends.h"

#include <string>
#include <vector>

#include "robocell/base/error.h"

namespace robocell::internal {
namespace {

constexpr unsigned kRgba = 0x1908, kUnsignedByte = 0x1401;
constexpr unsigned kGlRenderer = 0x1F01, kGlVersion = 0x1F02;
// The context's own frame buffer, which is never used: MuJoCo draws into frame buffer objects.
constexpr int kSide = 16;

struct Osmesa {
  GlLibrary library{"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"};
  void* (*CreateContext)(unsigned, int, int, int, void*);
  void (*DestroyContext)(void*);
  unsigned char (*MakeCurrent)(void*, void*, unsigned, int, int);
  void* (*GetCurrentContext)();
  void* (*GetProcAddress)(const char*);
  int (*GetColorBuffer)(void*, int*, int*, int*, void**);

  Osmesa() {
    library.Load(CreateContext, "OSMesaCreateContextExt");
    library.Load(DestroyContext, "OSMesaDestroyContext");
    library.Load(MakeCurrent, "OSMesaMakeCurrent");
    library.Load(GetCurrentContext, "OSMesaGetCurrentContext");
    library.Load(GetProcAddress, "OSMesaGetProcAddress");
    library.Load(GetColorBuffer, "OSMesaGetColorBuffer");
  }
};

Osmesa& osmesa() {
  static Osmesa* functions =
      new Osmesa;  // throws again on the next call when the library is missing
  return *functions;
}

}  // namespace

class OsmesaContext final : public GlContext {
 public:
  OsmesaContext()
      : context_(osmesa().CreateContext(kRgba, 24, 8, 0, nullptr)), buffer_(4 * kSide * kSide) {
    if (!context_) throw IoError("OSMesaCreateContextExt failed");
  }
  ~OsmesaContext() override {
    if (!InFork()) osmesa().DestroyContext(context_);
  }

  GlBackend backend() const override { return GlBackend::kOsmesa; }
  void* Function(const char* name) const override { return osmesa().GetProcAddress(name); }

  void Probe() {
    Current scope(*this);
    using GetString = const char*(unsigned);
    auto* get = reinterpret_cast<GetString*>(Function("glGetString"));
    const char* renderer = get ? get(kGlRenderer) : nullptr;
    const char* version = get ? get(kGlVersion) : nullptr;
    if (!renderer || !version) throw IoError("the context reports no OpenGL version");
    description_ = std::string("osmesa: ") + renderer + ", OpenGL " + version;
  }

 private:
  void Enter(Saved& saved) override {
    Osmesa& o = osmesa();
    saved[0] = o.GetCurrentContext();
    if (saved[0] == context_) return;
    int format = 0;
    if (saved[0]) o.GetColorBuffer(saved[0], &width_, &height_, &format, &saved[1]);
    if (!o.MakeCurrent(context_, buffer_.data(), kUnsignedByte, kSide, kSide)) {
      throw Error(
          "OSMesaMakeCurrent failed. An OpenGL context can be used by one thread at a time.");
    }
  }

  void Leave(Saved& saved) noexcept override {
    if (saved[0] == context_) return;
    if (saved[0]) {
      osmesa().MakeCurrent(saved[0], saved[1], kUnsignedByte, width_, height_);
    } else {
      osmesa().MakeCurrent(nullptr, nullptr, 0, 0, 0);
    }
  }

  void* context_;
  std::vector<unsigned char> buffer_;
  int width_ = 0, height_ = 0;  // size of the previous context
};

std::unique_ptr<GlContext> CreateOsmesaContext() {
  auto context = std::make_unique<OsmesaContext>();
  context->Probe();
  osmesa().library.MakeGlobal();
  return context;
}

}  // namespace robocell::internal
