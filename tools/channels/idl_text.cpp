#include "channels/idl_text.h"

#include <set>
#include <string_view>
#include <vector>

#include "base/text.h"

namespace channels {

namespace {

constexpr int deepest = 64;  // structures in each other; those of idl/ have five

class Writer {
 public:
  // How a member of this type is written, before and behind its name. What it needs is written first.
  struct Spelling {
    std::string type;
    std::string array;
  };

  Spelling spell(CORBA::TypeCode_ptr type, int depth = 0) {
    if (depth > deepest) return {"any", ""};
    switch (type->kind()) {
      case CORBA::tk_short:
        return {"short", ""};
      case CORBA::tk_long:
        return {"long", ""};
      case CORBA::tk_longlong:
        return {"long long", ""};
      case CORBA::tk_ushort:
        return {"unsigned short", ""};
      case CORBA::tk_ulong:
        return {"unsigned long", ""};
      case CORBA::tk_ulonglong:
        return {"unsigned long long", ""};
      case CORBA::tk_float:
        return {"float", ""};
      case CORBA::tk_double:
        return {"double", ""};
      case CORBA::tk_boolean:
        return {"boolean", ""};
      case CORBA::tk_char:
        return {"char", ""};
      case CORBA::tk_wchar:
        return {"wchar", ""};
      case CORBA::tk_octet:
        return {"octet", ""};
      case CORBA::tk_string:
        return {"string", ""};
      case CORBA::tk_wstring:
        return {"wstring", ""};
      case CORBA::tk_alias: {
        const CORBA::TypeCode_var content = type->content_type();
        return spell(content, depth + 1);
      }
      case CORBA::tk_sequence: {
        const CORBA::TypeCode_var content = type->content_type();
        const std::string bound = type->length() == 0 ? "" : ", " + std::to_string(type->length());
        return {"sequence<" + spell(content, depth + 1).type + bound + ">", ""};
      }
      case CORBA::tk_array: {
        const CORBA::TypeCode_var content = type->content_type();
        const Spelling element = spell(content, depth + 1);
        return {element.type, "[" + std::to_string(type->length()) + "]" + element.array};
      }
      case CORBA::tk_struct:
      case CORBA::tk_enum:
        define(type, depth);
        return {scoped_name(type->id()), ""};
      default:
        return {"any", ""};  // no data type has these
    }
  }

  const std::string& text() const { return text_; }

 private:
  void define(CORBA::TypeCode_ptr type, int depth) {
    const std::string name = scoped_name(type->id());
    if (!defined_.insert(name).second) return;
    std::string body;
    if (type->kind() == CORBA::tk_enum) {
      std::vector<std::string> members;
      for (CORBA::ULong i = 0; i < type->member_count(); ++i) members.emplace_back(type->member_name(i));
      body = "enum " + std::string(type->name()) + " { " + base::join(members, ", ") + " };";
    } else {
      body = "struct " + std::string(type->name()) + " {\n";
      for (CORBA::ULong i = 0; i < type->member_count(); ++i) {
        const CORBA::TypeCode_var member_type = type->member_type(i);
        const Spelling member = spell(member_type, depth + 1);
        body += "  " + member.type + " " + type->member_name(i) + member.array + ";\n";
      }
      body += "};";
    }
    std::string closing;
    for (auto end = name.find("::"), begin = std::size_t{0}; end != std::string::npos; begin = end + 2, end = name.find("::", begin)) {
      text_ += "module " + name.substr(begin, end - begin) + " {\n";
      closing += "};\n";
    }
    text_ += body + "\n" + closing;
  }

  std::string text_;
  std::set<std::string> defined_;
};

}  // namespace

std::string scoped_name(const std::string& repository_id) {
  std::string_view name = repository_id;
  if (name.starts_with("IDL:")) name.remove_prefix(4);
  name = name.substr(0, name.rfind(':'));
  std::string scoped;
  for (const char c : name) scoped += c == '/' ? std::string("::") : std::string(1, c);
  return scoped;
}

std::string idl_text(CORBA::TypeCode_ptr type) {
  Writer writer;
  (void)writer.spell(type);
  return writer.text();
}

}  // namespace channels
