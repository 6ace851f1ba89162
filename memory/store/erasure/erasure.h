#pragma once

// Private to this module: what is forgotten on request. An Eraser marks the rows that belong to it
// (erasure_marks.cpp), collects what must not be found afterwards (erasure_tokens.cpp), and removes them
// (erasure.cpp); a tombstone remains (tombstones.cpp).

#include "mapping/base/text/json_fwd.h"
#include "memory/store/database.h"

namespace loci::memory {

/// What is to go, by id.
struct Targets {
  std::set<Id> objects = {}, observations = {}, facts = {}, places = {};
  std::optional<std::pair<TimeNs, TimeNs>> interval = {};
};

/// Erases targets inside a transaction.
class Eraser {
 public:
  Eraser(Store& store, Store::Connection& db, Targets targets, Id run)
      : store_(store), db_(db), database_(*db.database), targets_(std::move(targets)), run_(run) {}
  ForgetResult erase(const ReasoningFilter& filter);
  /// Rows of the run, which reasoned anew, take the place of those that they supersede. Objects of which
  /// nothing is left then; what people stated of them is of those that they turned out to be.
  std::set<Id> replace_superseded();

  /// Of what was erased, before.
  const std::vector<std::string>& identities() const { return identities_; }

 private:
  int64_t change(const std::string& text, const SqlValues& values = {}) {
    return run_statements(database_, text, values);
  }
  /// A condition on a column, e.g. "object IN (SELECT id FROM temp.gone_object)".
  static std::string is_gone(const std::string& column, const std::string& what) {
    return fmt::format("{} IN (SELECT id FROM temp.gone_{})", column, what);
  }
  TimeNs from() const { return targets_.interval->first; }
  TimeNs to() const { return targets_.interval->second; }

  // ---- What belongs to it.
  void mark();
  /// The observations that are associated with a gone object now, not those that once were.
  int64_t mark_observations();
  /// Objects that have no observation but gone ones: those that were merged into a gone object, too.
  int64_t mark_emptied_objects();
  void mark_rows();
  /// Rows of others that are not known any more and say that they were, or came from, where it was observed;
  /// events that are known lose where they came from.
  void mark_abandoned_rows();
  /// Rows of others that gone ones supersede would hold again: these become their retractions, which undo can
  /// take back, instead of going.
  void retract_superseded(const std::string& table);
  /// Facts that gone ones supersede go as well, unless a remaining one superseded them in turn.
  void mark_superseded_facts();
  /// Rows that supersede gone ones supersede what those superseded. How many.
  int64_t relink(const std::string& table);
  /// Runs of people's edits that are about it, and those that undo or redo them. Others forget its
  /// observations.
  void mark_runs();
  bool mentions(const Json& configuration) const;

  // ---- What must not be found afterwards: tokens, which nothing that remains says.
  void read_signatures();
  void collect(const std::string& query);
  void collect_strings(const Json& json);
  void collect_texts();
  void collect_numbers();
  /// Which of these are gone is known when all is done.
  void remember_blobs();
  void finish_tokens();
  /// Maps and type systems, which are about the home and the program.
  /// Drops the texts that other feature structures hold.
  void drop_structured(std::vector<std::string>& texts);
  std::string stored_documents();
  bool is_said(const std::string& text);

  // ---- Removal.
  void erase_images();
  void filter_reasoning(const ReasoningFilter& filter);
  /// What later rows say of the interval: since when, where from, and where an object had been that is gone
  /// now.
  void correct_rows_after_interval();
  /// Deletes rows and counts them.
  void remove(const std::string& table, const std::string& condition);
  void delete_rows();
  /// Runs that nothing refers to go; of others what they were configured with.
  void delete_runs();

  void replace_superseded_rows(const std::string& table);
  void replace_visibility();
  std::set<Id> hand_over_emptied_objects();

  // ---- Objects of which some observations remain.
  void restore_remaining_objects();
  void restore_object(Id object, TimeNs since);
  void add_appearance(Id object, Id observation);
  /// A row of belief from an observation, unless there is one of its scene.
  void believe_observation(Id object, Id observation);
  void remember_next_object();

  Store& store_;
  Store::Connection& db_;
  SQLite::Database& database_;
  Targets targets_;
  Id run_;
  ForgetResult result_;
  std::vector<std::string> identities_;
};

}  // namespace loci::memory
