// A registry of objects that belong to somebody else, found by name with a predicate. Any thread.
#pragma once

#include <algorithm>
#include <mutex>
#include <vector>

namespace RTC {

// Predicate(identifier)(object*) says whether the object is the one; Predicate(object*)(other*) whether two are the same.
template <typename Identifier, typename Object, typename Predicate>
class ObjectManager {
 public:
  // False if an object that the predicate takes for the same is there already.
  bool registerObject(Object* object) {
    const std::scoped_lock lock(mutex_);
    if (std::any_of(objects_.begin(), objects_.end(), Predicate(object))) return false;
    objects_.push_back(object);
    return true;
  }

  // The object, no longer registered, or nullptr.
  Object* unregisterObject(const Identifier& id) {
    const std::scoped_lock lock(mutex_);
    const auto at = std::find_if(objects_.begin(), objects_.end(), Predicate(id));
    if (at == objects_.end()) return nullptr;
    Object* object = *at;
    objects_.erase(at);
    return object;
  }

  Object* find(const Identifier& id) const {
    const std::scoped_lock lock(mutex_);
    const auto at = std::find_if(objects_.begin(), objects_.end(), Predicate(id));
    return at == objects_.end() ? nullptr : *at;
  }

  std::vector<Object*> getObjects() const {
    const std::scoped_lock lock(mutex_);
    return objects_;
  }

  // The function works on a copy of the list, without the lock.
  template <class Function>
  Function for_each(Function function) {
    for (auto* object : getObjects()) function(object);
    return function;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Object*> objects_;
};

}  // namespace RTC
