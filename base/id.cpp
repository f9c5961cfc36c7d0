#include "base/id.h"

#include <uuid/uuid.h>

namespace base {

std::string make_uuid() {
  uuid_t bytes;
  uuid_generate_random(bytes);
  char text[37];
  uuid_unparse_lower(bytes, text);
  return text;
}

}  // namespace base
