// Makes objects of an abstract class by name. Any thread.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "coil/Properties.h"
#include "coil/Singleton.h"

namespace coil {

template <class AbstractClass, class ConcreteClass>
AbstractClass* Creator() {
  return new ConcreteClass();
}

template <class AbstractClass, class ConcreteClass>
void Destructor(AbstractClass*& object) {
  if (object == nullptr || dynamic_cast<ConcreteClass*>(object) == nullptr) return;
  delete object;
  object = nullptr;
}

enum class FactoryReturn { OK, ERROR, ALREADY_EXISTS, NOT_FOUND, INVALID_ARG, UNKNOWN_ERROR };
// Sources of 1.x compare with the number.
constexpr bool operator==(FactoryReturn code, int number) { return static_cast<int>(code) == number; }
constexpr bool operator==(int number, FactoryReturn code) { return code == number; }
constexpr bool operator!=(FactoryReturn code, int number) { return !(code == number); }
constexpr bool operator!=(int number, FactoryReturn code) { return !(code == number); }

template <class AbstractClass, typename Identifier = std::string, typename Compare = std::less<Identifier>,
          typename CreatorType = std::function<AbstractClass*()>, typename DestructorType = std::function<void(AbstractClass*&)>>
class Factory {
 public:
  // The spellings of 1.x.
  using ReturnCode = FactoryReturn;
  static constexpr FactoryReturn FACTORY_OK = FactoryReturn::OK;
  static constexpr FactoryReturn FACTORY_ERROR = FactoryReturn::ERROR;
  static constexpr FactoryReturn ALREADY_EXISTS = FactoryReturn::ALREADY_EXISTS;
  static constexpr FactoryReturn NOT_FOUND = FactoryReturn::NOT_FOUND;
  static constexpr FactoryReturn INVALID_ARG = FactoryReturn::INVALID_ARG;
  static constexpr FactoryReturn UNKNOWN_ERROR = FactoryReturn::UNKNOWN_ERROR;

  bool hasFactory(const Identifier& id) const {
    std::lock_guard lock(mutex_);
    return makers_.count(id) != 0;
  }

  std::vector<Identifier> getIdentifiers() const {
    std::lock_guard lock(mutex_);
    std::vector<Identifier> ids;
    for (const auto& [id, maker] : makers_) ids.push_back(id);
    return ids;
  }

  // The properties tell users of this factory about the objects.
  FactoryReturn addFactory(const Identifier& id, CreatorType creator, DestructorType destructor, const Properties& properties = {}) {
    if (!creator || !destructor) return FactoryReturn::INVALID_ARG;
    std::lock_guard lock(mutex_);
    return makers_.emplace(id, Maker{creator, destructor, properties}).second ? FactoryReturn::OK : FactoryReturn::ALREADY_EXISTS;
  }

  FactoryReturn removeFactory(const Identifier& id) {
    std::lock_guard lock(mutex_);
    return makers_.erase(id) != 0 ? FactoryReturn::OK : FactoryReturn::NOT_FOUND;
  }

  // Empty for an unknown identifier.
  Properties getProperties(const Identifier& id) const {
    std::lock_guard lock(mutex_);
    const auto it = makers_.find(id);
    return it == makers_.end() ? Properties() : it->second.properties;
  }

  // nullptr for an unknown identifier.
  AbstractClass* createObject(const Identifier& id) {
    Maker maker;
    {
      std::lock_guard lock(mutex_);
      auto it = makers_.find(id);
      if (it == makers_.end()) return nullptr;
      maker = it->second;
    }
    AbstractClass* object = maker.create();
    if (object == nullptr) return nullptr;
    std::lock_guard lock(mutex_);
    objects_[object] = {id, maker};
    return object;
  }

  // Destroys an object of this factory and sets the pointer to nullptr.
  FactoryReturn deleteObject(const Identifier& /*id*/, AbstractClass*& object) { return deleteObject(object); }
  FactoryReturn deleteObject(AbstractClass*& object) {
    Maker maker;
    {
      std::lock_guard lock(mutex_);
      auto it = objects_.find(object);
      if (it == objects_.end()) return FactoryReturn::NOT_FOUND;
      maker = it->second.maker;
      objects_.erase(it);
    }
    maker.destroy(object);
    return FactoryReturn::OK;
  }

  std::vector<AbstractClass*> createdObjects() const {
    std::lock_guard lock(mutex_);
    std::vector<AbstractClass*> out;
    for (const auto& [object, entry] : objects_) out.push_back(object);
    return out;
  }

  bool isProducerOf(AbstractClass* object) const {
    std::lock_guard lock(mutex_);
    return objects_.count(object) != 0;
  }

  FactoryReturn objectToIdentifier(AbstractClass* object, Identifier& id) const {
    std::lock_guard lock(mutex_);
    auto it = objects_.find(object);
    if (it == objects_.end()) return FactoryReturn::NOT_FOUND;
    id = it->second.id;
    return FactoryReturn::OK;
  }

  CreatorType objectToCreator(AbstractClass* object) const {
    std::lock_guard lock(mutex_);
    auto it = objects_.find(object);
    return it == objects_.end() ? CreatorType{} : it->second.maker.create;
  }

  DestructorType objectToDestructor(AbstractClass* object) const {
    std::lock_guard lock(mutex_);
    auto it = objects_.find(object);
    return it == objects_.end() ? DestructorType{} : it->second.maker.destroy;
  }

 private:
  struct Maker {
    CreatorType create{};
    DestructorType destroy{};
    Properties properties{};
  };
  struct Entry {
    Identifier id;
    Maker maker;
  };

  mutable std::mutex mutex_;
  std::map<Identifier, Maker, Compare> makers_;
  std::map<AbstractClass*, Entry> objects_;
};

// The one factory of an abstract class in this process.
template <class AbstractClass, typename Identifier = std::string, typename Compare = std::less<Identifier>,
          typename CreatorType = std::function<AbstractClass*()>, typename DestructorType = std::function<void(AbstractClass*&)>>
class GlobalFactory : public Factory<AbstractClass, Identifier, Compare, CreatorType, DestructorType>,
                      public Singleton<GlobalFactory<AbstractClass, Identifier, Compare, CreatorType, DestructorType>> {
  friend class Singleton<GlobalFactory>;
  GlobalFactory() = default;
};

}  // namespace coil
