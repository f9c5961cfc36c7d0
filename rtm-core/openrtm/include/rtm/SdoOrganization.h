// An organization of SDOs (a composite component and its members): servant of SDOPackage::Organization. Any thread; no lock is held while
// members are called.
#pragma once

#include <rtm/idl/SDOPackageSkel.h>

#include <memory>
#include <string>
#include <vector>

namespace SDOPackage {

class Organization_impl : public virtual POA_SDOPackage::Organization, public virtual PortableServer::RefCountServantBase {
 public:
  explicit Organization_impl(SDOSystemElement_ptr owner);
  ~Organization_impl() override;

  char* get_organization_id() override;
  OrganizationProperty* get_organization_property() override;
  CORBA::Any* get_organization_property_value(const char* name) override;
  CORBA::Boolean add_organization_property(const OrganizationProperty& property) override;
  CORBA::Boolean set_organization_property_value(const char* name, const CORBA::Any& value) override;
  CORBA::Boolean remove_organization_property(const char* name) override;
  SDOSystemElement_ptr get_owner() override;
  CORBA::Boolean set_owner(SDOSystemElement_ptr sdo) override;
  SDOList* get_members() override;
  CORBA::Boolean set_members(const SDOList& sdos) override;
  CORBA::Boolean add_members(const SDOList& sdo_list) override;
  CORBA::Boolean remove_member(const char* id) override;
  DependencyType get_dependency() override;
  CORBA::Boolean set_dependency(DependencyType dependency) override;

  // A new reference; the object is activated by the first call.
  Organization_ptr getObjRef();

 protected:
  // Each with the name it had when it joined, so that one that is gone can be taken out.
  struct Member {
    std::string id;
    SDO_var sdo;
  };
  // The ids of the members, asked of each with a time-out. Throws InvalidParameter for a nil or dead one.
  static std::vector<Member> ask(const SDOList& sdos);
  std::vector<Member> members() const;
  // The old ones.
  std::vector<Member> replaceMembers(std::vector<Member> members);
  void appendMembers(const std::vector<Member>& members);
  // False when there is none of that id.
  bool takeMember(const std::string& id, Member& member);

 private:
  struct Shared;

  const std::string id_;
  const std::unique_ptr<Shared> shared_;
};

}  // namespace SDOPackage
