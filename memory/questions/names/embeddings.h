#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "memory/questions/snapshot.h"

namespace loci::memory {

/// A vector that a network made of an object's image (the annotator NetworkEmbedding).
struct Embedding {
  std::string name = {};           ///< of the network; those of one name are comparable
  std::vector<float> values = {};  ///< of unit length
  Id scene = 0;
};

/// Those of the latest twelve observations of an object.
std::vector<Embedding> embeddings_of(const Snapshot& snapshot, Id object);

/// Cosine of the angle between two vectors, at least 0; 0 for vectors of different length.
double embedding_similarity(const std::vector<float>& a, const std::vector<float>& b);

/// Vectors of words in the space of an image encoder: a text file with a word or phrase, which may hold
/// spaces, and its values on each line ("red mug 0.12 -0.3 …"), as people export it from the encoder of
/// texts.
class WordVectors {
 public:
  /// Strict: Error with file and line.
  static WordVectors read(const std::filesystem::path& file);

  /// Of a text: its own, or the mean of its words', of unit length. Error when none of them is in the file.
  std::vector<float> of(const std::string& text) const;

 private:
  std::filesystem::path file_;
  std::map<std::string, std::vector<float>> vectors_;  ///< by lower-case text
};

}  // namespace loci::memory
