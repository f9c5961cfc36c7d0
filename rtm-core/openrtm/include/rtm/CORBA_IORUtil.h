// Stringified references: taking them apart, changing where they point. Any thread.
#pragma once

#include <omniORB4/CORBA.h>
#include <omniORB4/IIOP.h>
#include <omniORB4/IOP.h>

#include <string>
#include <vector>

namespace CORBA_IORUtil {

// False, and nothing changes, if the text is no reference.
bool toIOR(const char* text, IOP::IOR& ior);
std::string toString(const IOP::IOR& ior);
// Lets every IIOP profile point to "host" or "host:port". False, and nothing changes, if the text is no reference or the end point no
// address.
bool replaceEndpoint(std::string& text, const std::string& endpoint);
std::vector<IIOP::Address> getEndpoints(const IOP::IOR& ior);
// Type id and addresses, one line each.
std::string formatIORinfo(const char* text);

}  // namespace CORBA_IORUtil
