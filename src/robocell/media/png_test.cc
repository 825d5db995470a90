#include "robocell/media/png.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/media/testing/frames.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

RgbImage Picture() { return {33, 17, TestFrame(33, 17, 2)}; }

GrayImage16 Depth() {
  GrayImage16 depth{5, 3, {}};
  for (int i = 0; i < 15; ++i) depth.pixels.push_back(static_cast<uint16_t>(4681 * i));
  return depth;
}

TEST(Png, ColoursRoundTripExactly) {
  TempDir folder;
  WritePng(folder / "a.png", Picture());
  const RgbImage back = ReadPngRgb(folder / "a.png");
  EXPECT_EQ(back.width, 33);
  EXPECT_EQ(back.height, 17);
  EXPECT_EQ(back.pixels, Picture().pixels);
}

TEST(Png, SixteenBitDepthRoundTripsExactly) {
  TempDir folder;
  WritePng(folder / "a.png", Depth());
  EXPECT_EQ(ReadPngGray16(folder / "a.png").pixels, Depth().pixels);
}

// The file of a pixel 0x0102, as the PNG specification lays it out.
TEST(Png, SixteenBitsAreBigEndianInTheFile) {
  const std::vector<uint16_t> pixel = {0x0102};
  const std::vector<uint8_t> file = EncodePng(1, 1, pixel);
  EXPECT_EQ((std::vector<uint8_t>(file.begin() + 1, file.begin() + 4)),
            (std::vector<uint8_t>{'P', 'N', 'G'}));
  EXPECT_EQ(file[24], 16);  // bit depth
  EXPECT_EQ(file[25], 0);   // gray
  TempDir folder;
  WritePng(folder / "a.png", GrayImage16{1, 1, pixel});
  EXPECT_EQ(ReadPngRgb(folder / "a.png").pixels, (std::vector<uint8_t>{1, 1, 1}));  // the high byte
}

TEST(Png, SamePixelsGiveSameBytes) {
  EXPECT_EQ(EncodePng(33, 17, Picture().pixels), EncodePng(33, 17, Picture().pixels));
}

TEST(Png, TextsRoundTrip) {
  TempDir folder;
  const PngTexts texts = {{"px_per_m", "50.0"}, {"world_to_map", "[[1, 2], [3, 4]]"}};
  const std::vector<uint8_t> png = EncodePng(33, 17, Picture().pixels, texts);
  AtomicWrite(folder / "a.png", std::string(png.begin(), png.end()));
  EXPECT_EQ(ReadPngTexts(folder / "a.png"), texts);
  EXPECT_EQ(ReadPngRgb(folder / "a.png").pixels, Picture().pixels);
  WritePng(folder / "b.png", Picture());
  EXPECT_TRUE(ReadPngTexts(folder / "b.png").empty());
}

TEST(Png, ReadsNoMorePixelsThanAllowed) {
  TempDir folder;
  WritePng(folder / "a.png", Picture());
  ExpectThrow<IoError>([&] { ReadPngRgb(folder / "a.png", 500); }, "33x17 pixels, and at most 500");
  ExpectThrow<IoError>([&] { ReadPngTexts(folder / "a.png", 500); }, "at most 500");
}

TEST(Png, AColourImageIsNotDepth) {
  TempDir folder;
  WritePng(folder / "a.png", Picture());
  ExpectThrow<IoError>([&] { ReadPngGray16(folder / "a.png"); },
                       "expected 16-bit gray, the file has 8 bits");
}

TEST(Png, ADamagedFileIsAnErrorAndNeverACrash) {
  TempDir folder;
  WritePng(folder / "a.png", Picture());
  const std::string whole = ReadFile(folder / "a.png");
  for (size_t size = 0; size < whole.size(); size += whole.size() / 23) {
    AtomicWrite(folder / "cut.png", whole.substr(0, size));
    ExpectThrow<IoError>([&] { ReadPngRgb(folder / "cut.png"); }, "cut.png");
  }
  for (size_t at = 0; at < whole.size(); at += 7) {
    std::string flipped = whole;
    flipped[at] ^= 0x10;
    AtomicWrite(folder / "flipped.png", flipped);
    EXPECT_THROW(ReadPngRgb(folder / "flipped.png"), IoError) << "byte " << at;
  }
}

TEST(Png, RejectsAWrongNumberOfPixels) {
  ExpectThrow<ArgumentError>(
      [] {
        WritePng("/nowhere/a.png", RgbImage{2, 2, std::vector<uint8_t>(11)});
      },
      "2x2 px with 3 values per pixel needs 12 values, got 11");
}

TEST(Png, RejectsAnotherFileExtension) {
  TempDir folder;
  const auto write = [&](const char* name) { WritePng(folder / name, Picture()); };
  for (const char* name : {"a.jpg", "a.JPG", "a"}) {
    ExpectThrow<ArgumentError>([&] { write(name); },
                               "pictures are written as PNG, under names that end in .png or .PNG: "
                               "give '" +
                                   (folder / "a.png").string() + "' instead of '");
    EXPECT_FALSE(std::filesystem::exists(folder / name));
  }
  EXPECT_NO_THROW(write("a.PNG"));
}

TEST(Png, AMissingFolderIsNamed) {
  ExpectThrow<IoError>([] { WritePng("/nowhere/a.png", Picture()); }, "/nowhere");
  ExpectThrow<IoError>([] { ReadPngRgb("/nowhere/a.png"); }, "/nowhere/a.png");
}

}  // namespace
}  // namespace robocell
