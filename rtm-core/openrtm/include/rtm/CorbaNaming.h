// A name server as component authors use it. Names as text: components separated by /, id and kind by a dot, backslash escapes both.
// Any thread. Errors are the exceptions of CosNaming::NamingContext and CORBA system exceptions.
#pragma once

#include <rtm/RTC.h>

#include <string>
#include <vector>

namespace RTC {

class CorbaNaming {
 public:
  // What its calls throw, as sources that catch it name it.
  using SystemException = CORBA::SystemException;
  using NotFound = CosNaming::NamingContext::NotFound;
  using CannotProceed = CosNaming::NamingContext::CannotProceed;
  using InvalidName = CosNaming::NamingContext::InvalidName;
  using AlreadyBound = CosNaming::NamingContext::AlreadyBound;
  using NotEmpty = CosNaming::NamingContext::NotEmpty;

  explicit CorbaNaming(CORBA::ORB_ptr orb);
  // name_server: host, host:port or corbaloc URL. Throws if it cannot be reached.
  CorbaNaming(CORBA::ORB_ptr orb, const char* name_server);

  void init(const char* name_server);
  void initByUrl(const char* url) { init(url); }
  bool isAlive();

  // force: intermediate contexts are made.
  void bind(const CosNaming::Name& name, CORBA::Object_ptr object, bool force = true);
  void bindByString(const char* name, CORBA::Object_ptr object, bool force = true);
  void bindRecursive(CosNaming::NamingContext_ptr context, const CosNaming::Name& name, CORBA::Object_ptr object);
  void rebind(const CosNaming::Name& name, CORBA::Object_ptr object, bool force = true);
  void rebindByString(const char* name, CORBA::Object_ptr object, bool force = true);
  void rebindRecursive(CosNaming::NamingContext_ptr context, const CosNaming::Name& name, CORBA::Object_ptr object);
  void bindContext(const CosNaming::Name& name, CosNaming::NamingContext_ptr context, bool force = true);
  void bindContext(const char* name, CosNaming::NamingContext_ptr context, bool force = true);
  void rebindContext(const CosNaming::Name& name, CosNaming::NamingContext_ptr context, bool force = true);
  void rebindContext(const char* name, CosNaming::NamingContext_ptr context, bool force = true);

  // The caller releases the reference.
  CORBA::Object_ptr resolve(const CosNaming::Name& name);
  CORBA::Object_ptr resolve(const char* name);
  CORBA::Object_ptr resolveByString(const char* name) { return resolve(name); }
  // The naming service's own resolve_str.
  CORBA::Object_ptr resolveStr(const char* name);

  void unbind(const CosNaming::Name& name);
  void unbind(const char* name);
  CosNaming::NamingContext_ptr newContext();
  CosNaming::NamingContext_ptr bindNewContext(const CosNaming::Name& name, bool force = true);
  CosNaming::NamingContext_ptr bindNewContext(const char* name, bool force = true);
  void destroy(CosNaming::NamingContext_ptr context);
  // Unbinds and destroys everything below the context.
  void destroyRecursive(CosNaming::NamingContext_ptr context);
  void clearAll();
  void list(CosNaming::NamingContext_ptr context, CORBA::ULong how_many, CosNaming::BindingList_var& list,
            CosNaming::BindingIterator_var& iterator);
  void list(const char* name, CosNaming::BindingList_var& list);
  // Every binding of that kind in the context of that name.
  void listByKind(const char* name, const char* kind, CosNaming::BindingList_var& list);

  // Throws CosNaming::NamingContext::InvalidName.
  CosNaming::Name toName(const char* text);
  char* toString(const CosNaming::Name& name);
  char* toUrl(char* address, char* name);

  // Borrowed.
  CosNaming::NamingContext_ptr getRootContext() { return root_.in(); }
  const char* getNameServer() const { return name_server_.c_str(); }
  bool objIsNil(CORBA::Object_ptr object) const { return CORBA::is_nil(object); }

 private:
  CORBA::ORB_var orb_;
  std::string name_server_;
  CosNaming::NamingContextExt_var root_;
};

}  // namespace RTC
