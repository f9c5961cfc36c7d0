// A place where calls come in and nobody answers, and references to objects there. Any thread.
#pragma once

#include <netinet/in.h>
#include <omniORB4/CORBA.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>
#include <string>

namespace support {

class Silence {
 public:
  Silence() {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), size) != 0 || listen(socket_, 100) != 0 ||
        getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
      throw std::runtime_error("no socket");
    port_ = ntohs(address.sin_port);
  }
  ~Silence() { close(socket_); }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;
  // False when nobody has called after a minute.
  bool wait_for_caller() const {
    pollfd ready{socket_, POLLIN, 0};
    return poll(&ready, 1, 60'000) == 1;
  }
  // The reference names its type, so that nobody need be asked for it.
  CORBA::Object_ptr object(CORBA::ORB_ptr orb, const char* type, int number) const {
    IIOP::ProfileBody body{};
    body.version = {1, 2};
    body.address.host = "127.0.0.1";
    body.address.port = port_;
    const std::string key = "silent" + std::to_string(number);
    body.object_key.length(static_cast<CORBA::ULong>(key.size()));
    std::ranges::copy(key, body.object_key.get_buffer());
    IOP::TaggedProfileList profiles;
    profiles.length(1);
    IIOP::encodeProfile(body, profiles[0]);
    cdrMemoryStream stream;
    stream.marshalBoolean(omni::myByteOrder);
    stream.marshalString(type);
    profiles >>= stream;
    std::string text = "IOR:";
    const auto* octets = static_cast<const unsigned char*>(stream.bufPtr());
    for (CORBA::ULong i = 0; i < stream.bufSize(); ++i) {
      constexpr const char* digits = "0123456789abcdef";
      text += digits[octets[i] >> 4];
      text += digits[octets[i] & 15];
    }
    return orb->string_to_object(text.c_str());
  }

 private:
  const int socket_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  CORBA::UShort port_ = 0;
};

}  // namespace support
