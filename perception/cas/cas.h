#pragma once

#include <deque>
#include <functional>
#include <map>
#include <unordered_set>

#include "perception/cas/feature_structure.h"

namespace loci::perception::cas {

/// What `select` found: a list of handles, in the order in which they were indexed, or sorted.
class Selection {
 public:
  explicit Selection(std::vector<FeatureStructure> found) : found_(std::move(found)) {}

  auto begin() const { return found_.begin(); }
  auto end() const { return found_.end(); }
  size_t size() const { return found_.size(); }
  bool empty() const { return found_.empty(); }
  const FeatureStructure& front() const { return found_.at(0); }
  const FeatureStructure& operator[](size_t index) const { return found_.at(index); }

  Selection filter(const std::function<bool(const FeatureStructure&)>& keep) const;

 private:
  std::vector<FeatureStructure> found_;
};

/// Something in a view's index, with its place in the order in which things were added.
struct IndexEntry {
  uint64_t sequence;
  uint32_t id;
};

/// One subject of analysis (a colour image, a cloud, ...) with its data and its index of feature structures.
class View {
 public:
  View(Cas& cas, std::string name) : cas_(&cas), name_(std::move(name)) {}
  View(const View&) = delete;
  View& operator=(const View&) = delete;

  const std::string& name() const { return name_; }
  Cas& cas() const { return *cas_; }

  /// The subject itself: a feature structure of type uima.cas.Sofa, made on demand. Its sofaNum stays unset:
  /// it would depend on the order in which views were made, and is left to formats that need one.
  FeatureStructure sofa();
  FeatureStructure existing_sofa() const { return sofa_; }
  /// Makes a feature structure of type uima.cas.Sofa this view's subject; throws when it has one already.
  void adopt_sofa(const FeatureStructure& sofa);
  void set_sofa_text(std::string text, std::string mime_type = "text/plain");
  void set_sofa_uri(std::string uri, std::string mime_type);
  /// Any feature structure: an array, or a structure such as an image.
  void set_sofa_data(const FeatureStructure& data, std::string mime_type);
  FeatureStructure sofa_data() const;  ///< null when there is none
  std::string mime_type() const;

  /// Indexing twice is the same as once.
  void add_to_index(const FeatureStructure& structure);
  void remove_from_index(const FeatureStructure& structure);
  /// All indexed feature structures of the type and its subtypes, in the order in which they were added.
  Selection select(Type type) const;
  Selection select(std::string_view type_name) const;
  Selection all() const;

 private:
  friend class Cas;
  void replace_sofa(const FeatureStructure& sofa);

  Cas* cas_;
  std::string name_;
  FeatureStructure sofa_;
  std::map<int, std::vector<IndexEntry>> index_;  ///< by Type::order(), so that subtypes are a range
  std::unordered_set<uint32_t> members_;
  uint64_t next_sequence_ = 0;
};

/// The Common Analysis Structure: the typed heap and blackboard that annotators share. One thread writes at a
/// time; handles stay valid until the CAS dies.
class Cas {
 public:
  explicit Cas(std::shared_ptr<const TypeSystem> type_system);
  Cas(const Cas&) = delete;
  Cas& operator=(const Cas&) = delete;

  const TypeSystem& type_system() const { return *type_system_; }
  const std::shared_ptr<const TypeSystem>& shared_type_system() const { return type_system_; }

  /// A new feature structure with everything unset. Primitive types cannot be created.
  FeatureStructure create(Type type);
  FeatureStructure create(std::string_view type_name) { return create(type_system_->type(type_name)); }
  /// A new array that shares the buffer's memory.
  template <typename T>
  FeatureStructure create_array(const Buffer<T>& values) {
    return create_array(kind_of<T>(), values);
  }
  FeatureStructure create_array(Kind component, RawBuffer values);
  FeatureStructure create_array(const std::vector<FeatureStructure>& elements);

  /// The view of this name, created on demand.
  View& view(std::string_view name = "default");
  View* find_view(std::string_view name);
  const View* find_view(std::string_view name) const;
  std::vector<std::string> view_names() const;  ///< sorted
  /// Selects over one view; empty when there is no such view.
  Selection select(std::string_view type_name, std::string_view view = "default") const;

  /// Deletes a feature structure (see FeatureStructure::remove).
  void remove(const FeatureStructure& structure);
  /// How many were created, deleted ones included. Ids run from 1 to this.
  size_t size() const { return heap_.size(); }

  // Working on the side, and taking back (branch.cpp).

  /// A copy on which somebody works while others work on this one or on copies of their own. Buffers of
  /// numbers are shared, so it costs what the structures do, not what the images do.
  std::unique_ptr<Cas> branch() const;
  /// Brings home what was done in a branch of this CAS, whatever has been done here meanwhile. New structures
  /// get the next ids, in their order; what both appended to one list comes one after the other; of a feature
  /// that both set the branch's value stays.
  void merge(const Cas& branch);

  /// From here on changes can be taken back. Nested: keeping hands them to the outer one.
  void begin_changes();
  void keep_changes();
  void undo_changes();
  /// What was made or written to since the last begin_changes(), without what was deleted; in order of id.
  std::vector<FeatureStructure> changes() const;
  /// The views whose subject was set since then, sorted.
  std::vector<std::string> changed_views() const;

  /// Selections and facades pass over a hidden structure: a branch that works on a part hides the rest. Is
  /// no change that merge() would bring home.
  void hide(const FeatureStructure& structure) { hidden_.insert(structure.id()); }
  bool is_hidden(const FeatureStructure& structure) const { return is_hidden(structure.id()); }
  bool is_hidden(uint32_t id) const { return !hidden_.empty() && hidden_.contains(id); }

 private:
  friend class FeatureStructure;
  friend class View;
  struct Record {
    Type type;
    bool deleted = false;
    std::vector<Value> values;
    RawBuffer buffer;                ///< of an array of numbers, booleans, strings
    std::vector<uint32_t> elements;  ///< of an FSArray
  };
  /// Throws Error when it was deleted.
  const Record& record(uint32_t id) const;
  Record& writable(uint32_t id);

  /// What to know to take changes back, or to repeat them elsewhere.
  struct IndexChange {
    std::string view;
    IndexEntry entry;
    bool added;
  };
  struct Journal {
    size_t size = 0;                                ///< structures that there were
    std::map<uint32_t, Record> before;              ///< those of them that were written to, as they were
    std::vector<IndexChange> index;                 ///< in order
    std::map<std::string, FeatureStructure> sofas;  ///< subjects of views that got another, as they were
    std::vector<std::string> views;                 ///< that were made
  };
  void remember(uint32_t id, const Record& record);
  void note_index(const std::string& view, const IndexEntry& entry, bool added);
  void note_sofa(const std::string& view, const FeatureStructure& before);
  class Merge;

  std::shared_ptr<const TypeSystem> type_system_;
  std::deque<Record> heap_;
  std::map<std::string, std::unique_ptr<View>, std::less<>> views_;
  std::vector<Journal> journals_;
  std::unordered_set<uint32_t> hidden_;
};

}  // namespace loci::perception::cas
