#include "system/naming_tree.h"

#include <omniORB4/Naming.hh>

#include <algorithm>

#include "base/own_account.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "corba/orb/naming.h"

namespace tools {
namespace {

constexpr CORBA::ULong listed_at_once = 256;

EntryKind kind_of(const CosNaming::Binding& binding) {
  const std::string kind = binding.binding_name[0].kind.in();
  if (binding.binding_type == CosNaming::ncontext) return EntryKind::context;
  if (kind == "rtc") return EntryKind::component;
  if (kind == "mgr") return EntryKind::manager;
  return EntryKind::other;
}

std::vector<CosNaming::Binding> bindings_of(CosNaming::NamingContext_ptr context) {
  std::vector<CosNaming::Binding> all;
  CosNaming::BindingList_var list;
  CosNaming::BindingIterator_var rest;
  context->list(listed_at_once, list.out(), rest.out());
  bool more = true;
  while (more) {
    for (CORBA::ULong i = 0; i < list->length(); ++i) {
      if (list[i].binding_name.length() > 0) all.push_back(list[i]);
    }
    more = !CORBA::is_nil(rest) && rest->next_n(listed_at_once, list.out());
  }
  if (!CORBA::is_nil(rest)) rest->destroy();
  return all;
}

// Whether an object of this name is asked for. Its place is not looked at.
bool is_wanted(const Wanted& wanted, const Entry& child) {
  if (wanted.ids) return wanted.ids->contains(child.id);
  return !wanted.address || wanted.address->segments.empty() || matches(wanted.address->segments.back(), child.id, child.kind_text);
}

// What an address cannot mean is listed, but not resolved: that is a call for each name.
void read_context(Entry& entry, CosNaming::NamingContext_ptr context, const Wanted& wanted, corba::ContextWalk& walk) {
  const corba::ContextWalk::Stay stay(walk, context);
  if (!stay) {
    entry.problem = "is one of those around it, or too deep or one of too many";
    return;
  }
  for (const auto& binding : bindings_of(context)) {
    Entry child;
    child.kind = kind_of(binding);
    child.id = binding.binding_name[0].id.in();
    child.kind_text = binding.binding_name[0].kind.in();
    child.segments = entry.segments;
    child.segments.push_back(child.name());
    if (child.kind != EntryKind::context && !is_wanted(wanted, child)) {
      if (!wanted.ids) entry.children.push_back(std::move(child));
      continue;
    }
    try {
      child.object = context->resolve(binding.binding_name);
      if (child.kind == EntryKind::context) {
        const auto inner = CosNaming::NamingContext::_narrow(child.object);
        if (!CORBA::is_nil(inner)) read_context(child, inner, wanted, walk);
      }
    } catch (const CosNaming::NamingContext::NotFound&) {
      continue;  // unbound since it was listed
    } catch (const CORBA::Exception& e) {
      child.health = is_time_out(e) ? Health::hung : Health::zombie;
      child.problem = describe(e);
    }
    entry.children.push_back(std::move(child));
  }
  std::sort(entry.children.begin(), entry.children.end(), [](const Entry& a, const Entry& b) { return a.name() < b.name(); });
}

template <class E>  // Entry or const Entry
void collect(E& entry, std::vector<E*>& objects) {
  for (auto& child : entry.children) {
    if (child.kind == EntryKind::context) {
      collect(child, objects);
    } else {
      objects.push_back(&child);
    }
  }
}

void probe(Entry& entry) {
  if (entry.health != Health::alive) return;
  try {
    if (CORBA::is_nil(entry.object)) {
      entry.health = Health::zombie;
      entry.problem = "is a nil reference";
    } else if (entry.object->_non_existent()) {
      entry.health = Health::zombie;
      entry.problem = "does not exist any more (its process is running)";
    }
  } catch (const CORBA::Exception& e) {
    entry.health = is_time_out(e) ? Health::hung : Health::zombie;
    entry.problem = describe(e);
  }
}

void find_absolute(const Entry& entry, const std::vector<std::string>& segments, std::size_t at, std::vector<const Entry*>& found) {
  if (at == segments.size()) return found.push_back(&entry);
  for (const auto& child : entry.children) {
    if (matches(segments[at], child.id, child.kind_text)) find_absolute(child, segments, at + 1, found);
  }
}

bool ends_with(const Entry& entry, const std::vector<std::string>& tail) {
  if (tail.size() > entry.segments.size()) return false;
  const auto offset = entry.segments.size() - tail.size();
  for (std::size_t i = 0; i < tail.size(); ++i) {
    const auto [id, kind] = split_kind(entry.segments[offset + i]);
    if (!matches(tail[i], id, kind)) return false;
  }
  return true;
}

void find_tail(const Entry& entry, const std::vector<std::string>& tail, std::vector<const Entry*>& found) {
  for (const auto& child : entry.children) {
    if (ends_with(child, tail)) found.push_back(&child);
    find_tail(child, tail, found);
  }
}

bool same_server(std::string a, std::string b) {
  for (auto* name : {&a, &b}) {
    if (name->starts_with("iiop:")) name->erase(0, 5);
    if (name->find(':', name->starts_with("ssliop:") ? 7 : 0) == std::string::npos) *name += ":2809";
    *name = base::with_numeric_host(*name);
  }
  return a == b;
}

// HOST[:PORT], iiop:HOST[:PORT] and over TLS ssliop:HOST[:PORT] as newer tools of the field write it, or a whole corbaloc address.
std::string address_of(const std::string& server) {
  if (server.starts_with("corbaloc:")) return server;
  const bool has_protocol = server.starts_with("iiop:") || server.starts_with("ssliop:");
  return "corbaloc:" + std::string(has_protocol ? "" : ":") + base::with_numeric_host(server) + "/NameService";
}

// When several match, one that is alive beats zombies.
std::vector<const Entry*> living(std::vector<const Entry*> found) {
  std::vector<const Entry*> alive;
  for (const auto* entry : found) {
    if (entry->health != Health::zombie) alive.push_back(entry);
  }
  return alive.empty() ? found : alive;
}

}  // namespace

std::string Entry::name() const { return kind_text.empty() ? escape_name(id) : escape_name(id) + "." + escape_name(kind_text); }
std::string Entry::path() const { return "/" + base::join(segments, "/"); }

Result<NamingTree> NamingTree::read(CORBA::ORB_ptr orb, const std::string& server, std::chrono::milliseconds limit, const Wanted& wanted) {
  NamingTree tree;
  tree.root_.kind = EntryKind::context;
  tree.root_.segments = {server};
  const auto url = address_of(server);
  const CallLimit limited(limit);
  CosNaming::NamingContext_var context;
  const auto reached = remote("name server " + server, [&] {
    tree.root_.object = orb->string_to_object(url.c_str());
    context = CosNaming::NamingContext::_narrow(tree.root_.object);
    corba::ContextWalk walk;
    if (!CORBA::is_nil(context)) read_context(tree.root_, context, wanted, walk);
  });
  if (!reached) {
    return Error{reached.error().message + "; start one with: omniNames -start, or name another with --ns HOST:PORT"};
  }
  if (CORBA::is_nil(context)) return Error{"name server " + server + ": responds, but is not a name server"};
  std::vector<Entry*> objects;
  collect(tree.root_, objects);
  if (wanted.address) {
    const auto meant = tree.candidates(*wanted.address);
    if (!meant) return meant.error();
    std::erase_if(objects, [&](const Entry* object) { return std::find(meant->begin(), meant->end(), object) == meant->end(); });
  }
  in_parallel(objects.size(), limit, [&](std::size_t i) { probe(*objects[i]); });
  return tree;
}

std::vector<const Entry*> NamingTree::objects() const {
  std::vector<const Entry*> objects;
  collect(root_, objects);
  return objects;
}

Result<std::vector<const Entry*>> NamingTree::candidates(const Address& address) const {
  std::vector<const Entry*> found;
  if (address.segments.empty()) return std::vector<const Entry*>{&root_};
  if (address.is_absolute) {
    if (!same_server(address.segments.front(), server())) return Error{"path " + address.text() + ": is not on name server " + server()};
    find_absolute(root_, address.segments, 1, found);
  } else {
    if (same_server(address.segments.front(), server())) find_absolute(root_, address.segments, 1, found);
    if (found.empty()) find_tail(root_, address.segments, found);
  }
  return found;
}

Result<const Entry*> NamingTree::find(const Address& address) const {
  auto meant = candidates(address);
  if (!meant) return meant.error();
  const auto found = living(std::move(*meant));
  if (found.size() == 1) return found.front();
  std::vector<std::string> names;
  if (found.empty()) {
    std::vector<std::string> ids;
    for (const auto* object : objects()) names.push_back(object->name()), ids.push_back(object->id);
    const auto similar = base::suggestion(split_kind(address.segments.back()).first, ids);
    constexpr std::size_t most = 12;
    if (names.size() > most) {
      names.resize(most);
      names.emplace_back("...");
    }
    return Error{"path " + address.text() + ": no such name" +
                 (names.empty() ? ", name server " + server() + " is empty" : "; there are " + base::join(names, ", ") + similar)};
  }
  for (const auto* entry : found) names.push_back(entry->path());
  return Error{"path " + address.text() + ": names several things: " + base::join(names, ", ")};
}

Result<const Entry*> NamingTree::find_component(const Address& address) const {
  auto found = find(address);
  if (!found) return found.error();
  const Entry* entry = *found;
  if (entry->kind != EntryKind::component && entry->kind != EntryKind::other) return Error{entry->path() + ": is no component"};
  if (entry->health != Health::alive) return Error{"component " + entry->path() + " " + entry->problem};
  return entry;
}

Result<void> unbind(CORBA::ORB_ptr orb, const Entry& entry) {
  return remote("unbinding " + entry.path(), [&] {
    const auto url = address_of(entry.segments.front());
    CORBA::Object_var object = orb->string_to_object(url.c_str());
    const auto root = CosNaming::NamingContext::_narrow(object);
    CosNaming::Name name;
    name.length(static_cast<CORBA::ULong>(entry.segments.size() - 1));
    for (std::size_t i = 1; i < entry.segments.size(); ++i) {
      const auto [id, kind] = split_kind(entry.segments[i]);
      name[static_cast<CORBA::ULong>(i - 1)].id = id.c_str();
      name[static_cast<CORBA::ULong>(i - 1)].kind = kind.c_str();
    }
    if (!CORBA::is_nil(root)) root->unbind(name);
  });
}

}  // namespace tools
