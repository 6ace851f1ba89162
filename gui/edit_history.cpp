#include "gui/edit_history.h"

#include "gui/background.h"

namespace loci {
namespace {

QString text_of(const FactEdit& edit) {
  const QString what = QString::fromStdString(edit.about + ": " + edit.key);
  return edit.after ? what + " is now '" + QString::fromStdString(*edit.after) + "'"
                    : what + " is taken back";
}

}  // namespace

void EditHistory::set_memory(const QString& path) {
  if (path == path_) return;
  path_ = path;
  edits_.clear();
  done_ = 0;
  Q_EMIT changed();
}

void EditHistory::edit(const std::string& about, const std::string& key, const std::string& value) {
  if (busy_ || path_.isEmpty()) return;
  busy_ = true;
  Q_EMIT changed();
  in_background<FactEdit>(
      this,
      [path = path_.toStdString(), about, key, value] {
        FactEdit edit = make_edit(path, about, key, value);
        apply_edit(path, edit);
        return edit;
      },
      [this, path = path_](const FactEdit& edit) {
        busy_ = false;
        if (path == path_ && edit.before != edit.after) {
          edits_.resize(done_);
          edits_.push_back(edit);
          done_ = edits_.size();
        }
        Q_EMIT changed();
        Q_EMIT written(text_of(edit));
      },
      [this](const std::exception_ptr& error) {
        busy_ = false;
        Q_EMIT changed();
        Q_EMIT failed(reason_of(error));
      });
}

void EditHistory::undo() {
  if (can_undo()) write(edits_[done_ - 1].reversed(), done_ - 1);
}

void EditHistory::redo() {
  if (can_redo()) write(edits_[done_], done_ + 1);
}

void EditHistory::write(const FactEdit& edit, size_t done_then) {
  busy_ = true;
  Q_EMIT changed();
  in_background<FactEdit>(
      this,
      [path = path_.toStdString(), edit] {
        apply_edit(path, edit);
        return edit;
      },
      [this, path = path_, done_then](const FactEdit& written_edit) {
        busy_ = false;
        if (path == path_) done_ = done_then;
        Q_EMIT changed();
        Q_EMIT written(text_of(written_edit));
      },
      [this](const std::exception_ptr& error) {
        busy_ = false;
        Q_EMIT changed();
        Q_EMIT failed(reason_of(error));
      });
}

}  // namespace loci
