#pragma once

#include <string>
#include <vector>

#include "memory/catalogue/catalogue.h"
#include "memory/reasoning/revise.h"

namespace loci::memory {

/// For callers who do not show progress.
Progress& no_progress();

// Corrections by people. Each edit is a run of its own whose rows, with source "user", supersede what they
// correct: nothing is overwritten, and questions as of an earlier transaction time have the earlier answers.
//
// What people say of identities is evidence: the observations of one object are one, those of two are not.
// The belief is computed again from the first scene that this concerns, in one transaction, so that a stopped
// edit changes nothing. Undo brings back every row, and the belief from before. A memory without the evidence
// of all scenes gets the rows of the objects concerned changed, and nothing else.

/// One edit.
struct Edit {
  Id run = 0;             ///< of its present rows: of the edit itself, or of its last undo or redo
  TimeNs known = 0;       ///< of that run
  std::string text = {};  ///< for people: "object_7 is object_3"
  std::string note = {};  ///< what came of it beyond that: "object_9 (alias mug) has no observation left"
  bool undone = false;    ///< the run reversed it
};
/// "Undone: object_7 is object_3".
std::string summary(const Edit& edit);

/// Edits in the order in which they were made or redone.
struct EditList {
  std::vector<Edit> done = {};    ///< the last one is undone first
  std::vector<Edit> undone = {};  ///< the last one is redone first
};
EditList edits(const Store& store);
/// What they say of identities; later ones over earlier ones.
KnownIdentities known_identities(const Store& store);

/// Two objects are one: all observations of the younger become those of the elder, whose id remains. Error
/// when they were seen in one scene, or are the same.
Edit merge_objects(Store& store, Id one, Id other, Progress& progress = no_progress());
/// The observations of an object from a time on are of another, new object. Error without observations before
/// or since.
Edit split_object(Store& store, Id object, TimeNs from, Progress& progress = no_progress());
/// The class of observation `number` of a scene, for training (empty = retracted): an annotation of type
/// kLabelType, of which the newest holds.
Edit label_observation(Store& store, Id scene, int64_t number, const std::string& class_name);
/// The newest label of an observation; empty = none.
std::string label_of(const Store& store, Id scene, Id observation);
/// The newest map with another type of a joint ("revolute", "prismatic", "fixed", ...), added as a new map.
Edit set_joint_type(Store& store, const std::string& joint, const std::string& type);
/// A fact about an object or place: alias, class, owner or any other key (see set_fact). An empty value
/// retracts it.
Edit say(Store& store, const std::string& about, const std::string& key, const std::string& value);

/// Teaches a class by example: what looks like the object is called so, too.
CatalogueResult teach(Store& store, const std::string& object, const std::string& class_name);

/// The name of a place from now on; questions and the browser use it, and also find the place by its old
/// name. An empty name retracts it. Error when another place has this name.
Edit name_place(Store& store, const std::string& place, const std::string& name);
/// The same for a piece of furniture ("drawer_2": its place, else its link, and what answers call its joint),
/// for any other link, or for a joint, of the map. Error when there is none of this name, or something else
/// has the new one.
Edit name_part(Store& store, const std::string& part, const std::string& name);

/// Reverses the last edit that holds, or the last undo, by further rows. Error when there is none.
Edit undo(Store& store, Progress& progress = no_progress());
Edit redo(Store& store, Progress& progress = no_progress());

}  // namespace loci::memory
