#pragma once

#include <optional>
#include <string>
#include <vector>

#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

/// "it", "there", "one": what they mean was said before.
bool is_reference(const std::string& word);

/// Replaces "it", "there", "this drawer" and "the other one" by what they mean.
class ReferenceResolver {
 public:
  /// `about`: what "it" means at first; unset = nothing.
  ReferenceResolver(const Store& store, const AsOf& as_of, const std::optional<Id>& about)
      : snapshot_(store, as_of), last_subject_(about ? object_name(*about) : "") {}

  /// Keeps what the last sentence was about and what its answer named.
  void remember(const Query& query, const Reply& reply);
  /// Keeps what was spoken of without being asked for; "" = as before.
  void remember(const std::string& subject, const std::string& place);
  /// What was spoken of last; "" = nothing.
  const std::string& last_subject() const { return last_subject_; }
  /// What the last answer named.
  const std::vector<Id>& last_objects() const { return last_objects_; }

  /// Replaces references in the arguments; what they were taken as is added to the notes. False where "it"
  /// stands for what was not said.
  bool resolve(Query& query, std::vector<std::string>& notes);

 private:
  bool replace_pronoun(std::string& text, std::vector<std::string>& notes) const;
  void replace_other(std::string& text, const std::string& kind, std::vector<std::string>& notes) const;
  std::string place_of(const std::string& subject) const;
  void replace_there(Query& query, const Parameter& parameter, std::vector<std::string>& notes) const;
  void replace_then(Query& query, std::vector<std::string>& notes) const;
  void replace_demonstrative(std::string& text, std::vector<std::string>& notes) const;

  Snapshot snapshot_;
  void remember_objects(const Query& query);
  void remember_place(const Query& query, const Reply& reply);

  std::string last_subject_, last_place_;
  std::string referent_ = {};  ///< which of that name the last answer named; "" = no one of them
  std::vector<Id> last_objects_;
};

}  // namespace loci::memory
