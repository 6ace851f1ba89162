#include "gui/data/memory_edits.h"

#include "memory/questions/facts.h"

namespace loci {

FactEdit make_edit(const std::filesystem::path& path, const std::string& about, const std::string& key,
                   const std::string& after) {
  FactEdit edit{.about = about, .key = key};
  if (!after.empty()) edit.after = after;
  const auto held = ask(Store::open_read(path), FactsQuestion{about, key, {}}).facts;
  if (!held.empty()) edit.before = held.back().value;
  return edit;
}

void apply_edit(const std::filesystem::path& path, const FactEdit& edit) {
  if (edit.before == edit.after) return;
  Store::open_read(path);  // a name that is none must not make a new memory
  Store store = Store::open_write(path);
  // There may be several aliases: the one that is replaced goes. Of other keys the old value is superseded.
  if (edit.before && (!edit.after || edit.key == "alias"))
    remove_fact(store, edit.about, edit.key, *edit.before);
  if (edit.after) set_fact(store, edit.about, edit.key, *edit.after);
}

}  // namespace loci
