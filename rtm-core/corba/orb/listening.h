// Finds out why an end point cannot be listened on, because the ORB reports only a code and a text for its own developers. It tries to
// listen there for a short time. Any thread.
#pragma once

#include <string>
#include <string_view>

namespace corba {

// Of an end point as omniORB wants it, giop:tcp:HOST:PORT or giop:ssl:HOST:PORT. Empty when something can listen there, and for other
// kinds.
std::string listening_problem(std::string_view endpoint);

}  // namespace corba
