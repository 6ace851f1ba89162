#include "memory/sentences/clauses/contents_clause.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <regex>
#include <vector>

#include "mapping/base/text/text.h"
#include "memory/questions/names/names.h"
#include "memory/questions/names/related_words.h"
#include "memory/sentences/lexicon.h"
#include "memory/sentences/mentions.h"
#include "memory/sentences/sentence_time.h"

namespace loci::memory {
namespace {

using Relation = ContentsComparison::Relation;

/// The words of the construction, each as a letter; "-" changes nothing here.
const std::map<std::string, char>& letters() {
  static const std::map<std::string, char> all = [] {
    std::map<std::string, char> result;
    for (const auto& [letter, words] : std::map<char, const char*>{
             {'-',
              "there here it the a an any my our thing things object objects item items stuff on in at from "
              "inside i we have has had got else currently present please been before earlier previously "
              "anymore longer "
              "me then "
              "only list show name tell"},
             {'Q', "what"},
             {'R', "that which but and yet"},
             {'H', "howmany many"},
             {'A', "everything all anything"},
             {'W', "was were stood lay sat"},
             {'B', "do does is are stands stand lies lie sits sit"},
             {'N', "not no nolonger gone missing removed taken away disappeared vanished"},
             {'S', "still also too left remain remains remaining stayed"},
             {'M', "more morethings"},
             {'F', "fewer less"},
             {'E', "emptier"},
             {'U', "fuller"},
             {'X', "than"},
             {'Y', "as same"},
             {'J', "or"},
             {'L', "where"},
             {'D', "both"},
             {'O', "of"},
             {'V', "compared versus"}})
      for (const std::string& word : words_of(words)) result[word] = letter;
    return result;
  }();
  return all;
}

/// A sentence as letters, with its names and times in order: "QWPTRWNT".
struct Skeleton {
  std::string letters = {};
  std::vector<std::string> places = {}, objects = {};
  std::vector<SentencePeriod> times = {};
  bool inside = false;  ///< in the place
  bool known = true;    ///< all objects are called so
};

/// "Both counters": the two that are called so; false where there are not two.
bool add_both(const std::string& name, const Snapshot& snapshot, Skeleton& skeleton) {
  const std::vector<PlaceRow> places = snapshot.places_meant(name);
  if (places.size() != 2) return false;
  skeleton.letters += "PRP";
  for (const PlaceRow& place : places) skeleton.places.push_back(place.name);
  return true;
}

/// False where a word has no part in the construction.
bool add_word(const Words& words, size_t at, Skeleton& skeleton) {
  const auto found = letters().find(words[at]);
  if (found == letters().end()) return false;
  const std::string before = at > 0 ? words[at - 1] : "";
  const bool no_more = words[at] == "more" && (before == "any" || before == "no" || before == "not");
  if (found->second == '-' || no_more) return true;
  // "not there any more", "is gone": one negation.
  if (found->second == 'N' && skeleton.letters.ends_with('N')) return words[at] != "not";
  skeleton.letters += found->second;
  return true;
}

std::optional<Skeleton> skeleton_of(const std::string& sentence, const Snapshot& snapshot,
                                    const TimeReader& times) {
  const Tokens tokens = tokens_of(sentence_words(sentence));
  const Words& words = tokens.words;
  if (words.size() < 5 || !letters().contains(words[0])) return std::nullopt;
  const auto mentions = find_mentions(tokens, snapshot, [](const std::string&) { return true; });
  Skeleton skeleton;
  for (size_t i = 0; i < words.size();) {
    // "The north counter, … the south one": the noun of the place before.
    if (i + 1 < words.size() && words[i + 1] == "one" && !skeleton.places.empty()) {
      const Words noun = words_of(skeleton.places.back());
      const std::string other = words[i] + " " + noun.back();
      if (snapshot.places_meant(other).size() == 1) {
        skeleton.letters += 'P';
        skeleton.places.push_back(other);
        i += 2;
        continue;
      }
    }
    const auto mention = std::ranges::find(mentions, i, &Mention::first);
    if (mention != mentions.end() && (mention->known || !mention->place) && !letters().contains(words[i])) {
      if (mention->place && skeleton.letters.ends_with('D') && add_both(mention->text, snapshot, skeleton)) {
        i = mention->last;
        continue;
      }
      skeleton.known = skeleton.known && mention->known;
      skeleton.letters += mention->place ? 'P' : 'K';
      (mention->place ? skeleton.places : skeleton.objects).push_back(mention->text);
      if (mention->place && i > 0) skeleton.inside = words[i - 1] == "in" || (i > 1 && words[i - 2] == "in");
      i = mention->last;
      continue;
    }
    size_t last = i;
    if (auto time = time_at(words, last, times)) {
      skeleton.letters += 'T';
      skeleton.times.push_back(std::move(*time));
      i = last;
    } else if (words[i] == "how" || (words[i] == "with" && skeleton.letters.ends_with('V')) ||
               (words[i] == "to" && skeleton.letters.ends_with('V')) || add_word(words, i, skeleton)) {
      ++i;
    } else {
      return std::nullopt;
    }
  }
  return skeleton;
}

/// A form of the construction: its groups are named by `parts`, in order.
struct Form {
  std::regex expression;
  std::string parts;
};

/// Parts: 1, 2 = the verb of a clause, a, b = its time, r = the relation, q = what is asked.
const std::vector<Form>& forms() {
  static const std::vector<Form> all = [] {
    std::vector<Form> result;
    const auto add = [&](const char* form, const char* parts) {
      result.push_back({std::regex(form), parts});
    };
    // "What was on the table at noon that was not there at ten", "which of what was ... are still there".
    add("([QRH])O?R?([WB]?)K?(T?)P(T?)R*([WB]?)(N|S)S?(T?)", "q1aa2rb");
    // "Of what was on the table at noon, how many are still there?"
    add("OR?([WB]?)K?(T?)P(T?)([QRH])R?([WB]?)(N|S)(T?)", "1aaq2rb");
    // "Is everything that was on the table at noon still there?"
    add("([WB])A(?:O)?R?([WB]?)(T?)P(T?)R*(N|S)(T?)", "21aarb");
    // "Was there more on the table at nine than now?", "was the table fuller at nine than now?"
    add("([WB])([MF])K?[WB]?(T?)P(T?)X([WB]?)(T?)", "1raa2b");
    add("([WB])P([UE])(T?)X([WB]?)(T?)", "1ra2b");
    return result;
  }();
  return all;
}

/// Contents of the place at a time: of a period all that was seen there.
Query contents_query(const Skeleton& skeleton, const SentencePeriod* time, bool ever) {
  Query query{.question = ever || (time != nullptr && !time->moment) ? "contents-history"
                          : skeleton.inside                          ? "in"
                                                                     : "on",
              .arguments = {{"place", skeleton.places.front()}},
              .asks = Asks::objects};
  if (!skeleton.objects.empty()) query.arguments["object"] = skeleton.objects.front();
  if (time == nullptr) return query;
  if (time->moment) {
    query.arguments["at"] = time->from;
  } else {
    if (!time->from.empty()) query.arguments["from"] = time->from;
    if (!time->to.empty()) query.arguments["to"] = time->to;
  }
  return query;
}

std::string text_of(const SentencePeriod* time, bool ever) {
  if (time == nullptr) return ever ? "" : "now";
  if (time->moment) return time->from == "now" ? "now" : "at " + time->from;
  if (time->from == time->to) return time->from;
  return (time->from.empty() ? "" : "from " + time->from) + (time->to.empty() ? "" : " until " + time->to);
}

/// What a form makes of its groups; unset where they do not say which two times are meant.
std::optional<ContentsComparison> read_groups(const Skeleton& skeleton, const std::string& parts,
                                              const std::smatch& groups) {
  ContentsComparison result{.place = skeleton.places.front()};
  std::string verb[2], relation;
  const SentencePeriod* time[2] = {nullptr, nullptr};
  size_t next = 0;
  result.asks = Asks::verdict;
  for (size_t i = 0; i < parts.size(); ++i) {
    const std::string text = groups[i + 1];
    const char part = parts[i];
    if (part == 'q') result.asks = text == "H" ? Asks::number : Asks::objects;
    if (part == 'r') relation = text;
    if (part == '1' || part == '2') verb[part - '1'] = text;
    if ((part == 'a' || part == 'b') && !text.empty()) {
      if (time[part - 'a'] != nullptr) return std::nullopt;
      time[part - 'a'] = &skeleton.times.at(next++);
    }
  }
  const bool ever = time[0] == nullptr && verb[0] == "W";
  const bool counts = relation != "N" && relation != "S";
  if ((ever && counts) || (time[1] == nullptr && (verb[1] == "W" || (counts && verb[1].empty()))))
    return std::nullopt;
  result.relation = relation == "N"                      ? Relation::without
                    : relation == "S"                    ? Relation::common
                    : relation == "M" || relation == "U" ? Relation::more
                                                         : Relation::fewer;
  result.first = contents_query(skeleton, time[0], ever);
  result.second = contents_query(skeleton, time[1], false);
  result.first_label = text_of(time[0], ever);
  result.second_label = text_of(time[1], false);
  if (result.first_label == result.second_label) return std::nullopt;
  return result;
}

Relation relation_of(const std::string& letters) {
  return letters == "M" ? Relation::more : letters == "F" ? Relation::fewer : Relation::equal;
}

/// What a sentence asks of two quantities, at one time or without one.
struct QuantityForm {
  Relation relation = Relation::more;
  bool chooses = false;  ///< which of the two
  const SentencePeriod* time = nullptr;
};

/// By its letters without those of times, and of places where one is named; one group of a form that matches
/// is the relation.
std::optional<QuantityForm> quantity_form(const Skeleton& skeleton, const std::regex& whether,
                                          const std::regex& which) {
  std::string letters = skeleton.letters;
  std::erase(letters, 'T');
  if (skeleton.places.size() == 1) std::erase(letters, 'P');
  std::smatch groups;
  const bool chooses = std::regex_match(letters, groups, which);
  if ((!chooses && !std::regex_match(letters, groups, whether)) || skeleton.times.size() > 1)
    return std::nullopt;
  return QuantityForm{relation_of(groups.size() < 3 || groups[1].matched ? groups[1] : groups[2]), chooses,
                      skeleton.times.empty() ? nullptr : &skeleton.times.front()};
}

/// "Are there more mugs on the table than on the counter?", "which has more mugs, the table or the counter?"
std::optional<ContentsComparison> two_places(Skeleton skeleton) {
  static const std::regex whether("[WB]*(?:(M|F|YH)K?P|P(M|F|YH)K?)[XY][WB]*P"),
      which("[QRL][WB]*(M|F)O?K?J?PJP");
  const auto form = quantity_form(skeleton, whether, which);
  if (!form) return std::nullopt;
  ContentsComparison result{.relation = form->relation,
                            .first = contents_query(skeleton, form->time, false),
                            .place = skeleton.places[0],
                            .first_label = "on " + skeleton.places[0],
                            .second_label = "on " + skeleton.places[1],
                            .asks = form->chooses ? Asks::place : Asks::verdict};
  std::swap(skeleton.places[0], skeleton.places[1]);
  result.second = contents_query(skeleton, form->time, false);
  return result;
}

/// "What has been on both counters?", "which cups are on both the table and the counter?"
std::optional<ContentsComparison> both_places(Skeleton skeleton) {
  static const std::regex form("([QRH])O?K?([WB]?)K?[WB]?(T?)DPRP(T?)");
  std::smatch groups;
  if (!std::regex_match(skeleton.letters, groups, form) || skeleton.times.size() > 1) return std::nullopt;
  const SentencePeriod* time = skeleton.times.empty() ? nullptr : &skeleton.times.front();
  const bool ever = groups[2] != "B" && time == nullptr;
  ContentsComparison result{.relation = Relation::common,
                            .first = contents_query(skeleton, time, ever),
                            .first_label = "on " + skeleton.places[0],
                            .second_label = "on " + skeleton.places[1],
                            .asks = groups[1] == "H" ? Asks::number : Asks::objects};
  std::swap(skeleton.places[0], skeleton.places[1]);
  result.second = contents_query(skeleton, time, ever);
  return result;
}

/// How many there are in the room, at a moment.
Query number_query(const std::string& object, const SentencePeriod* time) {
  Query query{.question = "where", .arguments = {{"object", object}}, .asks = Asks::number};
  if (time != nullptr) query.arguments["at"] = time->from;
  return query;
}

/// "Are there more cups than plates on the table?", "what do we have more of, cups or plates?"
std::optional<ContentsComparison> two_kinds(Skeleton skeleton) {
  static const std::regex whether("[WB]*(M|F|YH)K[XY][WB]*K"), which("[QR][WB]*(M|F)O?J?KJK");
  const auto form = quantity_form(skeleton, whether, which);
  const SentencePeriod* time = form ? form->time : nullptr;
  if (!form || (skeleton.places.empty() && time != nullptr && !time->moment)) return std::nullopt;
  const auto number_of = [&](const std::string& object) {
    if (skeleton.places.empty()) return number_query(object, time);
    skeleton.objects.front() = object;
    return contents_query(skeleton, time, false);
  };
  const std::string first = skeleton.objects[0], second = skeleton.objects[1];
  return ContentsComparison{.relation = form->relation,
                            .first = number_of(first),
                            .second = number_of(second),
                            .place = skeleton.places.empty() ? "" : skeleton.places.front(),
                            .first_label = first,
                            .second_label = second,
                            .asks = form->chooses ? Asks::objects : Asks::verdict};
}

/// "Are there fewer cups than at nine?", "were there more cups at nine than now?"
std::optional<ContentsComparison> two_times(const Skeleton& skeleton) {
  static const std::regex form("[WB]*(M|F|YH)K[WB]*(T?)[XY][WB]*(T?)");
  std::smatch groups;
  if (!std::regex_match(skeleton.letters, groups, form) || skeleton.times.empty()) return std::nullopt;
  const SentencePeriod* first = groups[2].length() > 0 ? &skeleton.times.front() : nullptr;
  const SentencePeriod* second = groups[3].length() > 0 ? &skeleton.times.back() : nullptr;
  for (const SentencePeriod& time : skeleton.times)
    if (!time.moment) return std::nullopt;
  const std::string& object = skeleton.objects.front();
  return ContentsComparison{.relation = relation_of(groups[1]),
                            .first = number_query(object, first),
                            .second = number_query(object, second),
                            .place = "",
                            .first_label = text_of(first, false),
                            .second_label = text_of(second, false),
                            .asks = Asks::verdict};
}

std::string names_in_words(const std::vector<Id>& objects, const Snapshot& snapshot) {
  std::vector<std::string> names;
  for (const Id id : objects) names.push_back(Names(snapshot).of(snapshot.object_ref(id)));
  return list_in_words(names);
}

std::string labelled(const std::string& label) {
  return label.empty() ? "before" : label;
}

/// "1 red cup" of "red cups".
std::string amount(size_t number, const std::string& kind) {
  const size_t noun = kind.rfind(' ') + 1;
  return fmt::format("{} {}{}", number, kind.substr(0, noun),
                     number == 1 ? singular_of(kind.substr(noun)) : kind.substr(noun));
}

Reply counted(const ContentsComparison& comparison, const Reply& first, const Reply& second,
              const Snapshot& snapshot) {
  const size_t a = first.objects.size(), b = second.objects.size();
  const bool of_kinds = comparison.first.argument("object") != comparison.second.argument("object");
  const std::string amounts =
      of_kinds ? amount(a, comparison.first_label) + ", " + amount(b, comparison.second_label)
               : fmt::format("{} {}, {} {}", a, labelled(comparison.first_label), b,
                             labelled(comparison.second_label));
  const bool is_first = comparison.relation == Relation::more ? a > b : a < b;
  Reply reply;
  if (comparison.asks == Asks::verdict) {
    const bool yes = comparison.relation == Relation::equal ? a == b : is_first;
    reply.verdict = yes ? Verdict::yes : Verdict::no;
    reply.text = fmt::format("{}: {}.", yes ? "Yes" : "No", amounts);
  } else if (a == b) {
    reply.text = fmt::format("As many: {}.", amounts);
  } else {
    reply.objects = is_first ? first.objects : second.objects;
    const Query& query = is_first ? comparison.first : comparison.second;
    if (comparison.asks == Asks::place)
      reply.places = {snapshot.find_places(query.argument("place")).front().name};
    reply.text = fmt::format(
        "{}: {}.", capitalised(is_first ? comparison.first_label : comparison.second_label), amounts);
  }
  return reply;
}

}  // namespace

std::optional<ContentsComparison> find_contents_comparison(const std::string& sentence,
                                                           const Snapshot& snapshot,
                                                           const TimeReader& times) {
  auto skeleton = skeleton_of(sentence, snapshot, times);
  if (!skeleton || skeleton->times.size() > 2) return std::nullopt;
  const size_t kinds = skeleton->objects.size(), places = skeleton->places.size();
  if (kinds == 2 && places < 2) return two_kinds(*skeleton);
  if (kinds < 2 && places == 2) {
    if (auto both = both_places(*skeleton)) return both;
    return two_places(*skeleton);
  }
  if (kinds == 1 && places == 0) return two_times(*skeleton);
  if (kinds > 1 || places != 1 || !skeleton->known) return std::nullopt;
  // "What is missing from the table compared with noon?"
  static const std::regex missing("QBNPVT");
  if (std::regex_match(skeleton->letters, missing)) {
    skeleton->letters = "QWPTRBN";
  }
  for (const Form& form : forms()) {
    std::smatch groups;
    if (std::regex_match(skeleton->letters, groups, form.expression))
      return read_groups(*skeleton, form.parts, groups);
  }
  return std::nullopt;
}

Reply compared(const ContentsComparison& comparison, const Reply& first, const Reply& second,
               const Snapshot& snapshot) {
  for (const Reply* one : {&first, &second})
    if (one->not_known) return *one;
  if (comparison.relation != Relation::without && comparison.relation != Relation::common)
    return counted(comparison, first, second, snapshot);
  const auto in_second = [&](Id id) { return std::ranges::count(second.objects, id) > 0; };
  std::vector<Id> such, others;
  for (const Id id : first.objects)
    (in_second(id) == (comparison.relation == Relation::common) ? such : others).push_back(id);
  Reply reply{.objects = such};
  if (comparison.asks == Asks::verdict) {
    reply.objects = others;
    reply.verdict = others.empty() && !such.empty() ? Verdict::yes : Verdict::no;
    reply.text = *reply.verdict == Verdict::yes
                     ? fmt::format("Yes: {}.", names_in_words(such, snapshot))
                     : fmt::format("No: not {}.", names_in_words(others, snapshot));
  } else {
    reply.number = such.size();
    reply.text = (comparison.asks == Asks::number ? fmt::format("{}: ", such.size()) : "") +
                 names_in_words(such, snapshot) + ".";
    reply.text = capitalised(reply.text);
  }
  reply.text = shortened(reply.text);
  for (const auto& [time, objects] :
       {std::pair(comparison.first_label, first.objects), std::pair(comparison.second_label, second.objects)})
    reply.evidence.push_back(fmt::format("{}{}: {}", comparison.place.empty() ? "" : comparison.place + ", ",
                                         labelled(time), names_in_words(objects, snapshot)));
  return reply;
}

}  // namespace loci::memory
