#pragma once

#include <QObject>
#include <QString>
#include <vector>

#include "gui/data/memory_edits.h"

namespace loci {

/// What was edited in the open memory, with undo and redo. Writing goes on in the background, one edit at a
/// time; an edit that fails is told and forgotten.
class EditHistory : public QObject {
  Q_OBJECT

 public:
  using QObject::QObject;

  /// The memory that is edited; forgets the edits of another one.
  void set_memory(const QString& path);
  /// Makes a value hold; empty = takes it back.
  void edit(const std::string& about, const std::string& key, const std::string& value);
  void undo();
  void redo();
  bool can_undo() const { return !busy_ && done_ > 0; }
  bool can_redo() const { return !busy_ && done_ < edits_.size(); }

 Q_SIGNALS:
  void changed();                     ///< what can be undone
  void written(const QString& what);  ///< the memory has changed: "object_3: alias is now 'tea cup'"
  void failed(const QString& message);

 private:
  void write(const FactEdit& edit, size_t done_then);

  QString path_;
  std::vector<FactEdit> edits_;
  size_t done_ = 0;  ///< edits that hold; those behind them can be redone
  bool busy_ = false;
};

}  // namespace loci
