#pragma once

#include <functional>
#include <map>
#include <memory>

#include "perception/pipeline/annotator.h"
#include "perception/pipeline/multiplier.h"

namespace loci::perception {

/// Which annotators, readers and CAS multipliers there are, by name. Built explicitly by who starts a
/// pipeline.
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

  /// Takes over what another one has. Error, with `place`, when a name is taken.
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
  /// The annotators and readers that make something without needing it themselves.
  std::vector<std::string> makers_of(const std::string& product) const;

 private:
  std::map<std::string, std::function<std::unique_ptr<Annotator>()>> annotators_;
  std::map<std::string, std::function<std::unique_ptr<Reader>()>> readers_;
  std::map<std::string, std::function<std::unique_ptr<CasMultiplier>()>> multipliers_;
};

/// An annotator's or reader's declaration: name, sentence, needs, makes, options with unit, default, bounds.
Json describe(const AnnotatorDescriptor& descriptor, const OptionTable& options);
/// The same for people.
std::string description_text(const AnnotatorDescriptor& descriptor, const OptionTable& options);

}  // namespace loci::perception
