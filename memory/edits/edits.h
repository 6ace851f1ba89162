#pragma once

#include <string>
#include <vector>

#include "memory/store/store.h"

namespace loci::memory {

// What people correct in a memory. Each edit is a run of its own whose rows supersede what they correct, with
// source "user": nothing is overwritten, and questions as of an earlier knowledge still see what was known.

/// One edit as it stands in the memory.
struct Edit {
  Id run = 0;        ///< of its rows as they are now: of the edit itself, or of what undid or redid it last
  TimeNs known = 0;  ///< when it was made, undone or redone last
  std::string text = {};  ///< for people: "object_7 is object_3"
};

/// Edits in the order in which they were made or redone.
struct EditList {
  std::vector<Edit> done = {};    ///< hold; the last one is undone first
  std::vector<Edit> undone = {};  ///< the last one is redone first
};
EditList edits(const Store& store);

/// Two objects are one: all that was seen of the younger is from now on known of the elder, whose number
/// stays. Returns what was done. Error when they were seen in one scene (then they are two), or are the same.
Edit merge_objects(Store& store, Id one, Id other);
/// What was seen of an object from a time on is another, new object. Error when nothing was seen of it before
/// or nothing since.
Edit split_object(Store& store, Id object, TimeNs from);
/// What a thing in an image is, for training: observation `number` of a scene is of this class (empty = not
/// said any more). An annotation of type kLabelType; the newest of an observation holds.
Edit label_observation(Store& store, Id scene, int64_t number, const std::string& class_name);
inline constexpr const char* kLabelType = "loci.Label";
/// What an observation was labelled last; empty = nothing.
std::string label_of(const Store& store, Id scene, Id observation);
/// The newest map with another type of a joint ("revolute", "prismatic", "fixed", ...), as a map of its own.
Edit set_joint_type(Store& store, const std::string& joint, const std::string& type);
/// What an object or place is called, its class, owner or anything else (see set_fact); an empty value takes
/// it back.
Edit say(Store& store, const std::string& about, const std::string& key, const std::string& value);

/// What a place is called from now on, whatever the map calls it; questions and the browser say it so, and
/// find it by its old name as well. An empty name takes it back. Error when another place is called so.
Edit name_place(Store& store, const std::string& place, const std::string& name);

/// The same for a place or any other link, or a joint, of the map. An empty name takes it back. Error when
/// there is none of this name, or something else is called so.
Edit name_part(Store& store, const std::string& part, const std::string& name);

/// Takes back the last edit that holds, or makes the last one hold again that was taken back; by further
/// rows. Error when there is none.
Edit undo(Store& store);
Edit redo(Store& store);

}  // namespace loci::memory
