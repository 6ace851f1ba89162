#include "memory/sentences/clauses/coordination.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "mapping/base/text/text.h"
#include "memory/questions/names/names.h"
#include "memory/questions/names/related_words.h"

namespace loci::memory {
namespace {

/// "a and b and c" at the word; one part where it is not in the text.
std::vector<std::string> parts_of(const std::string& text, const std::string& joint) {
  std::vector<std::string> parts;
  const std::string word = " " + joint + " ";
  size_t begin = 0;
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, begin)) {
    parts.push_back(text.substr(begin, at - begin));
    begin = at + word.size();
  }
  parts.push_back(text.substr(begin));
  return parts;
}

bool is_verdict(const std::vector<Reply>& replies) {
  return std::ranges::all_of(replies, [](const Reply& reply) { return reply.verdict.has_value(); });
}

/// "yes" where all are, or any is.
Verdict verdict_of(const std::vector<Reply>& replies, bool any) {
  const auto some = [&](Verdict verdict) {
    return std::ranges::any_of(replies, [&](const Reply& reply) { return reply.verdict == verdict; });
  };
  const Verdict decides = any ? Verdict::yes : Verdict::no;
  if (some(decides)) return decides;
  if (some(Verdict::not_observed)) return Verdict::not_observed;
  return any ? Verdict::no : Verdict::yes;
}

/// Without "Yes: " or "Yes, with 70 %: ", and the last point.
std::string body_of(const Reply& reply) {
  static const std::set<std::string> verdicts = {"Yes", "No", "Not observed"};
  std::string text = reply.text;
  const size_t colon = text.find(": ");
  if (colon != std::string::npos && verdicts.contains(text.substr(0, text.find_first_of(",:"))))
    text.erase(0, colon + 2);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

template <class T>
void add_all(const std::vector<T>& from, std::vector<T>& to) {
  for (const T& one : from)
    if (std::ranges::count(to, one) == 0) to.push_back(one);
}

}  // namespace

Coordination coordination_of(const Query& query) {
  const std::vector<std::string> first = words_of(query.argument("object"));
  const bool one_of_all = !first.empty() && is_superlative(first.front());  // "biggest cup or bowl"
  const bool compared = query.asks == Asks::together || query.asks == Asks::earliest ||
                        query.asks == Asks::latest || query.asks == Asks::most;
  if (!compared && !one_of_all)
    for (const Parameter& parameter : find_question(query.question)->parameters) {
      const bool names = parameter.type == ParameterType::object || parameter.type == ParameterType::place ||
                         parameter.type == ParameterType::part || parameter.type == ParameterType::spot;
      if (parameter.name == "except") continue;  // all of them are left out at once
      for (const char* joint : {"and", "or"}) {
        const std::vector<std::string> parts = parts_of(query.argument(parameter.name), joint);
        if (!names || parts.size() < 2) continue;
        Coordination coordination{.queries = {}, .joint = joint};
        for (const std::string& part : parts) {
          coordination.queries.push_back(query);
          coordination.queries.back().arguments[parameter.name] = part;
        }
        return coordination;
      }
    }
  return {{query}};
}

std::string with_choices_joined(const std::string& sentence) {
  static const std::map<std::string, std::string> measures = {
      {"biggest", "biggest"}, {"largest", "biggest"}, {"bigger", "biggest"},    {"larger", "biggest"},
      {"tallest", "tallest"}, {"taller", "tallest"},  {"smallest", "smallest"}, {"smaller", "smallest"}};
  constexpr size_t kMaxWordsOfName = 4;
  std::string measure, text;
  std::vector<std::string> names;
  const auto end_name = [&] {
    if (!text.empty()) names.push_back(text);
    text.clear();
  };
  std::string spaced;
  for (const char c : lower_case(sentence)) spaced += c == ',' ? std::string(" , ") : std::string(1, c);
  bool listing = false;
  for (const std::string& word : words_of(spaced, " ?!.:")) {
    if (const auto found = measures.find(word); found != measures.end()) {
      measure = found->second;
    } else if (word == "of" || (word == "," && !listing)) {
      listing = true;
    } else if (word == "," || word == "and" || word == "or") {
      end_name();
    } else if (listing && (word == "which" || word == "is" || word == "what")) {
      if (!measure.empty()) return sentence;
      end_name();
      listing = false;  // "of the cup, the bowl and the plate, which is biggest"
    } else if (listing && word != "the" && word != "my" && word != "one") {
      text += (text.empty() ? "" : " ") + word;
    }
  }
  end_name();
  const bool is_list = std::ranges::all_of(
      names, [](const std::string& name) { return words_of(name).size() <= kMaxWordsOfName; });
  if (measure.empty() || names.size() < 3 || !is_list) return sentence;
  return "what is the " + measure + " " + joined(names, " or ") + "?";
}

Reply combined(const std::vector<Reply>& replies, const Coordination& coordination) {
  if (replies.size() == 1) return replies.front();
  const Query& query = coordination.queries.front();
  if (query.asks == Asks::place && query.question == "changes")
    return *std::ranges::max_element(replies, {}, [](const Reply& reply) {
      return reply.time && !reply.not_known ? reply.time->last : TimeNs{0};
    });
  // "On the table or on the counter?" is answered by the place where it is.
  const auto is_so = [](const Reply& reply) { return reply.verdict == Verdict::yes; };
  if (coordination.joint == "or" && std::ranges::count_if(replies, is_so) == 1) {
    Reply one = *std::ranges::find_if(replies, is_so);
    one.text = capitalised(body_of(one)) + ".";
    return one;
  }
  Reply all;
  std::vector<std::string> bodies;
  all.not_known = std::ranges::all_of(replies, &Reply::not_known);
  for (const Reply& reply : replies) {
    add_all(reply.objects, all.objects);
    add_all(reply.places, all.places);
    add_all(reply.evidence, all.evidence);
    add_all({body_of(reply)}, bodies);
    if (reply.number) all.number = all.number.value_or(0) + *reply.number;
    if (reply.probability) all.probability = std::min(all.probability.value_or(1), *reply.probability);
  }
  if (all.evidence.size() > kMaxEvidenceLines) all.evidence.resize(kMaxEvidenceLines);
  if (is_verdict(replies)) {
    all.verdict = verdict_of(replies, coordination.joint == "or");
    all.text = *all.verdict == Verdict::yes  ? "Yes: "
               : *all.verdict == Verdict::no ? "No: "
                                             : "Not observed: ";
  } else if (all.number && query.asks == Asks::number) {
    all.text = fmt::format("{} in all: ", *all.number);
  }
  all.text = shortened(all.text + joined(bodies, "; ") + ".");
  return all;
}

std::optional<std::pair<std::string, std::string>> two_statements(const std::string& sentence) {
  static const std::set<std::string> verbs = {"is", "are", "was", "were"},
                                     relations = {"on", "in", "under", "behind", "near", "at"};
  const std::vector<std::string> words = words_of(sentence, " ?!.,");
  if (words.empty() || !verbs.contains(lower_case(words[0]))) return std::nullopt;
  const auto joint = std::ranges::find(words, "and");
  const auto relates = [&](auto first, auto last) {
    return last - first > 2 &&
           std::any_of(first + 1, last, [](const std::string& word) { return relations.contains(word); });
  };
  if (joint == words.end() || !relates(words.begin(), joint) || !relates(joint + 1, words.end()) ||
      relations.contains(*(joint + 1)))
    return std::nullopt;
  return std::pair(joined({words.begin(), joint}, " ") + "?",
                   words[0] + " " + joined({joint + 1, words.end()}, " ") + "?");
}

Reply among(const Reply& reply, const std::vector<Id>& them, Asks asks, const Snapshot& snapshot) {
  Reply some = reply;
  std::erase_if(some.objects, [&](Id id) { return std::ranges::count(them, id) == 0; });
  std::vector<std::string> names;
  for (const Id id : some.objects) names.push_back(Names(snapshot).of(snapshot.object_ref(id)));
  const bool none = names.empty();
  some.number = names.size();
  if (asks == Asks::exists) some.verdict = none ? Verdict::no : Verdict::yes;
  const std::string list = none ? "none of them" : list_in_words(names, 5);
  some.text = asks == Asks::exists            ? fmt::format("{}: {}.", none ? "No" : "Yes", list)
              : asks == Asks::number && !none ? fmt::format("{}: {}.", names.size(), list)
                                              : capitalised(list) + ".";
  if (some.objects.size() < reply.objects.size()) some.evidence.clear();
  return some;
}

Reply contrary_of(Reply reply) {
  if (reply.verdict != Verdict::yes && reply.verdict != Verdict::no) return reply;
  const bool yes = reply.verdict == Verdict::no;
  if (reply.text.starts_with(yes ? "No" : "Yes")) reply.text.replace(0, yes ? 2 : 3, yes ? "Yes" : "No");
  reply.verdict = yes ? Verdict::yes : Verdict::no;
  return reply;
}

Reply in_lines(const std::vector<Reply>& replies) {
  Reply all = replies.front();
  for (size_t i = 1; i < replies.size(); ++i) {
    const Reply& reply = replies[i];
    all.text += "\n" + reply.text;
    add_all(reply.objects, all.objects);
    add_all(reply.places, all.places);
    if (!all.verdict) all.verdict = reply.verdict;
    if (!all.number) all.number = reply.number;
    if (!all.time) all.time = reply.time;
    if (!all.duration) all.duration = reply.duration;
    if (!all.probability) all.probability = reply.probability;
    all.not_known = all.not_known && reply.not_known;
  }
  if (replies.size() > 1) all.evidence.clear();
  return all;
}

}  // namespace loci::memory
