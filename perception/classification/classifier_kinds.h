#pragma once

#include "perception/classification/classifier.h"

namespace loci::perception::classifier_kinds {

// Vectors are scaled.
std::unique_ptr<Classifier> train_neighbours(const LabelledVectors& data, const ClassifierOptions& options);
std::unique_ptr<Classifier> train_machine(const LabelledVectors& data, const ClassifierOptions& options);
std::unique_ptr<Classifier> train_forest(const LabelledVectors& data, const ClassifierOptions& options,
                                         const Random& random);
std::unique_ptr<Classifier> train_network(const LabelledVectors& data, const Random& random);
std::unique_ptr<Classifier> neighbours_from_json(const Json& json);
std::unique_ptr<Classifier> machine_from_json(const Json& json);
std::unique_ptr<Classifier> forest_from_json(const Json& json);
std::unique_ptr<Classifier> network_from_json(const Json& json);

/// Vectors as Base64 of their floats, one after the other.
Json vectors_to_json(const std::vector<FeatureVector>& vectors);
std::vector<FeatureVector> vectors_from_json(const Json& json);

}  // namespace loci::perception::classifier_kinds
