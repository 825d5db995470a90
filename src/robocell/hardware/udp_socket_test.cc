#include "robocell/hardware/udp_socket.h"

#include <netinet/in.h>
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <string>

#include "robocell/base/error.h"

namespace robocell::internal {
namespace {

TEST(UdpSocket, CarriesDatagramsAndNeverWaits) {
  UdpSocket a(ParseAddress("127.0.0.1:0")), b(ParseAddress("127.0.0.1:0"));
  std::array<std::byte, 64> room{};
  sockaddr_in from{};
  EXPECT_TRUE(b.Receive(room, from).empty());
  const std::array<std::byte, 3> bytes = {std::byte{1}, std::byte{2}, std::byte{3}};
  a.Send(bytes, b.address());
  const auto got = b.Receive(room, from);
  ASSERT_EQ(got.size(), 3);
  EXPECT_EQ(got[2], std::byte{3});
  EXPECT_TRUE(IsSame(from, a.address()));
  EXPECT_TRUE(b.Receive(room, from).empty());
}

TEST(UdpSocket, SaysWhyItCannotListen) {
  const UdpSocket first(ParseAddress("127.0.0.1:0"));
  try {
    const UdpSocket second(first.address());
    ADD_FAILURE() << "two at one address";
  } catch (const IoError& error) {
    EXPECT_NE(std::string(error.what()).find(ToString(first.address())), std::string::npos);
  }
}

TEST(UdpSocket, ReadsAddresses) {
  EXPECT_EQ(ToString(ParseAddress("10.0.0.2:80")), "10.0.0.2:80");
  EXPECT_TRUE(IsLoopback(ParseAddress("127.3.2.1:1")));
  EXPECT_FALSE(IsLoopback(ParseAddress("0.0.0.0:1")));
  for (const char* bad : {"", "127.0.0.1", "127.0.0.1:", "127.0.0.1:99999", "localhost:1", ":1",
                          "127.0.0.1:1x", "127.0.0.1:-1"})
    EXPECT_THROW(ParseAddress(bad), ArgumentError) << bad;
}

}  // namespace
}  // namespace robocell::internal
