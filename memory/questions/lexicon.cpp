#include "memory/questions/lexicon.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "mapping/base/text.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {
namespace {

/// Lemmas and the words that stand for them; the lemma itself need not be given.
const std::vector<std::pair<const char*, const char*>> kLemmas = {
    // Auxiliaries.
    {"is", "am are be being"},
    {"was", "were"},
    {"do", "does doing"},
    {"have", "has having"},
    {"may", "can could might shall would must"},
    {"should", "ought supposed"},
    {"will", "gonna"},
    {"not", "never no nobody none neither nor without except nowhere"},
    {"someone",
     "i we you he she me us him myself ourselves yourself yourselves anyone anybody somebody people "
     "everybody "
     "everyone robot person loci"},
    {"every", "all both each entire"},
    {"everything", ""},
    {"thing", "things object objects item items stuff anything something"},
    {"room", "kitchen flat apartment house home"},
    // Questions.
    {"whereabouts", "whereabout"},
    {"whose", ""},
    // What happens.
    {"see",
     "sees saw seen seeing notice noticed noticing spot spotted observe observed observing detect detected "
     "recognise recognised recognize recognized sighted sighting sightings observation observations observe "
     "glimpse glimpsed witness witnessed sight perceive perceived view views"},
    {"find", "finds found finding locate search searching seek seeking hunting"},
    {"look", "looks looked looking viewed check checked inspect inspected examine examined visited visit"},
    {"move",
     "moves moved moving using touching handling movement movements shift shifted push pushed touch touched "
     "use used handle handled "
     "relocate relocated displace displaced budge budged disturb disturbed transfer transferred rearranged"},
    {"take",
     "takes took taken taking remove removes removed removing steal stole stolen grab grabbed pinch pinched "
     "pick picked swipe swiped borrow borrowed withdrawn"},
    {"leave", "leaves left leaving"},
    {"go", "goes went gone going wander wandered travel travelled traveled"},
    {"vanish", "vanishes vanished vanishing disappear disappears disappeared"},
    {"come",
     "comes came coming enter entered enters entering arrive arrived arrives arriving appear appears "
     "appeared reach reaches reached return "
     "returned returns"},
    {"put",
     "puts placed placing putting laid add added brought deposit deposited drop dropped park parked stash "
     "stashed stick stuck insert inserted"},
    {"lose", "lost losing misplace misplaced mislay mislaid"},
    {"miss", "missing absent lacking lack lacks"},
    {"keep", "keeps kept keeping store stores stored storing"},
    {"stand",
     "stands stood standing lie lies lying lain sit sits sat sitting rest rests resting stay stays stayed "
     "remain remains remained remaining located situated positioned hide hides hid hidden hiding reside "
     "resides spent spend spends"},
    {"belong", "belongs live lives"},
    {"contain", "contains contained containing hold holds held holding include includes"},
    {"happen", "happens happened happening occur occurs occurred event events activity"},
    {"change", "changes changed"},
    {"own", "owns owned owner"},
    {"open", "ajar"},
    {"opened", "opens opening openings"},
    {"close", "closed closes shut"},
    {"know", "knows knew remember recall aware"},
    {"think", "believe say suppose assume reckon claim thinks believed"},
    {"get", "got gets"},
    {"exist", "exists existing"},
    {"want", "need wants needs"},
    {"act", "done"},
    // How things are.
    {"empty", "free clear unoccupied vacant bare cleared"},
    {"full", "occupied"},
    {"new", "different"},
    {"clean", "tidy straighten"},
    {"usually", "normally always mostly typically generally often usual normal customarily"},
    {"last", "latest final recent finally"},
    {"lately", "recently"},
    {"before", "previously earlier formerly"},
    {"first", "earliest initially originally"},
    {"sure", "certain confident convinced positive"},
    {"together", ""},
    // What is asked for.
    {"location", "position spot whereabouts place"},
    {"content", "contents"},
    {"colour", "color"},
    {"state", "status condition"},
    {"summary", "overview recap"},
    {"write", "written"},
    {"print", "printed"},
    {"size", "dimensions dimension measurements"},
    {"history", "movements journey"},
    // Relations.
    {"on", "upon atop"},
    {"in", "inside"},
    {"into", "onto"},
    {"near", "beside nearby alongside around by"},
    {"under", "below beneath underneath"},
    {"from", "off"},
    {"about", "regarding concerning"},
};

/// Several words that are one.
const std::vector<std::pair<const char*, const char*>> kCompounds = {
    {"how (many times|often|frequently)", "howoften"},
    {"how many of (the|my|our|these|those)", "howmany"},
    {"how many", "howmany"},
    {"how (likely|probable|certain|sure) is it [that]", "howsure"},
    {"(would|do) you (say|think|believe|reckon) (is|are|was|were)", "is"},
    {"(to|on) the (left|right) [side] of", "behind"},
    {"(left|right) of", "behind"},
    {"how much", "howmuch"},
    {"(one|any|some|either|each|all) of (the|my|our|your|these|those)", "any"},
    {"(count|number) [all] (the|my)", "howmany"},
    {"[the] (number|count|quantity|amount) of", "howmany"},
    {"(for how|how) long", "howlong"},
    {"how much time", "howlong"},
    {"since (when|what time)", "sincewhen"},
    {"(with|to) what (certainty|confidence|probability)", "howsure"},
    {"how (big|large|small|tall|high|wide|heavy)", "howbig"},
    {"how (far|wide) open", "howfar open"},
    {"how far", "howfar"},
    {"how (sure|certain|confident|probable|likely)", "howsure"},
    {"(what is|what are) the (probability|chance|chances|likelihood|odds|confidence) (that|of)", "howsure"},
    {"(at|around|by|about) (what|which) time", "when"},
    {"(what|which) time", "when"},
    {"(what|which) (time|moment)", "when"},
    {"[the] time of", "when"},
    {"[the] last time [that|when]", "last"},
    {"[the] (latest|final) time", "last"},
    {"[the] first time [that|when]", "first"},
    {"for the last time", "last"},
    {"for the first time", "first"},
    {"(is it|has it been|it is) since", "is ago"},
    {"how long since", "howlong ago"},
    {"(what|which) (places|spots|locations|surfaces)", "where"},
    {"life cycle", "lifecycle"},
    {"[going|goes|went|gone] on with", "happened with"},
    {"(going|goes|gone) on", "happening"},
    {"went on", "happened"},
    {"(are|is) (we|you) [all] out of", "is gone"},
    {"(have|has|did) (we|you) (run|ran|run all) out of", "is gone"},
    {"similar to", "like"},
    {"(resemble|resembles|resembling)", "look like"},
    {"of the day", ""},
    {"summarize (the|my|this) day", "summary"},
    {"summarise (the|my|this) day", "summary"},
    {"(is|are|was|were) (supposed|meant) to", "should"},
    {"(at|in|on) (what|which) (place|spot|location|position|surface)", "where"},
    {"(what|which) (place|spot|location|position|surface) (is|was|has|does|did|do)", "where is"},
    {"(what|which) (place|spot|location|position|surface)", "where"},
    {"where abouts", "where"},
    {"where on earth", "where"},
    {"where the (hell|heck|devil)", "where"},
    {"(how come|for what reason|on what grounds|based on what|for which reason)", "why"},
    {"what makes (you|someone)", "why someone"},
    {"what makes", "why"},
    {"[what is|is there any|is there] [the] (evidence|proof) (that|for|of)", "why"},
    {"on top of", "on"},
    {"(next to|close to|adjacent to|right by|in the vicinity of|in the neighbourhood of)", "near"},
    {"(out of|off of|away from)", "from"},
    {"in front of", "infront"},
    {"most recent", "last"},
    {"(looking|look|search|searching|hunt|hunting) for", "find"},
    {"(track|tracking) down", "find"},
    {"(come|came) across", "see"},
    {"(set|laid|clap|clapped) eyes on", "see"},
    {"catch sight of", "see"},
    {"(ended|end|ends|wound|wind) up", "go"},
    {"(turned|turn|turns|showed|show|shows) up", "come"},
    {"(is|was|has been|are|were) in use", "is full"},
    {"(become|became|becomes) of", "happen to"},
    {"(take|took|takes|taken) place", "happen"},
    {"go wrong", "wrong"},
    {"make room", "room"},
    {"any more", "anymore"},
    {"no longer", "not"},
    {"used to be", "was"},
    {"such as", "like"},
    {"open or (closed|shut)", "state"},
    {"(closed|shut) or open", "state"},
    {"get rid of", "take"},
    {"anything else", "something else"},
};

/// Words of each class, as lemmas.
struct ClassWords {
  WordClass word_class;
  const char* words;
};
const std::vector<ClassWords> kClasses = {
    {WordClass::question,
     "where when who whose why what which how howmany howlong howoften howsure howbig howfar howmuch "
     "sincewhen"},
    {WordClass::auxiliary, "is was been do did have had may should will"},
    {WordClass::person, "someone"},
    {WordClass::article, "the a an my our any some his her their your its these those"},
    {WordClass::empty,
     "please still already ever just again currently really also even maybe then right yet actually perhaps "
     "anyway kindly possibly exactly precisely indeed simply anymore total overall presently anywhere "
     "somewhere "
     "too well here apparently basically supposedly seem seems so certainly up down out"},
    {WordClass::relation,
     "on in at to into from of near with behind under infront above about for and or like within between "
     "than "
     "as over"},
    {WordClass::ordinary,
     "because if whether unless while very much nice good bad better worse best nicest old young tomorrow "
     "soon later nearest early late only more most less least fewer almost nearly twice once per "
     "weather joke song meaning news time date day days week year name language sky rain sun moon world "
     "speak sing dance eat eating drink drinking cook cooking sleep sleeping buy bought cost costs "
     "expensive "
     "hungry tired hot cold warm weigh weighs broken dirty fresh sour sweet expired spoiled rotten wet dry "
     "hello hi hey bye thanks sorry yes okay ok let's cannot feel feeling love hate work works "
     "working stop start play doing make made making enough instead unlike due until since during "
     "against toward towards across along beyond despite beautiful ugly favourite "
     "wrong shortly after whenever wherever whoever whatever whichever"},
};

const std::map<std::string, WordClass>& classes() {
  static const std::map<std::string, WordClass> all = [] {
    std::map<std::string, WordClass> result;
    for (const ClassWords& of_class : kClasses)
      for (const std::string& word : words_of(of_class.words)) result.emplace(word, of_class.word_class);
    return result;
  }();
  return all;
}

const std::string& lemma_of(const std::string& word) {
  const auto found = lexicon().find(word);
  return found == lexicon().end() ? word : found->second;
}

/// "what's" as "what is", "can't" as "can not".
Words expanded(const std::string& word) {
  static const std::map<std::string, Words> whole = {
      {"can't", {"can", "not"}},     {"cannot", {"can", "not"}},  {"cant", {"can", "not"}},
      {"won't", {"will", "not"}},    {"i'm", {"i", "am"}},        {"im", {"i", "am"}},
      {"whats", {"what", "is"}},     {"wheres", {"where", "is"}}, {"theres", {"there", "is"}},
      {"isnt", {"is", "not"}},       {"dont", {"do", "not"}},     {"didnt", {"did", "not"}},
      {"hasnt", {"has", "not"}},     {"havent", {"have", "not"}}, {"wasnt", {"was", "not"}},
      {"where'd", {"where", "did"}}, {"when'd", {"when", "did"}}, {"who'd", {"who", "did"}},
      {"let's", {"let", "us"}},      {"i'll", {"i", "will"}}};
  static const std::set<std::string> before_is = {"what", "where", "who",   "there", "it",  "how",
                                                  "when", "that",  "which", "he",    "she", "here"};
  static const std::vector<std::pair<std::string, std::string>> endings = {
      {"n't", "not"}, {"'re", "are"}, {"'ve", "have"}, {"'d", "would"}, {"'ll", "will"}};
  if (const auto found = whole.find(word); found != whole.end()) return found->second;
  if (word.ends_with("'s") && before_is.contains(word.substr(0, word.size() - 2)))
    return {word.substr(0, word.size() - 2), "is"};
  for (const auto& [ending, rest] : endings)
    if (word.ends_with(ending) && word.size() > ending.size())
      return {word.substr(0, word.size() - ending.size()), rest};
  return {word};
}

/// "second drawer" and "drawer number two" are "drawer 2".
void name_by_number(Words& words) {
  static const std::map<std::string, std::string> ordinals = {
      {"first", "1"}, {"1st", "1"},    {"second", "2"}, {"2nd", "2"},   {"third", "3"},
      {"3rd", "3"},   {"fourth", "4"}, {"4th", "4"},    {"fifth", "5"}, {"sixth", "6"}};
  static const std::map<std::string, std::string> numbers = {{"one", "1"},  {"two", "2"},  {"three", "3"},
                                                             {"four", "4"}, {"five", "5"}, {"six", "6"}};
  static const std::set<std::string> furniture = {"drawer",  "door",    "shelf",    "table",
                                                  "counter", "cabinet", "cupboard", "island"};
  for (size_t i = 0; i + 1 < words.size(); ++i) {
    if (const auto ordinal = ordinals.find(words[i]);
        ordinal != ordinals.end() && furniture.contains(words[i + 1])) {
      words[i] = words[i + 1];
      words[i + 1] = ordinal->second;
    }
    if (!furniture.contains(words[i])) continue;
    if (i + 2 < words.size() && (words[i + 1] == "number" || words[i + 1] == "no"))
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    if (words[i + 1].starts_with('#')) words[i + 1].erase(0, 1);
    if (const auto number = numbers.find(words[i + 1]); number != numbers.end())
      words[i + 1] = number->second;
  }
}

/// All plain sequences of words that a form stands for.
class FormExpander {
 public:
  explicit FormExpander(const std::string& form) : form_(form) {}
  std::vector<Words> expand() { return alternatives('\0'); }

 private:
  std::vector<Words> alternatives(char end) {
    std::vector<Words> all, current = {{}};
    std::string word;
    const auto append = [&](const std::vector<Words>& tails) {
      std::vector<Words> longer;
      for (const Words& head : current)
        for (const Words& tail : tails) {
          longer.push_back(head);
          longer.back().insert(longer.back().end(), tail.begin(), tail.end());
        }
      current = std::move(longer);
    };
    const auto end_word = [&] {
      if (!word.empty()) append({{word}});
      word.clear();
    };
    while (next_ < form_.size() && form_[next_] != end) {
      const char c = form_[next_++];
      if (c == ' ') {
        end_word();
      } else if (c == '|') {
        end_word();
        all.insert(all.end(), current.begin(), current.end());
        current = {{}};
      } else if (c == '(' || c == '[') {
        std::vector<Words> inner = alternatives(c == '(' ? ')' : ']');
        ++next_;
        if (c == '[') inner.emplace_back();
        append(inner);
      } else {
        word.push_back(c);
      }
    }
    end_word();
    all.insert(all.end(), current.begin(), current.end());
    return all;
  }

  const std::string& form_;
  size_t next_ = 0;
};

/// The compounds as plain sequences, long ones first.
const std::vector<std::pair<Words, Words>>& compounds() {
  static const std::vector<std::pair<Words, Words>> all = [] {
    std::vector<std::pair<Words, Words>> result;
    for (const auto& [form, by] : kCompounds)
      for (Words& words : expand_form(form)) result.emplace_back(std::move(words), words_of(by));
    std::ranges::stable_sort(result, std::ranges::greater(),
                             [](const auto& compound) { return compound.first.size(); });
    return result;
  }();
  return all;
}

}  // namespace

const std::map<std::string, std::string>& lexicon() {
  static const std::map<std::string, std::string> lemmas = [] {
    std::map<std::string, std::string> result;
    for (const auto& [lemma, words] : kLemmas)
      for (const std::string& word : words_of(words)) result[word] = lemma;
    return result;
  }();
  return lemmas;
}

WordClass class_of(const std::string& lemma) {
  const auto found = classes().find(lemma);
  return found == classes().end() ? WordClass::name : found->second;
}

Words sentence_words(const std::string& sentence) {
  Words result;
  for (std::string& word : words_of(sentence, " \t\n\v\f\r?!,;\"()")) {
    // ISO 8601 times keep their T and Z.
    if (std::isdigit(static_cast<unsigned char>(word[0])) == 0) word = lower_case(word);
    while (word.ends_with('.') || word.ends_with(':')) word.pop_back();
    if (word.ends_with("days") && weekday_of(word.substr(0, word.size() - 1))) word.pop_back();
    if (word.empty()) continue;
    for (std::string& part : expanded(word)) result.push_back(std::move(part));
  }
  name_by_number(result);
  return result;
}

void replace_words(Words& words, size_t first, size_t count, const Words& by) {
  words.erase(words.begin() + static_cast<std::ptrdiff_t>(first),
              words.begin() + static_cast<std::ptrdiff_t>(first + count));
  words.insert(words.begin() + static_cast<std::ptrdiff_t>(first), by.begin(), by.end());
}

bool starts_with_words(const Words& words, const Words& head, size_t at) {
  return at + head.size() <= words.size() &&
         std::equal(head.begin(), head.end(), words.begin() + static_cast<std::ptrdiff_t>(at));
}

std::string join_words(const Words& words, size_t first, size_t last) {
  std::string text;
  for (size_t i = first; i < last; ++i) text += (i > first ? " " : "") + words[i];
  return text;
}

std::vector<Words> expand_form(const std::string& form) {
  return FormExpander(form).expand();
}

Tokens tokens_of(Words words) {
  for (const auto& [compound, by] : compounds())
    for (size_t i = 0; i < words.size(); ++i)
      if (starts_with_words(words, compound, i)) replace_words(words, i, compound.size(), by);
  Tokens tokens;
  for (std::string& word : words) {
    tokens.lemmas.push_back(lemma_of(word));
    tokens.words.push_back(std::move(word));
  }
  return tokens;
}

bool is_one_typo(const std::string& a, const std::string& b) {
  if (a == b || a.size() > b.size() + 1 || b.size() > a.size() + 1) return false;
  size_t i = 0;
  while (i < a.size() && i < b.size() && a[i] == b[i]) ++i;
  const std::string rest_a = a.substr(i), rest_b = b.substr(i);
  const auto tail = [](const std::string& text, size_t count) {
    return text.size() < count ? std::string() : text.substr(count);
  };
  if (rest_a.size() == rest_b.size())
    return tail(rest_a, 1) == tail(rest_b, 1) ||
           (rest_a.size() > 1 && rest_a[0] == rest_b[1] && rest_a[1] == rest_b[0] &&
            tail(rest_a, 2) == tail(rest_b, 2));
  return rest_a.size() > rest_b.size() ? tail(rest_a, 1) == rest_b : tail(rest_b, 1) == rest_a;
}

}  // namespace loci::memory
