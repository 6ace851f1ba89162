#include "memory/sentences/intents/intent_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <sstream>

#include "mapping/base/error.h"
#include "mapping/base/text/text.h"
#include "memory/wordnet/wordnet.h"

namespace loci::memory {
namespace {

bool is_name_of_placeholder(const std::string& word) {
  static const std::set<std::string> names = {"OBJECT", "OTHER", "THIRD", "PLACE", "SECOND"};
  return names.contains(word);
}

/// OTHER and THIRD are objects, SECOND is a place.
Words with_kinds(Words words) {
  for (std::string& word : words) {
    if (word == "OTHER" || word == "THIRD") word = "OBJECT";
    if (word == "SECOND") word = "PLACE";
  }
  return words;
}

bool is_placeholder(const std::string& lemma) {
  return lemma == "OBJECT" || lemma == "PLACE";
}

/// "shifted" as "shift", "spots" as "spot", where the lexicon says nothing of the word.
std::string base_of(const std::string& word) {
  using wordnet::PartOfSpeech;
  if (is_placeholder(word) || lexicon().contains(word) || class_of(word) != WordClass::name) return word;
  for (const PartOfSpeech part : {PartOfSpeech::verb, PartOfSpeech::noun}) {
    const std::vector<std::string> bases = wordnet::base_forms(word, part);
    if (!bases.empty()) return std::ranges::count(bases, word) > 0 ? word : bases.front();
  }
  return word;
}

/// What a word may mean: its frequent senses, and what the first one is a kind of. Words that the grammar
/// gives a meaning of its own have none. How many was chosen by cross-validation.
std::vector<std::string> meanings_of(const std::string& lemma) {
  using wordnet::PartOfSpeech;
  constexpr std::array<std::pair<PartOfSpeech, size_t>, 3> kMaxSenses = {
      {{PartOfSpeech::verb, 5}, {PartOfSpeech::noun, 3}, {PartOfSpeech::adjective, 3}}};
  const WordClass word_class = class_of(lemma);
  std::vector<std::string> meanings;
  if (is_placeholder(lemma) || (word_class != WordClass::name && word_class != WordClass::ordinary))
    return meanings;
  for (const auto& [part, max_senses] : kMaxSenses) {
    const std::vector<wordnet::Synset> senses = wordnet::senses(lemma, part);
    for (size_t i = 0; i < std::min(max_senses, senses.size()); ++i)
      meanings.push_back(fmt::format("#{}", senses[i]));
    if (!senses.empty())
      for (const wordnet::Synset above : wordnet::hypernyms(senses[0]))
        meanings.push_back(fmt::format("#{}", above));
  }
  return meanings;
}

std::string_view as_view(std::string_view text) {
  return text;
}

/// The index of a feature; their number where it is none of them.
template <class Features>
size_t index_of(const Features& features, std::string_view feature) {
  const auto found = std::ranges::lower_bound(features, feature, {}, as_view);
  const bool is_one = found != features.end() && *found == feature;
  return static_cast<size_t>((is_one ? found : features.end()) - features.begin());
}

/// Rows of weights of the features that a sentence has.
template <class Features>
std::vector<size_t> rows_of(const Features& features, const Tokens& tokens) {
  std::vector<size_t> rows;
  for (const std::string& feature : intent_features(tokens))
    if (const size_t row = index_of(features, feature); row < features.size()) rows.push_back(row);
  return rows;
}

/// exp(scores) / their sum, in place.
void normalize(std::vector<double>& scores) {
  const double highest = std::ranges::max(scores);
  double sum = 0;
  for (double& score : scores) sum += score = std::exp(score - highest);
  for (double& score : scores) score /= sum;
}

std::vector<double> scores_of(const IntentModel& model, const std::vector<size_t>& rows) {
  const size_t forms = model.forms.size();
  std::vector<double> scores(forms, 0);
  for (const size_t row : rows)
    for (size_t form = 0; form < forms; ++form)
      scores[form] += static_cast<double>(model.weights[row * forms + form]) * double{kIntentWeightStep};
  return scores;
}

}  // namespace

bool IntentModel::has_feature(std::string_view feature) const {
  return index_of(features, feature) < features.size();
}

Tokens intent_tokens(const Words& words) {
  Tokens all = tokens_of(with_kinds(words)), tokens;
  for (size_t i = 0; i < all.lemmas.size(); ++i) {
    const WordClass word_class = class_of(all.lemmas[i]);
    if (word_class == WordClass::article || word_class == WordClass::empty) continue;
    tokens.words.push_back(std::move(all.words[i]));
    tokens.lemmas.push_back(base_of(all.lemmas[i]));
  }
  return tokens;
}

std::vector<std::string> intent_features(const Tokens& tokens) {
  std::vector<std::string> features;
  std::string question = "-";
  for (const std::string& lemma : tokens.lemmas)
    if (question == "-" && class_of(lemma) == WordClass::question) question = lemma;
  std::string before = "^";
  for (size_t i = 0; i < tokens.lemmas.size(); ++i) {
    const std::string& lemma = tokens.lemmas[i];
    features.push_back(lemma);
    features.push_back(fmt::format("{} {}", before, lemma));
    features.push_back(fmt::format("{} ~ {}", question, lemma));
    if (tokens.words[i] != lemma) features.push_back("'" + tokens.words[i]);
    for (std::string& meaning : meanings_of(lemma)) features.push_back(std::move(meaning));
    before = lemma;
  }
  features.push_back(before + " $");
  std::ranges::sort(features);
  features.erase(std::unique(features.begin(), features.end()), features.end());
  return features;
}

std::string placeholder_signature(const Tokens& tokens) {
  Words kinds;
  for (const std::string& lemma : tokens.lemmas)
    if (is_placeholder(lemma)) kinds.push_back(lemma);
  std::ranges::sort(kinds);
  return joined(kinds, " ");
}

namespace {

/// Each once, sorted. What occurs once teaches little beside the words themselves, which are kept: 42 % less
/// of a model cost 0.4 % of the sentences of another author.
void keep_frequent(std::vector<std::string>& features) {
  std::ranges::sort(features);
  std::vector<std::string> kept;
  for (auto first = features.begin(); first != features.end();) {
    const auto last =
        std::find_if(first, features.end(), [&](const std::string& one) { return one != *first; });
    if (last - first > 1 || first->find_first_of(" '#") == std::string::npos)
      kept.push_back(std::move(*first));
    first = last;
  }
  features = std::move(kept);
}

/// Whether a form takes what a sentence names, by their signatures.
bool takes(const std::string& of_form, const std::string& of_sentence) {
  return of_form == "*" || of_form == of_sentence;
}

/// The forms that take what each sample names: only they compete, as when sentences are read.
std::vector<std::vector<size_t>> competing_forms(const std::vector<std::string>& forms,
                                                 const std::vector<IntentSample>& samples) {
  const std::vector<std::string> signatures = signatures_of(forms);
  std::vector<std::vector<size_t>> all;
  for (const IntentSample& sample : samples) {
    const std::string signature = placeholder_signature(sample.tokens);
    all.emplace_back();
    for (size_t form = 0; form < forms.size(); ++form)
      if (takes(signatures[form], signature)) all.back().push_back(form);
  }
  return all;
}

/// What a model refers to that was trained in this process.
struct Storage {
  std::vector<std::string> feature_texts, word_texts;
  std::vector<const char*> features, words;
  std::vector<short> weights;
};

IntentModel stored(const std::vector<std::string>& forms, std::vector<std::string> features,
                   std::vector<std::string> words, const std::vector<float>& weights) {
  const auto storage = std::make_shared<Storage>();
  storage->feature_texts = std::move(features);
  storage->word_texts = std::move(words);
  for (const std::string& text : storage->feature_texts) storage->features.push_back(text.c_str());
  for (const std::string& text : storage->word_texts) storage->words.push_back(text.c_str());
  for (const float weight : weights)
    storage->weights.push_back(static_cast<short>(std::lround(weight / kIntentWeightStep)));
  return {forms, signatures_of(forms), storage->features, storage->weights, storage->words, storage};
}

/// By form: the lemmas of its paraphrases and what they mean, with blanks around each.
std::vector<std::string> words_by_form(size_t forms, const std::vector<IntentSample>& samples) {
  std::vector<std::set<std::string>> words(forms);
  for (const IntentSample& sample : samples)
    for (const std::string& lemma : sample.tokens.lemmas) {
      words[sample.form].insert(lemma);
      for (std::string& meaning : meanings_of(lemma)) words[sample.form].insert(std::move(meaning));
    }
  std::vector<std::string> texts;
  for (const std::set<std::string>& of_form : words)
    texts.push_back(fmt::format(" {} ", joined(Words(of_form.begin(), of_form.end()), " ")));
  return texts;
}

}  // namespace

IntentModel train_intents(const std::vector<std::string>& forms, const std::vector<IntentSample>& samples) {
  constexpr int kSteps = 120;
  constexpr double kPrior = 0.3;  // precision of the weights
  constexpr double kRate = 0.35;
  std::vector<std::string> features;
  for (const IntentSample& sample : samples)
    for (std::string& feature : intent_features(sample.tokens)) features.push_back(std::move(feature));
  keep_frequent(features);
  std::vector<float> weights(features.size() * forms.size(), 0);
  std::vector<std::vector<size_t>> rows;
  for (const IntentSample& sample : samples) rows.push_back(rows_of(features, sample.tokens));
  const std::vector<std::vector<size_t>> competing = competing_forms(forms, samples);
  // Gradient ascent with a step per weight that shrinks as its gradients add up (AdaGrad).
  std::vector<float> gradient(weights.size()), squares(weights.size(), 1e-6F);
  for (int step = 0; step < kSteps; ++step) {
    for (size_t i = 0; i < gradient.size(); ++i) gradient[i] = static_cast<float>(-kPrior) * weights[i];
    for (size_t i = 0; i < samples.size(); ++i) {
      std::vector<double> probabilities(competing[i].size(), 0);
      for (const size_t row : rows[i])
        for (size_t k = 0; k < competing[i].size(); ++k)
          probabilities[k] += static_cast<double>(weights[row * forms.size() + competing[i][k]]);
      normalize(probabilities);
      for (size_t k = 0; k < competing[i].size(); ++k) {
        const size_t form = competing[i][k];
        const auto missing = static_cast<float>((form == samples[i].form ? 1.0 : 0.0) - probabilities[k]);
        for (const size_t row : rows[i]) gradient[row * forms.size() + form] += missing;
      }
    }
    for (size_t i = 0; i < gradient.size(); ++i) {
      squares[i] += gradient[i] * gradient[i];
      weights[i] += static_cast<float>(kRate) * gradient[i] / std::sqrt(squares[i]);
    }
  }
  return stored(forms, std::move(features), words_by_form(forms.size(), samples), weights);
}

std::vector<std::string> signatures_of(const std::vector<std::string>& forms) {
  std::vector<std::string> signatures;
  for (const std::string& form : forms)
    signatures.push_back(form == kNoIntent ? "*"
                                           : placeholder_signature(intent_tokens(words_of(form, " ?,"))));
  return signatures;
}

IntentReading best_intent(const IntentModel& model, const Tokens& tokens) {
  std::vector<double> scores = scores_of(model, rows_of(model.features, tokens));
  const std::string signature = placeholder_signature(tokens);
  constexpr double kNever = -1e9;
  for (size_t form = 0; form < scores.size(); ++form)
    if (!takes(model.signatures[form], signature)) scores[form] = kNever;
  normalize(scores);
  const auto best = std::ranges::max_element(scores);
  return {static_cast<size_t>(best - scores.begin()), *best};
}

namespace {

/// "lately", "sadly": adverbs and nothing else, and none that denies.
bool is_adverb(const std::string& word) {
  using wordnet::PartOfSpeech;
  static const std::set<std::string> denying = {"hardly", "scarcely", "seldom", "rarely", "mostly",
                                                "partly", "almost",   "nearly", "twice",  "never"};
  return !denying.contains(word) && !lexicon().contains(word) && class_of(word) == WordClass::name &&
         !wordnet::senses(word, PartOfSpeech::adverb).empty() &&
         wordnet::senses(word, PartOfSpeech::noun).empty() &&
         wordnet::senses(word, PartOfSpeech::verb).empty() &&
         wordnet::senses(word, PartOfSpeech::adjective).empty();
}

}  // namespace

Words uncovered_words(const IntentModel& model, size_t form, const Tokens& tokens) {
  Words uncovered;
  for (const std::string& lemma : tokens.lemmas) {
    const WordClass word_class = class_of(lemma);
    const bool neutral = word_class == WordClass::person ||
                         (word_class == WordClass::auxiliary && lemma != "will" && lemma != "should") ||
                         is_adverb(lemma);
    const auto has = [&](const std::string& word) {
      return as_view(model.words[form]).find(" " + word + " ") != std::string_view::npos;
    };
    if (!neutral && !has(lemma) && std::ranges::none_of(meanings_of(lemma), has)) uncovered.push_back(lemma);
  }
  return uncovered;
}

Paraphrases read_paraphrases(const std::string& text, const std::string& file) {
  Paraphrases read;
  std::string signature;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.empty() || line[0] == '#') continue;
    const bool is_form = line.starts_with("= ");
    if (is_form) read.forms.push_back(line.substr(2));
    Words words = words_of(is_form ? line.substr(2) : line, " ?,");
    for (std::string& word : words)
      if (!is_name_of_placeholder(word)) word = lower_case(word);
    const Tokens tokens = intent_tokens(words);
    if (is_form) signature = placeholder_signature(tokens);
    if (read.forms.empty())
      throw Error("a paraphrase without a form", {file, number, {}}, "begin with '= FORM'");
    if (read.forms.back() == "none" && is_form) continue;
    if (read.forms.back() != "none" && placeholder_signature(tokens) != signature)
      throw Error(fmt::format("'{}' does not name what '{}' names", line, read.forms.back()),
                  {file, number, {}}, "use the same placeholders");
    read.samples.push_back({read.forms.size() - 1, tokens});
  }
  return read;
}

}  // namespace loci::memory
