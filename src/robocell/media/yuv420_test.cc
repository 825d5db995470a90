// Tests RGB to YUV 4:2:0 against the formulas of BT.601 in double precision.
#include "robocell/media/yuv420.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/instruction_sets.h"

namespace robocell::internal {
namespace {

struct RgbTestImage {
  int width, height;
  std::vector<uint8_t> pixels;
  double At(int x, int y, int channel) const {
    return pixels[3 * (static_cast<size_t>(y) * width + x) + channel];
  }
};

RgbTestImage RandomImage(int width, int height) {
  Rng rng = Rng::Stream(static_cast<uint64_t>(width), "yuv");
  RgbTestImage image{width, height, std::vector<uint8_t>(size_t{3} * width * height)};
  for (uint8_t& byte : image.pixels) byte = static_cast<uint8_t>(rng.UniformInt(256));
  return image;
}

using Vector3 = std::array<double, 3>;

double Luma(const Vector3& rgb) { return 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2]; }

// Returns the colour of the chroma sample (column, row): the mean of 2 x 2 pixels.
Vector3 ChromaColour(const RgbTestImage& image, int column, int row) {
  Vector3 mean{};
  for (int channel = 0; channel < 3; ++channel) {
    for (int dy = 0; dy < 2; ++dy) {
      for (int dx = 0; dx < 2; ++dx)
        mean[channel] += image.At(2 * column + dx, 2 * row + dy, channel) / 4;
    }
  }
  return mean;
}

void ExpectBt601(const RgbTestImage& image, std::span<const uint8_t> yuv) {
  const int w = image.width, h = image.height;
  ASSERT_EQ(yuv.size(), static_cast<size_t>(w * h * 3 / 2));
  double worst = 0;
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const double luma = Luma({image.At(x, y, 0), image.At(x, y, 1), image.At(x, y, 2)});
      worst = std::max(worst, std::abs(yuv[y * w + x] - (16 + luma * 219 / 255)));
    }
  }
  for (int row = 0; row < h / 2; ++row) {
    for (int column = 0; column < w / 2; ++column) {
      const Vector3 rgb = ChromaColour(image, column, row);
      const size_t at = w * h + row * (w / 2) + column;
      const double cb = 128 + (rgb[2] - Luma(rgb)) / 1.772 * 224 / 255;
      const double cr = 128 + (rgb[0] - Luma(rgb)) / 1.402 * 224 / 255;
      worst = std::max(worst, std::abs(yuv[at] - cb));
      worst = std::max(worst, std::abs(yuv[at + w * h / 4] - cr));
    }
  }
  EXPECT_LT(worst, 0.52) << w << "x" << h;  // rounding, and weights with 15 bits
}

TEST(Yuv420, IsBt601OnEveryInstructionSet) {
  OnEveryInstructionSet([](const std::string& name) {
    SCOPED_TRACE(name);
    for (const auto& [w, h] : {std::pair{2, 2},
                               {4, 6},
                               {14, 4},
                               {16, 2},
                               {18, 4},
                               {30, 8},
                               {66, 10},
                               {128, 6},
                               {322, 24}}) {
      const RgbTestImage image = RandomImage(w, h);
      ExpectBt601(image, Yuv420Converter(w, h)(image.pixels));
    }
  });
}

TEST(Yuv420, GivesTheSameBytesOnEveryInstructionSetAndEveryTime) {
  const RgbTestImage image = RandomImage(102, 20), other = RandomImage(100, 20);
  Yuv420Converter reference(102, 20);
  const auto first = reference(image.pixels);
  const std::vector<uint8_t> expected(first.begin(), first.end());
  OnEveryInstructionSet([&](const std::string& name) {
    Yuv420Converter convert(102, 20);
    for (int k = 0; k < 2; ++k)
      EXPECT_TRUE(std::ranges::equal(convert(image.pixels), expected)) << name << k;
  });
}

TEST(Yuv420, KeepsBlackGrayWhiteAndPrimaries) {
  const auto converted = [](uint8_t r, uint8_t g, uint8_t b) {
    std::vector<uint8_t> rgb;
    for (int k = 0; k < 32 * 2; ++k) rgb.insert(rgb.end(), {r, g, b});
    Yuv420Converter convert(32, 2);
    const auto yuv = convert(rgb);
    return std::array<int, 3>{yuv[5], yuv[64 + 3], yuv[64 + 16 + 3]};
  };
  EXPECT_EQ(converted(0, 0, 0), (std::array{16, 128, 128}));
  EXPECT_EQ(converted(255, 255, 255), (std::array{235, 128, 128}));
  EXPECT_EQ(converted(128, 128, 128), (std::array{126, 128, 128}));
  EXPECT_EQ(converted(255, 0, 0), (std::array{81, 90, 240}));
  EXPECT_EQ(converted(0, 255, 0), (std::array{145, 54, 34}));
  EXPECT_EQ(converted(0, 0, 255), (std::array{41, 240, 110}));
}

TEST(Yuv420, RejectsOddSizesAndOtherBuffers) {
  ExpectThrow<ArgumentError>([] { Yuv420Converter(321, 240); }, "not 321x240 px");
  ExpectThrow<ArgumentError>([] { Yuv420Converter(0, 2); }, "not 0x2 px");
  Yuv420Converter convert(4, 2);
  ExpectThrow<ArgumentError>([&] { convert(std::vector<uint8_t>(23)); }, "has 24 bytes, not 23");
}

}  // namespace
}  // namespace robocell::internal
