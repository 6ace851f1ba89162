#pragma once

#include <QObject>
#include <QString>
#include <functional>
#include <string>

#include "gui/data/memory_edits.h"

namespace loci::gui {

/// Corrections of the open memory, with undo and redo, which the memory itself remembers. Writing goes on in
/// the background, one edit at a time; an edit that fails is told and forgotten.
class EditHistory : public QObject {
  Q_OBJECT

 public:
  using QObject::QObject;

  /// The memory that is edited.
  void set_memory(const QString& path);
  /// Makes a value hold; empty = takes it back.
  void say(const std::string& about, const std::string& key, const std::string& value);
  void name_part(const std::string& part, const std::string& name);
  void merge(int64_t one, int64_t other);
  void split(int64_t object, int64_t from);
  void label(int64_t scene, int64_t observation, const std::string& class_name);
  void joint(const std::string& name, const std::string& type);
  void undo();
  void redo();
  bool can_undo() const { return !busy_ && state_.can_undo; }
  bool can_redo() const { return !busy_ && state_.can_redo; }

 Q_SIGNALS:
  void changed();                     ///< what can be undone
  void written(const QString& what);  ///< the memory has changed: "object_7 is object_3"
  void failed(const QString& message);

 private:
  void write(const std::function<memory::Edit(memory::Store&)>& edit, const QString& prefix = {});
  void take(const EditState& state);

  QString path_;
  EditState state_;
  bool busy_ = false;
};

}  // namespace loci::gui
