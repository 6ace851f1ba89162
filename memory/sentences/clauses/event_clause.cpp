#include "memory/sentences/clauses/event_clause.h"

#include <algorithm>
#include <map>
#include <set>

#include "mapping/base/text/text.h"
#include "memory/sentences/lexicon.h"
#include "memory/sentences/mentions.h"

namespace loci::memory {
namespace {

using Link = EventClause::Link;

const std::map<std::string, Link>& links() {
  static const std::map<std::string, Link> all = {{"when", Link::at},       {"while", Link::at},
                                                  {"after", Link::after},   {"once", Link::after},
                                                  {"before", Link::before}, {"if", Link::condition}};
  return all;
}

constexpr TimeNs kMoment = 120 * kSecond;  ///< a state that lasts longer names a period
constexpr TimeNs kLook = 60 * kSecond;     ///< in which the frames of the look that saw an event follow it

/// "the drawer was opened": a name or a person, then a verb.
bool is_clause(const Words& words) {
  if (words.size() < 2) return false;
  const Tokens tokens = tokens_of(words);
  const WordClass first = class_of(tokens.lemmas[0]);
  return first != WordClass::auxiliary && first != WordClass::question && first != WordClass::relation;
}

/// The first name in a clause, or its first place; "" = none.
std::string named_in(const Words& words, bool place, const Snapshot& snapshot) {
  const auto mentions = find_mentions(tokens_of(words), snapshot, [](const std::string&) { return true; });
  const auto found = std::ranges::find_if(mentions, [&](const Mention& one) { return !place || one.place; });
  return found == mentions.end() ? "" : found->text;
}

/// The pronoun that begins or ends a clause, or follows its verb, is what the other clause names.
void resolve(Words& words, const Words& other, const Snapshot& snapshot) {
  const auto pronoun = std::ranges::find_if(
      words, [](const std::string& word) { return is_pronoun(word) || word == "there"; });
  if (pronoun == words.end()) return;
  static const std::set<std::string> of_places = {"to", "on", "onto", "in", "into", "from", "off"};
  const bool place = pronoun != words.begin() && of_places.contains(*(pronoun - 1));  // "what came to it"
  std::string name = place ? named_in(other, true, snapshot) : "";
  if (name.empty()) name = named_in(other, false, snapshot);
  if (name.empty()) return;
  Words by = words_of("the " + name);
  if (*pronoun == "there") by.insert(by.begin(), "on");
  replace_words(words, static_cast<size_t>(pronoun - words.begin()), 1, by);
}

}  // namespace

std::optional<EventClause> find_event_clause(const std::string& sentence, const Snapshot& snapshot) {
  const size_t comma = sentence.find(',');
  const Words all = sentence_words(sentence);
  Words question, event;
  Link link = Link::at;
  if (const auto first = all.empty() ? links().end() : links().find(all[0]);
      first != links().end() && comma != std::string::npos) {
    link = first->second;
    event = sentence_words(sentence.substr(0, comma));
    event.erase(event.begin());
    question = sentence_words(sentence.substr(comma + 1));
  } else {
    for (size_t i = all.size(); i-- > 2 && event.empty();) {
      const auto found = links().find(all[i]);
      if (found == links().end()) continue;
      link = found->second;
      question.assign(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(i));
      event.assign(all.begin() + static_cast<std::ptrdiff_t>(i) + 1, all.end());
    }
  }
  if (!is_clause(event) || question.size() < 2) return std::nullopt;
  // "If I opened the drawer" asks for what might be.
  if (link == Link::condition && class_of(lemma_of(event[0])) == WordClass::person) return std::nullopt;
  const Words asked = question;
  resolve(question, event, snapshot);
  resolve(event, asked, snapshot);
  return EventClause{link, joined(question, " "), joined(event, " ")};
}

std::string question_at(const EventClause& clause, const TimeSpan& event, bool lasts) {
  const Words words = words_of(clause.question);
  const bool state = words.front() == "where" || std::ranges::count(words, "was") > 0 ||
                     std::ranges::count(words, "were") > 0 || std::ranges::count(words, "is") > 0;
  const bool seen_over = words.front() == "was" || words.front() == "were";
  const std::string before = format_time(event.first), after = format_time(event.last);
  switch (clause.link) {
    case Link::after:
      return clause.question + (state ? " at " : " after ") + after;
    case Link::before:
      return clause.question + (state && !seen_over ? " at " : " before ") + before;
    case Link::at:
      return clause.question + (lasts && event.last - event.first >= kMoment
                                    ? " between " + before + " and " + after
                                    : " at " + (state ? format_time(event.last + kLook) : after));
    case Link::condition:
      break;
  }
  return clause.question;
}

}  // namespace loci::memory
