#include "gui/edit_history.h"

#include "gui/background.h"
#include "memory/edits/edits.h"

namespace loci::gui {

void EditHistory::set_memory(const QString& path) {
  if (path == path_) return;
  path_ = path;
  take({});
  if (path.isEmpty()) return;
  in_background<EditState>(
      this, [file = path.toStdString()] { return edit_state(file); },
      [this, path](const EditState& state) {
        if (path == path_ && !busy_) take(state);
      },
      [this](const std::exception_ptr& error) { Q_EMIT failed(reason_of(error)); });
}

void EditHistory::take(const EditState& state) {
  state_ = state;
  Q_EMIT changed();
}

void EditHistory::write(const std::function<memory::Edit(memory::Store&)>& edit, const QString& prefix) {
  if (busy_ || path_.isEmpty()) return;
  busy_ = true;
  Q_EMIT changed();
  in_background<EditState>(
      this, [file = path_.toStdString(), edit] { return apply_edit(file, edit); },
      [this, path = path_, prefix](const EditState& state) {
        busy_ = false;
        if (path == path_) take(state);
        Q_EMIT written(prefix + QString::fromStdString(state.done));
      },
      [this](const std::exception_ptr& error) {
        busy_ = false;
        Q_EMIT changed();
        Q_EMIT failed(reason_of(error));
      });
}

void EditHistory::say(const std::string& about, const std::string& key, const std::string& value) {
  write([=](memory::Store& store) { return loci::memory::say(store, about, key, value); });
}

void EditHistory::name_part(const std::string& part, const std::string& name) {
  write([=](memory::Store& store) { return loci::memory::name_part(store, part, name); });
}

void EditHistory::merge(int64_t one, int64_t other) {
  write([=](memory::Store& store) { return merge_objects(store, one, other); });
}

void EditHistory::split(int64_t object, int64_t from) {
  write([=](memory::Store& store) { return split_object(store, object, from); });
}

void EditHistory::label(int64_t scene, int64_t observation, const std::string& class_name) {
  write([=](memory::Store& store) { return label_observation(store, scene, observation, class_name); });
}

void EditHistory::joint(const std::string& name, const std::string& type) {
  write([=](memory::Store& store) { return set_joint_type(store, name, type); });
}

void EditHistory::undo() {
  if (can_undo()) write([](memory::Store& store) { return loci::memory::undo(store); }, "Undone: ");
}

void EditHistory::redo() {
  if (can_redo()) write([](memory::Store& store) { return loci::memory::redo(store); }, "Redone: ");
}

}  // namespace loci::gui
