// Trains the classifier of sentences: `loci_train_intents PARAPHRASES OUTPUT.cpp` writes it as C++; with
// `--cross-validate` in place of OUTPUT.cpp it prints how well it reads paraphrases whose neighbours it has
// not seen.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iostream>
#include <map>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "memory/sentences/intents/intent_model.h"

namespace loci::memory {
namespace {

std::string source_of(const IntentModel& model) {
  const auto strings = [](const auto& texts) {
    std::string text;
    for (const auto& one : texts) text += fmt::format("  \"{}\",\n", one);
    return text;
  };
  return fmt::format(
      "// Written by loci_train_intents.\n#include <iterator>\n\n#include "
      "\"memory/sentences/intents/intent_model.h\"\n\nnamespace "
      "loci::memory {{\n"
      "namespace {{\nconst char* const kForms[] = {{\n{}}};\nconst char* const kSignatures[] = "
      "{{\n{}}};\nconst char* const kFeatures[] = {{\n{}}};\n"
      "constexpr short kWeights[] = {{{}}};\nconst char* const kWords[] = {{\n{}}};\n}}  // namespace\n\n"
      "const IntentModel& trained_intents() {{\n"
      "  static const IntentModel model = {{.forms = {{std::begin(kForms), std::end(kForms)}},\n"
      "                                    .signatures = {{std::begin(kSignatures), "
      "std::end(kSignatures)}},\n"
      "                                    .features = kFeatures,\n"
      "                                    .weights = kWeights,\n"
      "                                    .words = kWords}};\n"
      "  return model;\n}}\n\n}}  // namespace loci::memory\n",
      strings(model.forms), strings(model.signatures), strings(model.features), fmt::join(model.weights, ","),
      strings(model.words));
}

/// Every form's paraphrases in five blocks of neighbours; each is read by what the other four teach.
void cross_validate(const Paraphrases& paraphrases) {
  constexpr size_t kFolds = 5;
  std::map<size_t, size_t> counts, seen;
  for (const IntentSample& sample : paraphrases.samples) ++counts[sample.form];
  std::vector<size_t> folds;
  for (const IntentSample& sample : paraphrases.samples)
    folds.push_back(kFolds * seen[sample.form]++ / counts[sample.form]);
  struct Result {
    double probability;
    bool right, none;
    size_t uncovered;
  };
  std::vector<Result> results;
  for (size_t fold = 0; fold < kFolds; ++fold) {
    std::vector<IntentSample> others;
    for (size_t i = 0; i < folds.size(); ++i)
      if (folds[i] != fold) others.push_back(paraphrases.samples[i]);
    const IntentModel model = train_intents(paraphrases.forms, others);
    for (size_t i = 0; i < folds.size(); ++i) {
      if (folds[i] != fold) continue;
      const IntentSample& sample = paraphrases.samples[i];
      const IntentReading best = best_intent(model, sample.tokens);
      const Words beyond = uncovered_words(model, best.form, sample.tokens);
      results.push_back(
          {best.probability, best.form == sample.form, model.forms[best.form] == kNoIntent, beyond.size()});
    }
  }
  std::cout << fmt::format("{} paraphrases of {} forms\n", folds.size(), paraphrases.forms.size());
  for (size_t uncovered = 0; uncovered < 2; ++uncovered)
    for (const double threshold : {0.0, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9}) {
      size_t answered = 0, right = 0;
      for (const Result& one : results) {
        if (one.none || one.probability < threshold || one.uncovered != uncovered) continue;
        ++answered;
        right += one.right ? 1 : 0;
      }
      std::cout << fmt::format(
          "{} words beyond the form, probability >= {:.1f}: {} answered, {:.1f} % of them right\n", uncovered,
          threshold, answered,
          100.0 * static_cast<double>(right) / static_cast<double>(std::max<size_t>(1, answered)));
    }
}

}  // namespace
}  // namespace loci::memory

int main(int argc, char** argv) {
  using namespace loci;
  if (argc != 3) {
    std::cerr << "usage: loci_train_intents PARAPHRASES OUTPUT.cpp|--cross-validate\n";
    return 2;
  }
  try {
    const memory::Paraphrases paraphrases = memory::read_paraphrases(read_file(argv[1]), argv[1]);
    if (std::string(argv[2]) == "--cross-validate")
      memory::cross_validate(paraphrases);
    else
      write_file_atomically(argv[2],
                            memory::source_of(memory::train_intents(paraphrases.forms, paraphrases.samples)));
  } catch (const Error& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
