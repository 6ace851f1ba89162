#include "gui/data/edit_history.h"

#include "gui/core/background.h"
#include "memory/edits/edits.h"

namespace loci::gui {

using memory::Edit;
using memory::Store;

EditHistory::State EditHistory::state_of(const Store& store) {
  const memory::EditList list = memory::edits(store);
  return {!list.done.empty(), !list.undone.empty(), {}};
}

void EditHistory::set_memory(const QString& path) {
  if (path == path_) return;
  path_ = path;
  take({});
  if (path.isEmpty()) return;
  in_background<State>(
      this, [file = path.toStdString()] { return state_of(Store::open_read(file)); },
      [this, path](const State& state) {
        if (path == path_ && !busy_) take(state);
      },
      [this](const std::exception_ptr& error) { Q_EMIT failed(reason_of(error)); });
}

void EditHistory::take(const State& state) {
  state_ = state;
  Q_EMIT changed();
}

void EditHistory::write(const std::function<Edit(Store&)>& edit, const QString& prefix) {
  if (busy_ || path_.isEmpty()) return;
  busy_ = true;
  Q_EMIT changed();
  in_background<State>(
      this,
      [file = path_.toStdString(), edit] {
        Store store = Store::open_write(file);
        const Edit done = edit(store);
        State state = state_of(store);
        state.done = done.text;
        return state;
      },
      [this, path = path_, prefix](const State& state) {
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

void EditHistory::set_fact(const std::string& about, const std::string& key, const std::string& value) {
  write([=](Store& store) { return memory::say(store, about, key, value); });
}

void EditHistory::name_part(const std::string& part, const std::string& name) {
  write([=](Store& store) { return memory::name_part(store, part, name); });
}

void EditHistory::merge(int64_t one, int64_t other) {
  write([=](Store& store) { return memory::merge_objects(store, one, other); });
}

void EditHistory::split(int64_t object, int64_t from) {
  write([=](Store& store) { return memory::split_object(store, object, from); });
}

void EditHistory::label(int64_t scene, int64_t observation, const std::string& class_name) {
  write([=](Store& store) { return memory::label_observation(store, scene, observation, class_name); });
}

void EditHistory::set_joint_type(const std::string& name, const std::string& type) {
  write([=](Store& store) { return memory::set_joint_type(store, name, type); });
}

void EditHistory::undo() {
  if (can_undo()) write([](Store& store) { return memory::undo(store); }, "Undone: ");
}

void EditHistory::redo() {
  if (can_redo()) write([](Store& store) { return memory::redo(store); }, "Redone: ");
}

}  // namespace loci::gui
