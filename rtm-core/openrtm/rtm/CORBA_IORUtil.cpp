#include "rtm/CORBA_IORUtil.h"

#include <cctype>
#include <cstring>
#include <optional>

#include "base/text.h"

namespace CORBA_IORUtil {
namespace {

int digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const char lower = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

std::optional<IIOP::ProfileBody> body_of(const IOP::TaggedProfile& profile) {
  if (profile.tag != IOP::TAG_INTERNET_IOP) return std::nullopt;
  try {
    IIOP::ProfileBody body;
    IIOP::unmarshalProfile(profile, body);
    return body;
  } catch (const CORBA::Exception&) {
    return std::nullopt;
  }
}

}  // namespace

bool toIOR(const char* text, IOP::IOR& ior) {
  if (!text || (std::strncmp(text, "IOR:", 4) != 0 && std::strncmp(text, "ior:", 4) != 0)) return false;
  const std::string_view hex = base::trim(text + 4);
  if (hex.size() < 2 || hex.size() % 2 != 0) return false;
  cdrMemoryStream stream(static_cast<CORBA::ULong>(hex.size() / 2), false);
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    const int high = digit(hex[i]);
    const int low = digit(hex[i + 1]);
    if (high < 0 || low < 0) return false;
    stream.marshalOctet(static_cast<CORBA::Octet>(high * 16 + low));
  }
  try {
    stream.rewindInputPtr();
    stream.setByteSwapFlag(stream.unmarshalBoolean());
    IOP::IOR read;
    read.type_id = IOP::IOR::unmarshaltype_id(stream);
    read.profiles <<= stream;
    ior.type_id = CORBA::string_dup(read.type_id);
    ior.profiles = read.profiles;
    return true;
  } catch (const CORBA::Exception&) {
    return false;
  }
}

std::string toString(const IOP::IOR& ior) {
  cdrMemoryStream stream(1024, true);  // gaps are zero
  stream.setByteSwapFlag(true);
  stream.marshalBoolean(true);
  stream.marshalRawString(ior.type_id);
  ior.profiles >>= stream;
  static const char digits[] = "0123456789abcdef";
  std::string text = "IOR:";
  const auto* octets = static_cast<const unsigned char*>(stream.bufPtr());
  for (CORBA::ULong i = 0; i < stream.bufSize(); ++i) {
    text += digits[octets[i] >> 4];
    text += digits[octets[i] & 15];
  }
  return text;
}

bool replaceEndpoint(std::string& text, const std::string& endpoint) {
  const auto colon = endpoint.rfind(':');
  const std::string host = endpoint.substr(0, colon);
  std::optional<std::int64_t> port;
  if (colon != std::string::npos) {
    port = base::parse_integer(std::string_view(endpoint).substr(colon + 1));
    if (!port || *port < 0 || *port > 65535) return false;
  }
  IOP::IOR ior;
  if (host.empty() || !toIOR(text.c_str(), ior)) return false;
  for (CORBA::ULong i = 0; i < ior.profiles.length(); ++i) {
    auto body = body_of(ior.profiles[i]);
    if (!body) continue;
    body->address.host = host.c_str();
    if (port) body->address.port = static_cast<CORBA::UShort>(*port);
    IOP::TaggedProfile changed;
    IIOP::encodeProfile(*body, changed);
    ior.profiles[i] = changed;
  }
  text = toString(ior);
  return true;
}

std::vector<IIOP::Address> getEndpoints(const IOP::IOR& ior) {
  std::vector<IIOP::Address> addresses;
  for (CORBA::ULong i = 0; i < ior.profiles.length(); ++i) {
    if (const auto body = body_of(ior.profiles[i])) addresses.push_back(body->address);
  }
  return addresses;
}

std::string formatIORinfo(const char* text) {
  IOP::IOR ior;
  if (!toIOR(text, ior)) return "not a reference\n";
  std::string info = "Type ID: " + std::string(ior.type_id) + "\n";
  for (const auto& address : getEndpoints(ior))
    info += "Address: " + std::string(address.host.in()) + ":" + std::to_string(address.port) + "\n";
  return info;
}

}  // namespace CORBA_IORUtil
