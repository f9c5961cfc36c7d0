#include "corba/orb/naming.h"

#include "base/own_account.h"
#include "base/text.h"
#include "corba/orb/orb.h"

namespace corba {

base::Result<CosNaming::Name> parse_name(std::string_view text) {
  struct Part {
    std::string text;
    std::size_t dot = std::string::npos;  // where the kind begins
  };
  std::vector<Part> parts(1);
  for (std::size_t i = 0; i < text.size(); ++i) {
    auto& part = parts.back();
    if (text[i] == '\\' && i + 1 < text.size()) {
      part.text += text[++i];
    } else if (text[i] == '/') {
      parts.emplace_back();
    } else {
      if (text[i] == '.') part.dot = part.text.size();
      part.text += text[i];
    }
  }
  // A context is made, and asked for, at each level: sixteen thousand kept a naming service and the end of its caller busy for minutes.
  constexpr std::size_t most = 64;
  if (parts.size() > most)
    return base::Error{"name " + base::in_quotes(text) + ": has " + std::to_string(parts.size()) + " components, expected at most " +
                       std::to_string(most)};
  CosNaming::Name name;
  name.length(static_cast<CORBA::ULong>(parts.size()));
  for (CORBA::ULong i = 0; i < name.length(); ++i) {
    const auto& part = parts[i];
    const bool has_kind = part.dot != std::string::npos;
    name[i].id = part.text.substr(0, part.dot).c_str();
    name[i].kind = has_kind ? part.text.substr(part.dot + 1).c_str() : "";
    if (part.text.empty()) return base::Error{"name " + base::in_quotes(text) + ": has an empty component"};
    if (part.text.find('\0') != std::string::npos) return base::Error{"name " + base::in_quotes(text) + ": contains a null character"};
  }
  return name;
}

std::string to_text(const CosNaming::Name& name) {
  const auto escaped = [](const char* text) {
    std::string result;
    for (; *text != '\0'; ++text) {
      if (*text == '/' || *text == '.' || *text == '\\') result += '\\';
      result += *text;
    }
    return result;
  };
  std::string result;
  for (CORBA::ULong i = 0; i < name.length(); ++i) {
    if (i > 0) result += '/';
    result += escaped(name[i].id);
    const std::string kind = escaped(name[i].kind);
    if (!kind.empty() || *name[i].id.in() == '\0') result += '.' + kind;
  }
  return result;
}

std::string naming_url(std::string_view address) {
  const std::string text(base::trim(address));
  if (text.starts_with("corbaloc:") || text.starts_with("corbaname:") || text.starts_with("IOR:")) return text;
  const std::string server = base::with_numeric_host(text.empty() ? "localhost" : text);
  return std::string(server.starts_with("iiop:") || server.starts_with("ssliop:") ? "corbaloc:" : "corbaloc::") + server + "/NameService";
}

base::Result<CosNaming::NamingContext_var> root_context(CORBA::ORB_ptr orb, std::string_view address, std::chrono::milliseconds timeout) {
  const auto complain = [&](const std::string& why) {
    return base::Error{"name server " + base::in_quotes(base::trim(address)) + ": " + why};
  };
  try {
    CORBA::Object_var object = orb->string_to_object(naming_url(address).c_str());
    set_call_timeout(object, timeout);
    CosNaming::NamingContext_var root = CosNaming::NamingContext::_narrow(object);
    if (CORBA::is_nil(root)) return complain("is something else");
    set_call_timeout(root, timeout);
    return root;
  } catch (const CORBA::BAD_PARAM&) {
    return complain("expected host, host:port or a corbaloc address");
  } catch (const CORBA::Exception& e) {
    return complain("does not answer: " + to_text(e));
  }
}

namespace {

CosNaming::Name prefix_of(const CosNaming::Name& name, CORBA::ULong length) {
  CosNaming::Name prefix;
  prefix.length(length);
  for (CORBA::ULong i = 0; i < length; ++i) prefix[i] = name[i];
  return prefix;
}

// A context that another program has destroyed but not unbound answers OBJECT_NOT_EXIST: its entry is taken out and made again.
void make_contexts(CosNaming::NamingContext_ptr root, const CosNaming::Name& name, std::vector<CosNaming::Name>* made) {
  for (CORBA::ULong length = 1; length < name.length(); ++length) {
    const auto prefix = prefix_of(name, length);
    for (bool again = true; again;) {
      again = false;
      try {
        CosNaming::NamingContext_var context = root->bind_new_context(prefix);
        if (made != nullptr) made->push_back(prefix);
      } catch (const CosNaming::NamingContext::AlreadyBound&) {
      } catch (const CORBA::OBJECT_NOT_EXIST&) {
        if (length == 1) throw;
        root->unbind(prefix_of(name, length - 1));
        length -= 2;  // the loop adds one: start over with the dead context
        break;
      }
    }
  }
}

}  // namespace

void rebind_recursive(CosNaming::NamingContext_ptr root, const CosNaming::Name& name, CORBA::Object_ptr object,
                      std::vector<CosNaming::Name>* made) {
  for (int attempt = 0;; ++attempt) {
    try {
      root->rebind(name, object);
      return;
    } catch (const CosNaming::NamingContext::NotFound& e) {
      if (attempt > 0 || name.length() < 2 || e.why != CosNaming::NamingContext::missing_node) throw;
    } catch (const CORBA::OBJECT_NOT_EXIST&) {
      if (attempt > 0 || name.length() < 2) throw;
      root->unbind(prefix_of(name, name.length() - 1));
    }
    make_contexts(root, name, made);
  }
}

namespace {

using Fits = std::function<bool(const CosNaming::NameComponent&)>;

void find_below(CosNaming::NamingContext_ptr context, const CosNaming::Name& where, const Fits& fits, std::size_t max_names,
                ContextWalk& walk, std::vector<CosNaming::Name>& found) {
  constexpr CORBA::ULong at_once = 1000;
  const ContextWalk::Stay stay(walk, context);
  if (!stay) return;
  CosNaming::BindingList_var list;
  CosNaming::BindingIterator_var more;
  context->list(at_once, list, more);
  for (bool has_more = true; has_more && found.size() < max_names;) {
    for (CORBA::ULong i = 0; i < list->length() && found.size() < max_names; ++i) {
      const auto& binding = list[i];
      CosNaming::Name name = where;
      name.length(where.length() + 1);
      name[where.length()] = binding.binding_name[binding.binding_name.length() - 1];
      if (binding.binding_type == CosNaming::ncontext) {
        try {
          CORBA::Object_var object = context->resolve(binding.binding_name);
          CosNaming::NamingContext_var below = CosNaming::NamingContext::_narrow(object);
          if (!CORBA::is_nil(below)) find_below(below, name, fits, max_names, walk, found);
        } catch (const CORBA::Exception&) {  // a dead or foreign context hides nothing else
          continue;
        }
      } else if (fits(name[where.length()])) {
        found.push_back(name);
      }
    }
    has_more = !CORBA::is_nil(more) && more->next_n(at_once, list);
  }
  if (!CORBA::is_nil(more)) more->destroy();
}

}  // namespace

ContextWalk::Stay::Stay(ContextWalk& walk, CosNaming::NamingContext_ptr context) {
  constexpr std::size_t deepest = 20, most = 10'000;
  if (walk.around_.size() >= deepest || walk.entered_ >= most) return;
  for (const auto& outer : walk.around_) {
    if (outer->_is_equivalent(context)) return;
  }
  ++walk.entered_;
  walk.around_.emplace_back(CosNaming::NamingContext::_duplicate(context));
  walk_ = &walk;
}

ContextWalk::Stay::~Stay() {
  if (walk_) walk_->around_.pop_back();
}

std::vector<CosNaming::Name> find_names(CosNaming::NamingContext_ptr root, const Fits& fits, std::size_t max_names) {
  std::vector<CosNaming::Name> found;
  ContextWalk walk;
  find_below(root, {}, fits, max_names, walk, found);
  return found;
}

}  // namespace corba
