#pragma once

#include <string>
#include <vector>

#include "memory/edits/edits.h"
#include "memory/questions/question.h"

namespace loci::memory {

/// A correction, declared once: `loci-memory edit`, the Python module and the tool server derive from it.
struct EditAction {
  std::string name;  ///< "merge"
  std::string description;
  std::vector<Parameter> parameters = {};  ///< in the order in which they are typed
  Edit (*run)(Store& store, const Arguments& arguments, Progress& progress);
};

const std::vector<EditAction>& edit_actions();
/// nullptr when there is none of that name.
const EditAction* find_edit_action(const std::string& name);

/// Does what `query` says: its `question` is the name of an action. Error for an unknown action, unknown or
/// missing arguments, and names that mean nothing or several objects.
Edit make_edit(Store& store, const Query& query, Progress& progress = no_progress());

Json to_json(const Edit& edit);
/// Of an edit that was made just now: with its summary as "reply".
Json result_json(const Edit& edit);
std::string to_text(const EditList& list);
Json to_json(const EditList& list);

}  // namespace loci::memory
