#include "memory/sentences/clauses/absence_clause.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "memory/sentences/courtesy.h"
#include "memory/sentences/lexicon.h"
#include "memory/sentences/mentions.h"

namespace loci::memory {

std::optional<Absence> find_absence(const std::string& sentence, const Snapshot& snapshot) {
  static const std::set<std::string> length = {"how",  "howlong", "long",    "howmany",
                                               "many", "hours",   "minutes", "for"},
                                     away = {"away", "gone", "missing", "absent"},
                                     others = {"was", "were", "the", "my", "our", "from", "off", "on", "in"};
  Words said = sentence_words(sentence);
  strip_surroundings(said);
  const Tokens tokens = tokens_of(said);
  const Words& words = tokens.words;
  if (words.size() < 4 || !length.contains(words[0])) return std::nullopt;
  const auto any_of = [&](const std::set<std::string>& set) {
    return std::ranges::any_of(words, [&](const std::string& word) { return set.contains(word); });
  };
  // The grammar reads "away from" as "from".
  if (!(any_of(away) || any_of({"from"})) || !any_of({"was", "were"}) ||
      !any_of({"long", "howlong", "hours", "minutes"}))
    return std::nullopt;
  const auto mentions = find_mentions(tokens, snapshot, [](const std::string&) { return true; });
  if (mentions.empty() || mentions.size() > 2 || mentions[0].place || !mentions[0].known ||
      (mentions.size() == 2 && !(mentions[1].place && mentions[1].known)))
    return std::nullopt;
  for (size_t i = 0; i < words.size(); ++i) {
    const bool in_name =
        std::ranges::any_of(mentions, [&](const Mention& one) { return i >= one.first && i < one.last; });
    if (!in_name && !length.contains(words[i]) && !away.contains(words[i]) && !others.contains(words[i]))
      return std::nullopt;
  }
  Query left{.question = "changes",
             .arguments = {{"object", mentions[0].text}, {"kind", "left"}},
             .asks = Asks::last_time};
  if (mentions.size() == 2) left.arguments["place"] = mentions[1].text;
  Absence absence{left, left};
  absence.came.arguments["kind"] = "came";
  return absence;
}

Reply absence_reply(const TimeSpan& left, const std::optional<TimeSpan>& came, TimeNs now,
                    const TimeWriter& times) {
  const TimeNs back = came ? came->last : now;
  std::string length = duration_text(back - left.first);
  if (length.empty()) length = "a minute";
  Reply reply{.text = came ? fmt::format("At most {}: it left after {} and was back by {}.", length,
                                         times.text(left.first), times.text(back))
                           : fmt::format("At most {}: it left after {} and was not seen back.", length,
                                         times.text(left.first))};
  reply.duration = back - left.first;
  return reply;
}

}  // namespace loci::memory
