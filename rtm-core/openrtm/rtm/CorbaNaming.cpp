#include "rtm/CorbaNaming.h"

#include <chrono>

#include "corba/orb/naming.h"
#include "corba/orb/orb.h"

namespace RTC {
namespace {

constexpr std::chrono::milliseconds call_timeout{3'000};

CosNaming::Name name_of(const char* text) {
  auto name = corba::parse_name(text != nullptr ? text : "");
  if (!name) throw CosNaming::NamingContext::InvalidName();
  return *name;
}

CosNaming::Name prefix_of(const CosNaming::Name& name) {
  CosNaming::Name prefix = name;
  prefix.length(name.length() - 1);
  return prefix;
}

}  // namespace

CorbaNaming::CorbaNaming(CORBA::ORB_ptr orb) : orb_(CORBA::ORB::_duplicate(orb)) {}

CorbaNaming::CorbaNaming(CORBA::ORB_ptr orb, const char* name_server) : CorbaNaming(orb) { init(name_server); }

void CorbaNaming::init(const char* name_server) {
  name_server_ = corba::naming_url(name_server != nullptr ? name_server : "");
  CORBA::Object_var object = orb_->string_to_object(name_server_.c_str());
  corba::set_call_timeout(object, call_timeout);
  root_ = CosNaming::NamingContextExt::_narrow(object);
  if (CORBA::is_nil(root_)) throw CORBA::OBJECT_NOT_EXIST();
  corba::set_call_timeout(root_, call_timeout);
}

bool CorbaNaming::isAlive() {
  try {
    return !CORBA::is_nil(root_) && !root_->_non_existent();
  } catch (const CORBA::Exception&) {
    return false;
  }
}

void CorbaNaming::bind(const CosNaming::Name& name, CORBA::Object_ptr object, bool force) {
  try {
    root_->bind(name, object);
  } catch (const CosNaming::NamingContext::NotFound&) {
    if (!force) throw;
    bindRecursive(root_, name, object);
  }
}

void CorbaNaming::bindByString(const char* name, CORBA::Object_ptr object, bool force) { bind(name_of(name), object, force); }

void CorbaNaming::bindRecursive(CosNaming::NamingContext_ptr context, const CosNaming::Name& name, CORBA::Object_ptr object) {
  for (CORBA::ULong length = 1; length < name.length(); ++length) {
    CosNaming::Name prefix = name;
    prefix.length(length);
    try {
      CosNaming::NamingContext_var made = context->bind_new_context(prefix);
    } catch (const CosNaming::NamingContext::AlreadyBound&) {  // as good
    }
  }
  context->bind(name, object);
}

void CorbaNaming::rebind(const CosNaming::Name& name, CORBA::Object_ptr object, bool force) {
  if (force) {
    corba::rebind_recursive(root_, name, object);
  } else {
    root_->rebind(name, object);
  }
}

void CorbaNaming::rebindByString(const char* name, CORBA::Object_ptr object, bool force) { rebind(name_of(name), object, force); }

void CorbaNaming::rebindRecursive(CosNaming::NamingContext_ptr context, const CosNaming::Name& name, CORBA::Object_ptr object) {
  corba::rebind_recursive(context, name, object);
}

void CorbaNaming::bindContext(const CosNaming::Name& name, CosNaming::NamingContext_ptr context, bool force) {
  if (force && name.length() > 1) {
    for (CORBA::ULong length = 1; length < name.length(); ++length) {
      CosNaming::Name prefix = name;
      prefix.length(length);
      try {
        CosNaming::NamingContext_var made = root_->bind_new_context(prefix);
      } catch (const CosNaming::NamingContext::AlreadyBound&) {  // as good
      }
    }
  }
  root_->bind_context(name, context);
}

void CorbaNaming::bindContext(const char* name, CosNaming::NamingContext_ptr context, bool force) {
  bindContext(name_of(name), context, force);
}

void CorbaNaming::rebindContext(const CosNaming::Name& name, CosNaming::NamingContext_ptr context, bool force) {
  try {
    root_->rebind_context(name, context);
  } catch (const CosNaming::NamingContext::NotFound&) {
    if (!force) throw;
    bindContext(name, context, true);
  }
}

void CorbaNaming::rebindContext(const char* name, CosNaming::NamingContext_ptr context, bool force) {
  rebindContext(name_of(name), context, force);
}

CORBA::Object_ptr CorbaNaming::resolve(const CosNaming::Name& name) { return root_->resolve(name); }
CORBA::Object_ptr CorbaNaming::resolve(const char* name) { return resolve(name_of(name)); }
CORBA::Object_ptr CorbaNaming::resolveStr(const char* name) { return root_->resolve_str(name); }
void CorbaNaming::unbind(const CosNaming::Name& name) { root_->unbind(name); }
void CorbaNaming::unbind(const char* name) { unbind(name_of(name)); }
CosNaming::NamingContext_ptr CorbaNaming::newContext() { return root_->new_context(); }

CosNaming::NamingContext_ptr CorbaNaming::bindNewContext(const CosNaming::Name& name, bool force) {
  try {
    return root_->bind_new_context(name);
  } catch (const CosNaming::NamingContext::NotFound&) {
    if (!force || name.length() < 2) throw;
    CosNaming::NamingContext_var parent = bindNewContext(prefix_of(name), true);
    return root_->bind_new_context(name);
  }
}

CosNaming::NamingContext_ptr CorbaNaming::bindNewContext(const char* name, bool force) { return bindNewContext(name_of(name), force); }
void CorbaNaming::destroy(CosNaming::NamingContext_ptr context) { context->destroy(); }

namespace {

// False for a context that is bound again further down: there it is only taken out, and it goes when the walk is back at it.
bool destroy_below(CosNaming::NamingContext_ptr context, corba::ContextWalk& walk) {
  const corba::ContextWalk::Stay stay(walk, context);
  if (!stay) return false;
  CosNaming::BindingList_var bindings;
  CosNaming::BindingIterator_var more;
  constexpr CORBA::ULong at_once = 1000;
  context->list(at_once, bindings, more);
  for (bool has_more = true; has_more;) {
    for (CORBA::ULong i = 0; i < bindings->length(); ++i) {
      const auto& binding = bindings[i];
      CosNaming::NamingContext_var below;
      if (binding.binding_type == CosNaming::ncontext) {
        CORBA::Object_var object = context->resolve(binding.binding_name);
        below = CosNaming::NamingContext::_narrow(object);
      }
      context->unbind(binding.binding_name);
      if (CORBA::is_nil(below)) continue;
      try {
        if (destroy_below(below, walk)) below->destroy();
      } catch (const CORBA::OBJECT_NOT_EXIST&) {  // it was bound twice
      }
    }
    has_more = !CORBA::is_nil(more) && more->next_n(at_once, bindings);
  }
  if (!CORBA::is_nil(more)) more->destroy();
  return true;
}

}  // namespace

void CorbaNaming::destroyRecursive(CosNaming::NamingContext_ptr context) {
  corba::ContextWalk walk;
  destroy_below(context, walk);
}

void CorbaNaming::clearAll() { destroyRecursive(root_); }

void CorbaNaming::list(CosNaming::NamingContext_ptr context, CORBA::ULong how_many, CosNaming::BindingList_var& list,
                       CosNaming::BindingIterator_var& iterator) {
  context->list(how_many, list.out(), iterator.out());
}

void CorbaNaming::list(const char* name, CosNaming::BindingList_var& result) {
  CosNaming::NamingContext_var context = CosNaming::NamingContext::_duplicate(root_);
  if (name != nullptr && *name != '\0') {
    CORBA::Object_var object = resolve(name);
    context = CosNaming::NamingContext::_narrow(object);
    if (CORBA::is_nil(context)) throw CosNaming::NamingContext::InvalidName();
  }
  CosNaming::BindingList_var part;
  CosNaming::BindingIterator_var more;
  constexpr CORBA::ULong at_once = 1000;
  result = new CosNaming::BindingList;
  context->list(at_once, part, more);
  for (bool has_more = true; has_more;) {
    const auto length = result->length();
    result->length(length + part->length());
    for (CORBA::ULong i = 0; i < part->length(); ++i) result[length + i] = part[i];
    has_more = !CORBA::is_nil(more) && more->next_n(at_once, part);
  }
  if (!CORBA::is_nil(more)) more->destroy();
}

void CorbaNaming::listByKind(const char* name, const char* kind, CosNaming::BindingList_var& result) {
  CosNaming::BindingList_var all;
  list(name, all);
  result = new CosNaming::BindingList;
  for (CORBA::ULong i = 0; i < all->length(); ++i) {
    const auto& binding_name = all[i].binding_name;
    if (std::string(binding_name[binding_name.length() - 1].kind) != kind) continue;
    const auto length = result->length();
    result->length(length + 1);
    result[length] = all[i];
  }
}

CosNaming::Name CorbaNaming::toName(const char* text) { return name_of(text); }
char* CorbaNaming::toString(const CosNaming::Name& name) { return CORBA::string_dup(corba::to_text(name).c_str()); }
char* CorbaNaming::toUrl(char* address, char* name) { return root_->to_url(address, name); }

}  // namespace RTC
