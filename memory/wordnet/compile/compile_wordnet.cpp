// Writes WordNet as C++ tables: `loci_compile_wordnet FOLDER OUTPUT.cpp`. Formats: wndb(5WN).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <map>
#include <sstream>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/files.h"

namespace loci {
namespace {

constexpr std::array kParts = {"noun", "verb", "adj", "adv"};

struct Synset {
  size_t file = 0;
  std::vector<std::string> above = {};  ///< keys of the hypernyms
};
/// By key: the part of speech and the offset in its file.
std::map<std::string, Synset> read_synsets(const std::filesystem::path& folder) {
  std::map<std::string, Synset> synsets;
  for (size_t part = 0; part < kParts.size(); ++part) {
    std::istringstream lines(read_file(folder / (std::string("data.") + kParts[part])));
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with(' ')) continue;
      std::istringstream words(line);
      std::string offset, type, word, number, symbol, target, target_part, source;
      Synset synset;
      size_t count = 0, pointers = 0;
      words >> offset >> synset.file >> type >> std::hex >> count >> std::dec;
      for (size_t i = 0; i < count; ++i) words >> word >> number;
      words >> pointers;
      for (size_t i = 0; i < pointers; ++i) {
        words >> symbol >> target >> target_part >> source;
        if (symbol == "@") synset.above.push_back(std::to_string(part) + target);
      }
      if (!words)
        throw Error("a synset that is not complete", {"data." + std::string(kParts[part]), 0, {}}, "");
      synsets[std::to_string(part) + offset] = std::move(synset);
    }
  }
  return synsets;
}

bool is_single(const std::string& word) {
  return word.find_first_not_of("abcdefghijklmnopqrstuvwxyz'-") == std::string::npos;
}

/// Whether two words joined by "_" name an artefact or a food: "watering_can".
bool is_pair_for_thing(const std::string& word, const std::string& key,
                       const std::map<std::string, Synset>& synsets) {
  constexpr size_t kArtifact = 6, kFood = 13;  // lexicographer files
  const size_t joint = word.find('_');
  if (joint == std::string::npos || !is_single(word.substr(0, joint)) || !is_single(word.substr(joint + 1)))
    return false;
  const auto synset = synsets.find(key);
  return synset != synsets.end() && (synset->second.file == kArtifact || synset->second.file == kFood);
}

/// By word the keys of its synsets: nouns, verbs, adjectives, adverbs, each the most frequent first.
std::map<std::string, std::vector<std::string>> read_words(const std::filesystem::path& folder,
                                                           const std::map<std::string, Synset>& synsets) {
  constexpr size_t kMaxSenses = 10;  // of a part of speech
  std::map<std::string, std::vector<std::string>> all;
  for (size_t part = 0; part < kParts.size(); ++part) {
    std::istringstream lines(read_file(folder / (std::string("index.") + kParts[part])));
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with(' ')) continue;
      std::istringstream fields(line);
      std::string word, skipped;
      size_t senses = 0, pointers = 0;
      fields >> word >> skipped >> senses >> pointers;
      if (!is_single(word) && part != 0) continue;
      for (size_t i = 0; i < pointers + 2; ++i) fields >> skipped;
      for (size_t i = 0; i < std::min(senses, kMaxSenses); ++i) {
        fields >> skipped;
        std::string key = std::to_string(part) + skipped;
        if (is_single(word) || is_pair_for_thing(word, key, synsets)) all[word].push_back(std::move(key));
      }
    }
  }
  return all;
}

std::vector<std::string> read_exceptions(const std::filesystem::path& folder) {
  std::vector<std::string> all;
  for (size_t part = 0; part < kParts.size(); ++part) {
    std::istringstream lines(read_file(folder / (std::string(kParts[part]) + ".exc")));
    for (std::string line; std::getline(lines, line);) {
      std::istringstream fields(line);
      std::string form, base;
      for (fields >> form; fields >> base;)
        if (is_single(form) && is_single(base))
          all.push_back(fmt::format("{} {} {}", "nvar"[part], form, base));
    }
  }
  std::ranges::sort(all);
  return all;
}

/// Adjacent literals of a line each.
std::string literal_of(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += fmt::format("  \"{}\\n\"\n", line);
  return text;
}

std::string source_of(const std::filesystem::path& folder) {
  const std::map<std::string, Synset> synsets = read_synsets(folder);
  std::map<std::string, size_t> numbers;
  for (const auto& [key, synset] : synsets) numbers.emplace(key, numbers.size());
  std::vector<std::string> words;
  std::vector<size_t> word_begins = {0}, sense_begins = {0}, senses, files, above_begins = {0}, above;
  for (const auto& [word, keys] : read_words(folder, synsets)) {
    words.push_back(word);
    word_begins.push_back(word_begins.back() + word.size() + 1);
    for (const std::string& key : keys) senses.push_back(numbers.at(key));
    sense_begins.push_back(senses.size());
  }
  for (const auto& [key, synset] : synsets) {
    files.push_back(synset.file);
    for (const std::string& one : synset.above) above.push_back(numbers.at(one));
    above_begins.push_back(above.size());
  }
  const auto table = [](const char* type, const char* name, const std::vector<size_t>& values) {
    return fmt::format("constexpr {} {}[] = {{{}}};\n", type, name, fmt::join(values, ","));
  };
  constexpr const char* kNumber = "std::uint32_t";
  return "// Written by loci_compile_wordnet.\n#include \"memory/wordnet/tables.h\"\n\n"
         "namespace loci::memory::wordnet {\nnamespace {\n"
         "constexpr char kWords[] =\n" +
         literal_of(words) + ";\n" + "constexpr char kExceptions[] =\n" +
         literal_of(read_exceptions(folder)) + ";\n" + table(kNumber, "kWordBegins", word_begins) +
         table(kNumber, "kSenseBegins", sense_begins) + table(kNumber, "kSenses", senses) +
         table("std::uint8_t", "kFiles", files) + table(kNumber, "kHypernymBegins", above_begins) +
         table(kNumber, "kHypernyms", above) +
         "constexpr Tables kTables = {{kWords, sizeof(kWords) - 1}, kWordBegins, kSenseBegins, kSenses, "
         "kFiles,\n"
         "    kHypernymBegins, kHypernyms, {kExceptions, sizeof(kExceptions) - 1}};\n"
         "}  // namespace\n\nconst Tables& tables() {\n  return kTables;\n}\n\n"
         "}  // namespace loci::memory::wordnet\n";
}

}  // namespace
}  // namespace loci

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: loci_compile_wordnet FOLDER OUTPUT.cpp\n";
    return 2;
  }
  try {
    loci::write_file_atomically(argv[2], loci::source_of(argv[1]));
  } catch (const loci::Error& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
