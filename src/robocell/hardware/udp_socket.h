// UdpSocket: a socket of datagrams (IPv4) that never waits. Private to hardware/.
#pragma once

#include <netinet/in.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace robocell::internal {

// Reads "127.0.0.1:7071". Throws ArgumentError for anything else; names of hosts are not looked up.
sockaddr_in ParseAddress(const std::string& address);
std::string ToString(const sockaddr_in& address);
// Returns true for an address of this computer alone (127.0.0.0/8).
bool IsLoopback(const sockaddr_in& address);
bool IsSame(const sockaddr_in& a, const sockaddr_in& b);

class UdpSocket {
 public:
  // Binds to the address; port 0 is any free one. Throws IoError.
  explicit UdpSocket(const sockaddr_in& address);
  ~UdpSocket();
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  sockaddr_in address() const;
  // A datagram that cannot be sent now is dropped, as the network does.
  void Send(std::span<const std::byte> bytes, const sockaddr_in& to);
  // Returns the bytes of the next datagram, and its sender; none if there is none. One that is
  // larger than `room` is cut.
  std::span<const std::byte> Receive(std::span<std::byte> room, sockaddr_in& from);

 private:
  int socket_ = -1;
};

}  // namespace robocell::internal
