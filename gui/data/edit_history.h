#pragma once

#include <QObject>
#include <QString>
#include <cstdint>
#include <functional>
#include <string>

namespace loci::memory {
class Store;
struct Edit;
}  // namespace loci::memory

namespace loci::gui {

/// Corrections of the open memory, with undo and redo, which the memory itself stores. Writing goes on in
/// the background, one edit at a time; an edit that fails is reported and dropped.
class EditHistory : public QObject {
  Q_OBJECT

 public:
  using QObject::QObject;

  /// The memory that is edited; empty = none.
  void set_memory(const QString& path);
  /// Sets a fact about an object or place; an empty value takes it back.
  void set_fact(const std::string& about, const std::string& key, const std::string& value);
  /// Names a place, link or joint; an empty name takes it back.
  void name_part(const std::string& part, const std::string& name);
  void merge(int64_t one, int64_t other);
  /// What is seen of an object from a time on is another object.
  void split(int64_t object, int64_t from);
  /// The class of an observation, for training.
  void label(int64_t scene, int64_t observation, const std::string& class_name);
  void set_joint_type(const std::string& name, const std::string& type);
  void undo();
  void redo();
  bool can_undo() const { return !busy_ && state_.can_undo; }
  bool can_redo() const { return !busy_ && state_.can_redo; }

 Q_SIGNALS:
  void changed();                     ///< what can be undone
  void written(const QString& what);  ///< the memory has changed: "object_7 is object_3"
  void failed(const QString& message);

 private:
  struct State {
    bool can_undo = false, can_redo = false;
    std::string done = {};  ///< the edit that was written
  };
  static State state_of(const memory::Store& store);
  void write(const std::function<memory::Edit(memory::Store&)>& edit, const QString& prefix = {});
  void take(const State& state);

  QString path_;
  State state_;
  bool busy_ = false;
};

}  // namespace loci::gui
