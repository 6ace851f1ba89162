#pragma once

#include <iterator>
#include <optional>

#include "perception/cas/cas.h"

namespace loci::perception::types {

template <typename P>
class ListFeature;

/// Base of the generated proxies: a feature structure whose features are members, so that code has no string
/// identifiers: `scene.timestamp.get()`. A proxy is a handle, as cheap to copy as a FeatureStructure and as
/// valid.
///
/// A proxy gains functions without touching generated files by deriving from it (docs/architecture.md,
/// "Types"):
///
///     class Thermometer : public Temperature {
///      public:
///       using Temperature::Temperature;
///       double fahrenheit() const { return celsius.get() * 9 / 5 + 32; }
///     };
///     Thermometer t = types::as<Thermometer>(fs);
class Top {
 public:
  static constexpr std::string_view kTypeName = "uima.cas.TOP";

  Top() = default;
  explicit Top(const cas::FeatureStructure& structure) : structure_(structure) {}

  const cas::FeatureStructure& structure() const { return structure_; }
  operator const cas::FeatureStructure&() const { return structure_; }
  explicit operator bool() const { return !structure_.is_null(); }
  friend bool operator==(const Top& one, const Top& two) { return one.structure_ == two.structure_; }
  cas::Cas& cas() const { return structure_.cas(); }
  cas::Type type() const { return structure_.type(); }

  void add_to_index(std::string_view view = "default") const { structure_.add_to_index(view); }
  void remove_from_index(std::string_view view = "default") const { structure_.remove_from_index(view); }
  /// Deletes the feature structure; lists and filters pass over it from then on.
  void remove() const { structure_.remove(); }

 private:
  cas::FeatureStructure structure_;
};

/// Whether the feature structure is of the proxy's type or a subtype, present and not deleted.
template <typename P>
bool is(const cas::FeatureStructure& structure) {
  return structure && !structure.is_deleted() && structure.is_a(P::kTypeName);
}

/// The proxy of a feature structure of its type; nothing for null, deleted and other ones.
template <typename P>
std::optional<P> try_as(const cas::FeatureStructure& structure) {
  return is<P>(structure) ? std::optional<P>(P(structure)) : std::nullopt;
}

/// The same, but throws Error.
template <typename P>
P as(const cas::FeatureStructure& structure) {
  if (!structure.is_a(P::kTypeName))
    throw Error("a " + structure.type().name() + " is no " + std::string(P::kTypeName));
  return P(structure);
}

/// All indexed feature structures of the proxy's type and its subtypes, in the order of the index.
template <typename P>
std::vector<P> select(const cas::Cas& cas, std::string_view view = "default") {
  std::vector<P> found;
  for (const cas::FeatureStructure& each : cas.select(P::kTypeName, view)) found.emplace_back(each);
  return found;
}

/// What all features have.
class FeatureBase {
 public:
  FeatureBase() = default;
  FeatureBase(const cas::FeatureStructure& owner, const char* name) : owner_(owner), name_(name) {}

  bool is_set() const { return owner_.is_set(feature()); }
  void unset() const { owner_.clear(feature()); }
  cas::Feature feature() const { return owner_.feature(name_); }

 protected:
  cas::FeatureStructure owner_;
  const char* name_ = "";
};

/// A number, boolean or text. Unset: 0, false, "".
template <typename T>
class PrimitiveFeature : public FeatureBase {
 public:
  using FeatureBase::FeatureBase;
  T get() const { return owner_.get<T>(feature()); }
  void set(const T& value) const { owner_.set(feature(), value); }
  /// The value, or `fallback` when it is unset.
  T get_or(const T& fallback) const { return is_set() ? get() : fallback; }
};

/// A reference. Unset: a null proxy, which converts to false.
template <typename P>
class ReferenceFeature : public FeatureBase {
 public:
  using FeatureBase::FeatureBase;
  P get() const { return P(owner_.get<cas::FeatureStructure>(feature())); }
  void set(const P& value) const { owner_.set(feature(), static_cast<const cas::FeatureStructure&>(value)); }
  /// What is there, or a new one that is put there: `cluster.centroid.get_or_create().x.set(1.0)`.
  P get_or_create() const {
    if (P found = get()) return found;
    P created = P::create(owner_.cas());
    set(created);
    return created;
  }
};

/// An array of numbers, booleans or texts, shared and immutable: reading copies nothing, setting makes a new
/// one.
template <typename T>
class ArrayFeature : public FeatureBase {
 public:
  using FeatureBase::FeatureBase;
  cas::Buffer<T> get() const { return owner_.array<T>(feature()); }
  void set(const cas::Buffer<T>& values) const { owner_.set_array(feature(), values); }
  void set(std::vector<T> values) const requires(!std::is_same_v<T, bool>) {
    set(cas::Buffer<T>(std::move(values)));
  }
  void set(std::initializer_list<T> values) const {
    set(cas::Buffer<T>::copy({values.begin(), values.size()}));
  }
  std::vector<T> to_vector() const {
    const auto values = get();
    return {values.begin(), values.end()};
  }
  size_t size() const { return get().size(); }
};

/// A list of strings, integers or floats (StringList and so on).
template <typename T>
class ValueListFeature : public FeatureBase {
 public:
  using FeatureBase::FeatureBase;
  std::vector<T> get() const { return owner_.list(feature()).template values<T>(); }
  void set(const std::vector<T>& values) const { owner_.list(feature()).assign_values(values); }
  void push_back(const T& value) const { owner_.list(feature()).push_back_value(value); }
  size_t size() const { return owner_.list(feature()).size(); }
  bool empty() const { return size() == 0; }
  void clear() const { owner_.list(feature()).clear(); }
};

/// Feature structures in an FSArray or FSList. Iterating goes over what was in it at the beginning, so the
/// list may change meanwhile; null and deleted elements are passed over.
template <typename P>
class ListFeature : public FeatureBase {
 public:
  using FeatureBase::FeatureBase;

  class Iterator {
   public:
    using value_type = P;
    using difference_type = std::ptrdiff_t;
    using iterator_category = std::input_iterator_tag;
    using reference = P;
    using pointer = void;
    explicit Iterator(std::shared_ptr<const std::vector<P>> elements = nullptr)
        : elements_(std::move(elements)) {}
    P operator*() const { return (*elements_)[next_]; }
    Iterator& operator++() { return ++next_, *this; }
    Iterator operator++(int) {
      Iterator old(*this);
      ++next_;
      return old;
    }
    bool operator==(std::default_sentinel_t) const { return next_ >= elements_->size(); }

   private:
    std::shared_ptr<const std::vector<P>> elements_;
    size_t next_ = 0;
  };
  Iterator begin() const { return Iterator(std::make_shared<const std::vector<P>>(to_vector())); }
  std::default_sentinel_t end() const { return {}; }

  std::vector<P> to_vector() const { return filter<P>(); }
  /// Elements of a subtype: `cluster.annotations.filter<types::LocationAnnotation>()`.
  template <typename Q>
  std::vector<Q> filter() const {
    std::vector<Q> found;
    for (const cas::FeatureStructure& each : list().structures())
      if (is<Q>(each)) found.emplace_back(each);
    return found;
  }
  /// The first of a subtype; a null proxy when there is none.
  template <typename Q>
  Q first() const {
    for (const cas::FeatureStructure& each : list().structures())
      if (is<Q>(each)) return Q(each);
    return Q();
  }
  /// Number of elements, null and deleted ones included.
  size_t size() const { return list().size(); }
  bool empty() const { return size() == 0; }
  P operator[](size_t index) const { return P(list().at(index)); }
  void push_back(const P& element) const { list().push_back(element); }
  void set(const std::vector<P>& elements) const {
    list().assign(std::vector<cas::FeatureStructure>(elements.begin(), elements.end()));
  }
  /// Takes an element out of the list; false when it was not in.
  bool erase(const P& element) const { return list().erase(element); }
  void clear() const { list().clear(); }

 private:
  cas::List list() const { return owner_.list(feature()); }
};

}  // namespace loci::perception::types
