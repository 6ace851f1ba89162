#pragma once

#include <optional>
#include <string>
#include <vector>

#include "memory/questions/question.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

// What people are told: the answer first, in one short sentence with the names of objects, then its evidence.

inline constexpr size_t kMaxReplyLength = 120;  ///< characters of the sentence
inline constexpr size_t kMaxEvidenceLines = 3;

struct Reply {
  std::string text = {};                   ///< one sentence of at most kMaxReplyLength characters
  std::vector<std::string> notes = {};     ///< how names and times of the query were read, see notes_on()
  std::vector<std::string> evidence = {};  ///< at most kMaxEvidenceLines lines
  // What the sentence states, by its type; unset = nothing of that type.
  std::optional<Verdict> verdict = {};
  std::optional<size_t> number = {};
  size_t out_of_sight = 0;  ///< that `number` leaves out: not gone, and less than likely where they were seen
  std::vector<Id> objects = {};
  std::vector<std::string> places = {};
  std::optional<TimeSpan> time = {};
  std::optional<TimeNs> duration = {};
  std::optional<double> probability = {};
  bool not_known = false;  ///< the memory cannot tell
};
/// A longer text with the sentence before it, where it does not begin with that, and the notes after the
/// first line.
std::string headed(const Reply& reply, std::string text);
/// The sentence, and its notes and evidence on indented lines.
std::string to_text(const Reply& reply);
Json to_json(const Reply& reply);

/// What a reply is made for.
struct ReplyContext {
  const Store& store;
  const Query& query;  ///< its Asks is the type of the reply
  AsOf as_of;          ///< of the query
  const TimeWriter& times;
  std::vector<Id> except = {};  ///< "else": objects that are left out
};

/// With a capital letter, as a sentence begins; names of objects stay as they are.
std::string capitalised(std::string text);
/// Within a sentence.
std::string uncapitalised(std::string text);
/// A text in at most `length` characters, cut between words.
std::string shortened(const std::string& text, size_t length = kMaxReplyLength);

}  // namespace loci::memory
