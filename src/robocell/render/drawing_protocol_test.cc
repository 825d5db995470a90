#include "robocell/render/drawing_protocol.h"

#include <stdlib.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "robocell/base/error.h"
#include "robocell/render/testing/gl_pictures.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

std::pair<DrawingChannel, DrawingChannel> Connected() {
  int ends[2];
  EXPECT_EQ(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends), 0);
  return {DrawingChannel(FileHandle(ends[0])), DrawingChannel(FileHandle(ends[1]))};
}

TEST(DrawingProtocol, APictureArrivesWithItsListAndItsImagesComeBack) {
  ListedScene scene;
  RawImages images;
  GlPicture picture = scene.Picture(30, 20, 10, images);
  picture.codes = {};
  SharedMemory memory(BytesOfPicture(picture, picture.scene->maxgeom));
  PutPicture(picture, memory.bytes());

  const auto [client, service] = Connected();
  ASSERT_TRUE(client.Send(DrawingRequest{.call = DrawingCall::kPaint}, memory.descriptor()));
  FileHandle came;
  const auto request = service.Receive<DrawingRequest>(1000, &came);
  ASSERT_TRUE(request && came);
  EXPECT_EQ(request->call, DrawingCall::kPaint);
  SharedMemory same(std::move(came));
  ReceivedPicture received;
  const GlPicture other = received.Get(same.bytes());
  EXPECT_EQ(other.width, 20);
  EXPECT_EQ(other.height, 10);
  EXPECT_TRUE(other.codes.empty());
  ASSERT_EQ(other.scene->ngeom, picture.scene->ngeom);
  EXPECT_EQ(std::memcmp(other.scene->geoms, picture.scene->geoms,
                        sizeof(mjvGeom) * static_cast<size_t>(other.scene->ngeom)),
            0);
  EXPECT_EQ(other.scene->nlight, picture.scene->nlight);
  EXPECT_EQ(other.scene->camera[0].frustum_top, picture.scene->camera[0].frustum_top);

  std::ranges::fill(other.rgb, 7);
  std::ranges::fill(other.depth, 0.25f);
  TakeImages(memory.bytes(), picture);
  EXPECT_THAT(images.rgb, testing::Each(7));
  EXPECT_THAT(images.depth, testing::Each(0.25f));
}

TEST(DrawingProtocol, RejectsMemoryThatIsNoPicture) {
  ListedScene scene;
  RawImages images;
  const GlPicture picture = scene.Picture(30, 20, 10, images);
  SharedMemory memory(BytesOfPicture(picture, picture.scene->ngeom));
  ReceivedPicture received;
  ExpectThrow<ArgumentError>([&] { received.Get(memory.bytes()); }, "an image of 0 x 0 pixels");
  PutPicture(picture, memory.bytes());
  EXPECT_NO_THROW(received.Get(memory.bytes()));
  ExpectThrow<ArgumentError>([&] { received.Get(memory.bytes().first(memory.bytes().size() / 2)); },
                             "no picture");
  ExpectThrow<ArgumentError>([&] { received.Get(memory.bytes().first(8)); }, "no picture");
}

// Reading memory that another process has made smaller ends a process.
TEST(DrawingProtocol, RejectsMemoryThatCouldShrink) {
  FileHandle open(memfd_create("test", MFD_CLOEXEC));
  ASSERT_EQ(ftruncate(*open, 4096), 0);
  ExpectThrow<IoError>([&] { SharedMemory memory(std::move(open)); }, "could change its size");
}

TEST(DrawingProtocol, NoticesTheEndAndOtherMessages) {
  auto [client, service] = Connected();
  EXPECT_FALSE(service.Receive<DrawingRequest>(0)) << "nothing has come";
  ASSERT_TRUE(client.Send(DrawingReply{}));
  EXPECT_FALSE(service.Receive<DrawingRequest>(1000)) << "a longer message";
  EXPECT_EQ(service.peer(), getpid());
  { const DrawingChannel gone = std::move(client); }
  EXPECT_FALSE(service.Receive<DrawingRequest>(1000));
  EXPECT_FALSE(service.Send(DrawingReply{}));
}

TEST(DrawingProtocol, ANameHasOneOwnerAndEndsWithIt) {
  const std::string name = "robocell-test-" + std::to_string(getpid());
  EXPECT_FALSE(ConnectToDrawingName(name));
  {
    const auto owner = TakeDrawingName(name);
    ASSERT_TRUE(owner);
    EXPECT_FALSE(TakeDrawingName(name));
    EXPECT_TRUE(ConnectToDrawingName(name));
  }
  EXPECT_FALSE(ConnectToDrawingName(name));
  EXPECT_TRUE(TakeDrawingName(name));
}

TEST(DrawingProtocol, EachChoiceOfADeviceHasItsService) {
  const std::string plain = DrawingServiceName(GlBackend::kAuto);
  EXPECT_EQ(DrawingServiceName(GlBackend::kAuto), plain);
  EXPECT_NE(DrawingServiceName(GlBackend::kOsmesa), plain);
  setenv("CUDA_VISIBLE_DEVICES", "1", 1);
  EXPECT_NE(DrawingServiceName(GlBackend::kAuto), plain);
  setenv("CUDA_VISIBLE_DEVICES", "0,1", 1);
  const auto of_worker = [](const char* number) {
    setenv("ROBOCELL_EGL_TURN", number, 1);
    return DrawingServiceName(GlBackend::kAuto);
  };
  EXPECT_NE(of_worker("0"), of_worker("1")) << "two cards have two services";
  EXPECT_EQ(of_worker("0"), of_worker("2"));
  unsetenv("ROBOCELL_EGL_TURN");
  unsetenv("CUDA_VISIBLE_DEVICES");
}

}  // namespace
}  // namespace robocell::internal
