// Robots that viewers move by hand: the part of the studio that has the drives.
#include "base/shell_word.h"
#include "base/text.h"
#include "studio/studio.h"

namespace studio {

using base::Error;
using base::Result;

void Studio::handle_drive(Guest& guest, const Request& request) {
  const auto iface = text_of(request.args, "iface");
  if (!iface) return answer(guest, request.id, iface.error());
  const auto velocity = numbers_of(request.args, "velocity", 3, 6);
  if (!velocity || (velocity->size() != 3 && velocity->size() != 6))
    return answer(guest, request.id, Error{"velocity: expected 3 numbers (position2d) or 6 (position3d)"});
  std::vector<std::string> words = simctl_words(options_.server_id);
  words.emplace_back("velocity");
  std::vector<std::string> operands{*iface};
  for (const double number : *velocity) operands.push_back(base::format_number(number));
  const auto command = base::shell_line(base::command_words(std::move(words), operands));
  if (request.is_dry) return answer(guest, request.id, Json::object(), command);
  if (options_.is_read_only) return answer(guest, request.id, read_only(), command);
  const auto done = drives_.drive(guest.viewer->id(), *iface, *velocity);
  answer(guest, request.id, done ? Result<Json>(Json::object()) : Result<Json>(done.error()), command);
}

void Studio::handle_release(Guest& guest, const Request& request) {
  const auto iface = text_of(request.args, "iface");
  if (!iface) return answer(guest, request.id, iface.error());
  if (options_.is_read_only) return answer(guest, request.id, read_only());
  drives_.release(guest.viewer->id(), *iface);
  answer(guest, request.id, Json::object());
}

}  // namespace studio
