#pragma once

#include <map>
#include <memory>
#include <string>
#include <typeindex>

#include "mapping/base/error.h"

namespace loci::perception {

/// What annotators share and the pipeline itself knows nothing about: a recording, a map, a memory. At most
/// one of each C++ type. Owned jointly; put in place by who starts the pipeline.
class Resources {
 public:
  template <class T>
  void put(std::shared_ptr<T> resource) {
    resources_[typeid(T)] = {std::move(resource), false};
  }
  /// One that must not outlive the run (a file that is to be closed): annotators with a time limit, which may
  /// be left behind, do not get it.
  template <class T>
  void put_for_run(std::shared_ptr<T> resource) {
    resources_[typeid(T)] = {std::move(resource), true};
  }
  /// All that may outlive the run.
  Resources lasting() const {
    Resources copy;
    for (const auto& [type, kept] : resources_)
      if (!kept.for_run) copy.resources_.emplace(type, kept);
    return copy;
  }
  /// nullptr when there is none.
  template <class T>
  T* find() const {
    const auto it = resources_.find(typeid(T));
    return it == resources_.end() ? nullptr : static_cast<T*>(it->second.resource.get());
  }
  /// Error that says what is missing and what to do when there is none.
  template <class T>
  T& get(const std::string& what, const std::string& hint = {}) const {
    if (T* found = find<T>()) return *found;
    throw Error("there is no " + what, {}, hint);
  }

 private:
  struct Kept {
    std::shared_ptr<void> resource;
    bool for_run = false;
  };
  std::map<std::type_index, Kept> resources_;
};

}  // namespace loci::perception
