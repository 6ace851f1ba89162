#include "memory/sentences/query_answerer.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/text/text.h"
#include "memory/questions/environment.h"
#include "memory/questions/names/color_words.h"
#include "memory/questions/names/related_words.h"
#include "memory/questions/notes.h"
#include "memory/questions/snapshot.h"
#include "memory/sentences/clauses/coordination.h"
#include "memory/sentences/lexicon.h"

namespace loci::memory {
namespace {

/// Whether the query has an answer without its time.
bool is_answered_later(const Store& store, Query query, AsOf as_of) {
  query.arguments.erase("at");
  as_of.at.reset();
  try {
    ask(store, query, as_of);
    return true;
  } catch (const Error&) {
    return false;
  }
}

NoAnswer why_not(const Store& store, const Query& query, const AsOf& as_of, const UnknownName& error) {
  const auto sentence = [](std::string text) { return capitalised(std::move(text)) + "."; };
  if (error.kind() == UnknownName::Kind::place)
    return {"unknown_place", sentence(error.message()), error.hint()};
  if ((as_of.at || query.arguments.contains("at")) && is_answered_later(store, query, as_of))
    return {"not_yet_seen", sentence(error.message() + " at that time; it was first seen later"), {}};
  return {"never_seen", sentence(error.message()), error.hint()};
}

/// That something was not so when an object was last seen says nothing of the time before.
Reply not_then(Reply reply) {
  reply.verdict = Verdict::not_observed;
  if (reply.text.starts_with("No: ")) reply.text.replace(0, 4, "Not observed: at last ");
  return reply;
}

}  // namespace

bool QueryAnswerer::try_reading(Query query, NaturalLanguageAnswer& answer) const {
  const bool first = !answer.query, then = query.argument("at") == "then";
  std::vector<std::string> notes;
  // "It", "one": of what was not said.
  if (!references_.resolve(query, notes) || query.argument("object") == "one") return false;
  // The name of a place means what is there, but "where is table_1", "how high is it" ask for the table.
  const bool of_furniture = (query.question == "where" && query.asks == Asks::place) ||
                            (query.question == "about" && query.argument("property") == "size");
  if (of_furniture && std::ranges::count(snapshot_.places(), query.argument("object"), &PlaceRow::name) > 0)
    query = {"room", {{"part", query.argument("object")}}, query.asks};
  NaturalLanguageAnswer tried{.sentence = answer.sentence};
  try {
    set_answer(query, tried);
    if (then && tried.reply && tried.reply->verdict == Verdict::no) tried.reply = not_then(*tried.reply);
  } catch (const UnknownName& error) {
    if (first && error.kind() == UnknownName::Kind::place) tried.reply = not_looked_into(query);
    if (first && error.kind() == UnknownName::Kind::object) tried.reply = none_coloured(query);
    if (!first) return false;
    if (const auto part = of_part(query)) {
      query = *part;
      set_answer(query, tried);
    } else {
      tried.why_not = why_not(store_, query, as_of_, error);
    }
  } catch (const Error& error) {
    tried.why_not = NoAnswer{"not_possible", fmt::format("Not possible: {}.", error.message()), error.hint()};
  }
  for (std::string& note : notes_on(snapshot_, query)) notes.push_back(std::move(note));
  const bool answered = tried.answer.has_value() || !tried.why_not || tried.why_not->reason == "not_possible";
  if (!answered && !first) return false;
  tried.query = std::move(query);
  tried.notes = std::move(notes);
  answer = std::move(tried);
  return answered;
}

std::optional<Reply> QueryAnswerer::not_looked_into(const Query& query) const {
  const std::string place = query.argument("place");
  if (place.empty() || !find_part_without_place(snapshot_, place)) return std::nullopt;
  return Reply{.text = shortened(fmt::format("Not observed: no look has shown what is in {}.", place)),
               .verdict = Verdict::not_observed,
               .not_known = true};
}

std::optional<Reply> QueryAnswerer::none_coloured(const Query& query) const {
  const std::string object = query.argument("object");
  const size_t end = object.find(' ');
  const std::string colour = object.substr(0, end);
  std::string kind = end == std::string::npos ? "" : object.substr(end + 1);
  if (lemma_of(kind) == "thing") kind.clear();
  // Of what was before only the last colour is known.
  const bool now = !query.arguments.contains("at") && !query.arguments.contains("from") &&
                   !query.arguments.contains("to") && query.question != "was";
  const bool counts = query.asks == Asks::verdict || query.asks == Asks::exists ||
                      query.asks == Asks::objects || query.asks == Asks::number;
  if (!is_color_word(colour) || !now || !counts) return std::nullopt;
  if (!kind.empty() && !snapshot_.means_objects(kind)) return std::nullopt;
  return Reply{.text = kind.empty() ? fmt::format("No: nothing {} is known.", colour)
                                    : fmt::format("No: of what is called '{}' nothing is known to be {}.",
                                                  kind, colour),
               .verdict = Verdict::no,
               .number = 0};
}

std::optional<Query> QueryAnswerer::of_part(const Query& query) const {
  const std::string name = query.argument("object");
  const bool exists = query.asks == Asks::exists || query.asks == Asks::verdict;
  if (query.question != "where" || !exists || name.empty() || name.find(' ') != std::string::npos)
    return std::nullopt;
  try {
    ask(store_, RoomQuestion{.part = name, .as_of = as_of_});
  } catch (const UnknownName&) {
    return std::nullopt;
  }
  return Query{"room", {{"part", name}}, Asks::exists};
}

std::optional<Reply> QueryAnswerer::out_of_time(const Query& query) const {
  const auto from = times_.try_read(query.argument("from")), to = times_.try_read(query.argument("to"));
  const std::optional<TimeNs> first = times_.first_scene();
  const bool late = from && from->first > times_.now(), early = to && first && to->last < *first;
  if (!late && !early) return std::nullopt;
  return Reply{.text = fmt::format("Not observed: the {} look was at {}.", late ? "last" : "first",
                                   writer_.text(late ? times_.now() : *first)),
               .verdict = Verdict::not_observed,
               .not_known = true};
}

void QueryAnswerer::set_answer(const Query& query, NaturalLanguageAnswer& answer) const {
  answer.reply = out_of_time(query);
  if (answer.reply) return;
  const AsOf as_of = read_as_of(store_, query.argument("at"), query.argument("known-at"), as_of_);
  const Coordination coordination = coordination_of(query);
  std::vector<Reply> replies;
  for (const Query& one : coordination.queries) {
    answer.answer = ask(store_, one, as_of_);
    ReplyContext context{store_, one, as_of, writer_};
    if (lower_case(answer.sentence).find(" else ") != std::string::npos)
      context.except = references_.last_objects();
    replies.push_back(answer.answer->reply(context));
  }
  answer.reply = combined(replies, coordination);
}

}  // namespace loci::memory
