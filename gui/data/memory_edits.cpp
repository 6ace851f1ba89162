#include "gui/data/memory_edits.h"

#include "memory/edits/edits.h"

namespace loci {
namespace {

EditState state_of(const Store& store) {
  const EditList list = edits(store);
  return {!list.done.empty(), !list.undone.empty(), {}};
}

}  // namespace

EditState edit_state(const std::filesystem::path& path) {
  return state_of(Store::open_read(path));
}

EditState apply_edit(const std::filesystem::path& path, const std::function<Edit(Store&)>& edit) {
  Store store = Store::open_write(path);
  const Edit done = edit(store);
  EditState state = state_of(store);
  state.done = done.text;
  return state;
}

}  // namespace loci
