#include "studio/http_head.h"

#include <algorithm>
#include <array>

#include "base/text.h"

namespace studio {
namespace {

constexpr std::string_view head_end = "\r\n\r\n";

bool is_token(std::string_view text) {
  constexpr std::string_view letters = "!#$%&'*+-.^_`|~0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";
  return !text.empty() && text.find_first_not_of(letters) == std::string_view::npos;
}

bool is_control(char c) { return (static_cast<unsigned char>(c) < ' ' && c != '\t') || c == '\x7f'; }

std::string_view take_line(std::string_view& text) {
  const auto end = std::min(text.find("\r\n"), text.size());
  const auto line = text.substr(0, end);
  text.remove_prefix(std::min(end + 2, text.size()));
  return line;
}

// "http://HOST..." -> "HOST"; empty: the target has none.
std::string_view authority_of(std::string_view target) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (target.size() <= scheme.size() || !base::equal_ignoring_case(target.substr(0, scheme.size()), scheme)) continue;
    const auto rest = target.substr(scheme.size());
    return rest.substr(0, std::min(rest.find_first_of("/?"), rest.size()));
  }
  return {};
}

struct RequestLine {
  std::string_view method, target, version;
};

std::optional<RequestLine> read_request_line(std::string_view line) {
  const auto first = line.find(' ');
  const auto last = line.rfind(' ');
  if (first == std::string_view::npos || first == last) return std::nullopt;
  const RequestLine request{line.substr(0, first), line.substr(first + 1, last - first - 1), line.substr(last + 1)};
  const bool is_plain = std::ranges::all_of(request.target, [](char c) { return c > ' ' && c < '\x7f'; });
  if (!is_token(request.method) || request.target.empty() || !is_plain) return std::nullopt;
  if (request.version != "HTTP/1.1" && request.version != "HTTP/1.0") return std::nullopt;
  return request;
}

// Fields that must not come twice, with how often they came and what they said last.
class SingleFields {
 public:
  // False: it has come before.
  bool take(std::string_view name, std::string_view value) {
    for (auto& [known, count, said] : fields_) {
      if (!base::equal_ignoring_case(name, known)) continue;
      said = value;
      return ++count == 1;
    }
    return true;
  }
  // Nothing: it has not come.
  std::optional<std::string_view> value(std::string_view name) const {
    for (const auto& [known, count, said] : fields_) {
      if (known == name && count > 0) return said;
    }
    return std::nullopt;
  }

 private:
  struct Field {
    std::string_view name;
    int count = 0;
    std::string_view value{};
  };
  std::array<Field, 9> fields_{{{"host"},
                                {"origin"},
                                {"authorization"},
                                {"content-length"},
                                {"transfer-encoding"},
                                {"upgrade"},
                                {"sec-websocket-key"},
                                {"sec-websocket-version"},
                                {"if-none-match"}}};
};

std::optional<HeadProblem> read_fields(std::string_view rest, SingleFields& fields) {
  while (!rest.empty()) {
    const auto line = take_line(rest);
    if (line.empty()) break;
    if (line.front() == ' ' || line.front() == '\t') return HeadProblem{400, "a line of the head is folded"};
    const auto colon = line.find(':');
    if (colon == std::string_view::npos || !is_token(line.substr(0, colon))) return HeadProblem{400, "a line of the head is no field"};
    if (!fields.take(line.substr(0, colon), base::trim(line.substr(colon + 1)))) return HeadProblem{400, "a field of the head comes twice"};
  }
  return std::nullopt;
}

std::optional<HeadProblem> check_length(const SingleFields& fields) {
  if (fields.value("transfer-encoding")) return HeadProblem{400, "a request has no body here, so no Transfer-Encoding"};
  const auto length = fields.value("content-length");
  if (!length) return std::nullopt;
  if (length->empty() || length->find_first_not_of("0123456789") != std::string_view::npos)
    return HeadProblem{400, "Content-Length is no number"};
  if (length->find_first_not_of('0') != std::string_view::npos) return HeadProblem{413, "a request has no body here"};
  return std::nullopt;
}

}  // namespace

HeadEnd find_head_end(std::string_view octets) {
  const auto end = octets.find(head_end);
  const auto head = octets.substr(0, end == std::string_view::npos ? octets.size() : end + head_end.size());
  for (std::size_t i = 0; i < std::min(head.size(), max_head); ++i) {
    if (head[i] == '\r'   ? i + 1 < head.size() && head[i + 1] != '\n'
        : head[i] == '\n' ? i == 0 || head[i - 1] != '\r'
                          : is_control(head[i]))
      return {HeadEnd::State::malformed, 0};
  }
  if (head.size() > max_head) return {HeadEnd::State::too_long, 0};
  if (head.starts_with("\r\n")) return {HeadEnd::State::malformed, 0};
  return {end == std::string_view::npos ? HeadEnd::State::incomplete : HeadEnd::State::complete, head.size()};
}

std::optional<HeadProblem> check_head(std::string_view head) {
  const auto request = read_request_line(take_line(head));
  if (!request) return HeadProblem{400, "this is no HTTP request"};
  SingleFields fields;
  if (const auto problem = read_fields(head, fields)) return problem;
  const auto host = fields.value("host");
  if (!host && request->version == "HTTP/1.1") return HeadProblem{400, "the request names no Host"};
  const auto authority = authority_of(request->target);
  if (authority.empty() && !request->target.starts_with('/')) return HeadProblem{400, "expected a target that begins with '/'"};
  if (!authority.empty() && (!host || !base::equal_ignoring_case(authority, *host)))
    return HeadProblem{400, "the target names another host than Host"};
  return check_length(fields);
}

std::string_view origin_form(std::string_view target) {
  const auto authority = authority_of(target);
  if (authority.empty()) return target;
  const auto path = target.substr(static_cast<std::size_t>(authority.data() + authority.size() - target.data()));
  return path.starts_with('/') ? path : std::string_view("/");
}

}  // namespace studio
