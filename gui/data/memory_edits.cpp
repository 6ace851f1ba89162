#include "gui/data/memory_edits.h"

#include "memory/edits/edits.h"

namespace loci::gui {
namespace {

EditState state_of(const memory::Store& store) {
  const memory::EditList list = edits(store);
  return {!list.done.empty(), !list.undone.empty(), {}};
}

}  // namespace

EditState edit_state(const std::filesystem::path& path) {
  return state_of(memory::Store::open_read(path));
}

EditState apply_edit(const std::filesystem::path& path,
                     const std::function<memory::Edit(memory::Store&)>& edit) {
  memory::Store store = memory::Store::open_write(path);
  const memory::Edit done = edit(store);
  EditState state = state_of(store);
  state.done = done.text;
  return state;
}

}  // namespace loci::gui
