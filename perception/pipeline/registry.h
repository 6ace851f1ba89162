#pragma once

#include <functional>
#include <map>
#include <memory>

#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// Annotators, readers and CAS multipliers by name. The program that runs a pipeline builds it explicitly.
class AnnotatorRegistry {
 public:
  template <class T>
  void add() {
    annotators_[T().descriptor().name] = [] { return std::make_unique<T>(); };
  }
  /// For those that are not made by a default constructor.
  void add(const std::string& name, std::function<std::unique_ptr<Annotator>()> maker) {
    annotators_[name] = std::move(maker);
  }
  template <class T>
  void add_reader() {
    readers_[T().descriptor().name] = [] { return std::make_unique<T>(); };
  }

  template <class T>
  void add_multiplier() {
    multipliers_[T().descriptor().name] = [] { return std::make_unique<T>(); };
  }

  /// Adds all entries of another registry. Error, with `place`, when a name exists already.
  void merge(const AnnotatorRegistry& more, const FileLocation& place);

  std::vector<std::string> annotators() const;   ///< sorted
  std::vector<std::string> readers() const;      ///< sorted
  std::vector<std::string> multipliers() const;  ///< sorted
  /// A fresh one with default options. Error that names the nearest known one when there is none of this
  /// name.
  std::unique_ptr<Annotator> make(const std::string& name, const FileLocation& place = {}) const;
  /// What makes it; stays good when the registry is gone.
  std::function<std::unique_ptr<Annotator>()> maker(const std::string& name,
                                                    const FileLocation& place = {}) const;
  std::unique_ptr<Reader> make_reader(const std::string& name, const FileLocation& place = {}) const;
  std::unique_ptr<CasMultiplier> make_multiplier(const std::string& name,
                                                 const FileLocation& place = {}) const;
  /// The annotators and readers that output a type or view without having it as an input.
  std::vector<std::string> producers_of(const std::string& product) const;

 private:
  std::map<std::string, std::function<std::unique_ptr<Annotator>()>> annotators_;
  std::map<std::string, std::function<std::unique_ptr<Reader>()>> readers_;
  std::map<std::string, std::function<std::unique_ptr<CasMultiplier>()>> multipliers_;
};

/// The descriptor of an annotator or reader as JSON, with its options (unit, default, bounds).
Json describe(const AnnotatorDescriptor& descriptor, const OptionTable& options);
/// The same for people.
std::string description_text(const AnnotatorDescriptor& descriptor, const OptionTable& options);

}  // namespace loci::perception
