#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace loci::memory {
class Store;
struct Edit;
}  // namespace loci::memory

namespace loci::gui {

/// What can be undone and redone in a memory.
struct EditState {
  bool can_undo = false, can_redo = false;
  std::string done = {};  ///< what was written, in words
};
EditState edit_state(const std::filesystem::path& path);

/// Writes an edit. Error when the file cannot be written, as while another program writes to it, or when it
/// makes no sense.
EditState apply_edit(const std::filesystem::path& path,
                     const std::function<memory::Edit(memory::Store&)>& edit);

}  // namespace loci::gui
