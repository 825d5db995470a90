#include "robocell/render/gl_painter.h"

namespace robocell::internal {
namespace {

// Places of a picture's images in a pixel buffer.
struct Places {
  size_t rgb, codes, depth, end;
};

Places PlacesOf(const GlPicture& picture) {
  const auto after = [](size_t at, size_t bytes) { return (at + bytes + 63) / 64 * 64; };
  Places places{.rgb = PixelBuffer::kFirst, .codes = 0, .depth = 0, .end = 0};
  places.codes = after(places.rgb, picture.rgb.size_bytes());
  places.depth = after(places.codes, picture.codes.size_bytes());
  places.end = after(places.depth, picture.depth.size_bytes());
  return places;
}

}  // namespace

GlPainter::GlPainter(const mjModel* model, const GlStyle& style)
    : model_(model),
      style_(style),
      colour_(model, style.multisamples, style.shadow_size, style.things) {}

MjrContext& GlPainter::Exact() {
  if (style_.multisamples == 0) return colour_;
  if (!exact_) exact_ = std::make_unique<MjrContext>(model_, 0, 0, style_.things);
  return *exact_;
}

void GlPainter::DrawColour(const GlPicture& picture) {
  mjtByte* flags = picture.scene->flags;
  flags[mjRND_SEGMENT] = flags[mjRND_IDCOLOR] = 0;
  colour_.Draw(picture.scene, picture.width, picture.height);
}

void GlPainter::DrawExact(const GlPicture& picture) {
  mjvScene* scene = picture.scene;
  scene->flags[mjRND_SEGMENT] = scene->flags[mjRND_IDCOLOR] = 1;
  const int geoms = scene->ngeom;
  scene->ngeom = picture.exact_geoms;
  Exact().Draw(scene, picture.width, picture.height);
  scene->ngeom = geoms;
}

void GlPainter::Paint(const GlPicture& picture) {
  const auto data = [](auto images) { return images.empty() ? nullptr : images.data(); };
  if (!picture.rgb.empty()) {
    DrawColour(picture);
    colour_.Read(picture.width, picture.height, picture.rgb.data(), nullptr);
  }
  if (!picture.is_exact()) return;
  DrawExact(picture);
  Exact().Read(picture.width, picture.height, data(picture.codes), data(picture.depth));
}

void GlPainter::Begin(const GlPicture& picture, PixelBuffer& pixels) {
  const Places places = PlacesOf(picture);
  // In a pixel buffer the place of an image is given where its address would be.
  const auto at = [](auto images, size_t place) {
    return images.empty() ? nullptr : reinterpret_cast<decltype(images.data())>(place);
  };
  const auto read = [&](MjrContext& context, uint8_t* rgb, float* depth) {
    const PixelBuffer::Reading reading(pixels, places.end);
    context.Read(picture.width, picture.height, rgb, depth);
  };
  if (!picture.rgb.empty()) {
    DrawColour(picture);
    read(colour_, at(picture.rgb, places.rgb), nullptr);
  }
  if (!picture.is_exact()) return;
  DrawExact(picture);
  read(Exact(), at(picture.codes, places.codes), at(picture.depth, places.depth));
}

void GlPainter::Finish(const GlPicture& picture, PixelBuffer& pixels) {
  const Places places = PlacesOf(picture);
  const auto copy = [&](size_t place, auto images) {
    if (!images.empty()) pixels.Copy(place, std::as_writable_bytes(images));
  };
  copy(places.rgb, picture.rgb);
  copy(places.codes, picture.codes);
  copy(places.depth, picture.depth);
}

}  // namespace robocell::internal
