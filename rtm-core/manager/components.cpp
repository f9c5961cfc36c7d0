// The components that exist: the list, and how they go.
#include <algorithm>

#include "manager/manager_impl.h"

namespace RTC {

// --- the list

std::vector<ManagerImpl::Record> ManagerImpl::records() const {
  std::vector<Record> result;
  const auto locked = state.lock();
  for (const auto& [id, record] : locked->records) result.push_back(record);
  return result;
}

std::optional<ManagerImpl::Record> ManagerImpl::record_of(const RTObject_impl* component) const {
  const auto locked = state.lock();
  for (const auto& [id, record] : locked->records) {
    if (record.component == component) return record;
  }
  return std::nullopt;
}

std::vector<ManagerImpl::Held> ManagerImpl::held_components() const {
  std::vector<Held> components;
  const auto locked = state.lock();
  for (const auto& [id, record] : locked->records) {
    if (record.listed && !record.finalized) components.push_back(manage(record.component));
  }
  return components;
}

ManagerImpl::Held ManagerImpl::held_component(const std::string& instance_name) const {
  for (const auto& component : held_components()) {
    if (instance_name == component->instance_name()) return component;
  }
  return {};
}

ManagerImpl::Held ManagerImpl::held_component(const RTObject_impl* wanted) const {
  for (const auto& component : held_components()) {
    if (component->object() == wanted) return component;
  }
  return {};
}

bool Manager::registerComponent(RTObject_impl* comp) {
  if (comp == nullptr || impl_->record_of(comp)) return false;
  const auto component = manage(comp);
  ManagerImpl::Record record;
  {
    auto locked = impl_->state.lock();
    if (!locked->reserved_names.insert(component->instance_name()).second) return false;
    record.id = ++locked->last_id;
    record.component = comp;
    record.instance_name = component->instance_name();
    record.names = component->naming_names();
    record.object_key = component->category() + "." + record.instance_name;
    record.listed = true;
    locked->records[record.id] = record;
    locked->had_components = true;
  }
  impl_->publish(record);
  return true;
}

bool Manager::unregisterComponent(RTObject_impl* comp) {
  const auto record = impl_->record_of(comp);
  if (!record) return false;
  impl_->withdraw(*record);
  auto locked = impl_->state.lock();
  locked->reserved_names.erase(record->instance_name);
  locked->records.erase(record->id);
  return true;
}

bool Manager::bindExecutionContext(RTObject_impl* comp) {
  const auto component = manage(comp);
  return component && component->bind_contexts();
}

RTObject_impl* Manager::getComponent(const char* instance_name) {
  if (instance_name == nullptr) return nullptr;
  auto locked = impl_->state.lock();
  for (const auto& [id, record] : locked->records) {
    if (record.listed && !record.finalized && record.instance_name == instance_name) return record.component;
  }
  return nullptr;
}

std::vector<RTObject_impl*> Manager::getComponents() {
  std::vector<RTObject_impl*> components;
  auto locked = impl_->state.lock();
  for (const auto& [id, record] : locked->records) {
    if (record.listed && !record.finalized) components.push_back(record.component);
  }
  return components;
}

// --- deletion

void ManagerImpl::finalized(RTObject_impl* component) {
  std::uint64_t id = 0;
  {
    auto locked = state.lock();
    for (auto& [key, record] : locked->records) {
      if (record.component != component || record.finalized) continue;
      record.finalized = true;
      // A component whose creation failed is destroyed by its creator.
      if (record.listed) id = key;
    }
  }
  if (id != 0 && cleaner) cleaner->post([this, id] { destroy(id); });
}

void ManagerImpl::destroy(std::uint64_t id) {
  Record record;
  {
    auto locked = state.lock();
    const auto at = locked->records.find(id);
    if (at == locked->records.end() || at->second.component == nullptr) return;
    record = at->second;
    at->second.finalized = true;
  }
  withdraw(record);
  state.lock()->reserved_names.erase(record.instance_name);  // before its number is free, which the next component may get at once
  if (record.numbered) {
    const auto mine = numbering_turn.take(numbering_timeout);
    if (mine && numbering != nullptr) numbering->onDelete(record.component);
    if (!mine) RTC_WARN(("the naming policy is busy with another component; it does not hear that %s goes", record.instance_name.c_str()));
  }
  discard(*record.component);
  {
    // Nobody finds it any more; who is looking at it has a reference.
    auto locked = state.lock();
    locked->records[id].component = nullptr;
    locked->abandoned.push_back(record);
  }
  delete_abandoned();
  bool is_last = false;
  {
    auto locked = state.lock();
    locked->records.erase(id);
    is_last = locked->records.empty() && locked->had_components && locked->activated && locked->phase == Phase::active;
  }
  if (is_last && !is_master() && flag("manager.shutdown_on_nortcs", true) && flag("manager.shutdown_onrtcs", true)) {
    RTC_INFO(("the last component was deleted: exiting"));
    request_end();
  }
}

// Those in whose callbacks no thread is any more.
void ManagerImpl::delete_abandoned() {
  destroy_left_contexts();
  std::vector<Record> free;
  {
    auto locked = state.lock();
    auto& all = locked->abandoned;
    const auto rest =
        std::stable_partition(all.begin(), all.end(), [](const Record& one) { return manage(one.component)->is_held_by_callback(); });
    free.assign(rest, all.end());
    all.erase(rest, all.end());
  }
  for (const Record& record : free)
    if (record.factory) record.factory->destroy(record.component);
}

void Manager::deleteComponent(RTObject_impl* comp) {
  const auto component = impl_->held_component(comp);
  if (!component) return;
  const auto code = component->exit();
  auto& rtclog = impl_->rtclog;
  if (code != RTC_OK) RTC_WARN(("%s: exit answered %d", component->instance_name().c_str(), static_cast<int>(code)));
}

ReturnCode_t Manager::deleteComponent(const char* instance_name) {
  const auto component = impl_->held_component(std::string(instance_name != nullptr ? instance_name : ""));
  return component ? component->exit() : BAD_PARAMETER;
}

void Manager::notifyFinalized(RTObject_impl* comp) { impl_->finalized(comp); }

void Manager::cleanupComponents() {
  if (impl_->cleaner) impl_->cleaner->drain();
}

}  // namespace RTC
