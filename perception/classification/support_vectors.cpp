#include <cmath>
#include <numeric>
#include <opencv2/ml.hpp>

#include "mapping/base/json.h"
#include "perception/classification/classifier_kinds.h"

namespace loci::perception::classifier_kinds {
namespace {

/// One class against the rest: positive on the side of the class.
struct Machine {
  std::vector<size_t> support;  ///< numbers of vectors
  std::vector<double> weights;
  double offset = 0;
};

class SupportVectors : public Classifier {
 public:
  SupportVectors(std::vector<FeatureVector> vectors, std::vector<Machine> machines, double scale,
                 FeatureDistance distance)
      : vectors_(std::move(vectors)), machines_(std::move(machines)), scale_(scale), distance_(distance) {}

  Json kind_to_json() const override {
    Json json = {{"method", "svm"},
                 {"distance", name_of(distance_)},
                 {"scale", scale_},
                 {"vectors", vectors_to_json(vectors_)},
                 {"machines", Json::array()}};
    for (const Machine& machine : machines_)
      json["machines"].push_back(
          {{"support", machine.support}, {"weights", machine.weights}, {"offset", machine.offset}});
    return json;
  }

 protected:
  std::vector<double> scores_of_scaled(const FeatureVector& vector) const override {
    std::vector<double> kernel;
    for (const FeatureVector& each : vectors_)
      kernel.push_back(std::exp(-static_cast<double>(distance_between(vector, each, distance_)) / scale_));
    std::vector<double> scores;
    for (const Machine& machine : machines_) {
      double side = machine.offset;
      for (size_t i = 0; i < machine.support.size(); ++i)
        side += machine.weights[i] * kernel[machine.support[i]];
      constexpr double kSteepness = 3;  // At the margin, 1 from the boundary, 95 %.
      scores.push_back(1 / (1 + std::exp(-kSteepness * side)));
    }
    const double sum = std::accumulate(scores.begin(), scores.end(), 0.0);
    for (double& score : scores) score /= sum;
    return scores;
  }

 private:
  std::vector<FeatureVector> vectors_;
  std::vector<Machine> machines_;
  double scale_;
  FeatureDistance distance_;
};

double mean_distance(const std::vector<FeatureVector>& vectors, FeatureDistance distance) {
  double sum = 0;
  size_t count = 0;
  const size_t step = std::max<size_t>(1, vectors.size() / 200);
  for (size_t i = 0; i < vectors.size(); i += step)
    for (size_t j = i + 1; j < vectors.size(); j += step, ++count)
      sum += static_cast<double>(distance_between(vectors[i], vectors[j], distance));
  return count > 0 && sum > 0 ? sum / static_cast<double>(count) : 1;
}

/// The kernels of all pairs, computed once for all classes. OpenCV sees vectors of one number, which says
/// which vector is meant.
class KnownKernel : public cv::ml::SVM::Kernel {
 public:
  KnownKernel(const std::vector<FeatureVector>& vectors, FeatureDistance distance, double scale)
      : values_(static_cast<int>(vectors.size()), static_cast<int>(vectors.size()), CV_32F) {
    for (int i = 0; i < values_.rows; ++i)
      for (int j = 0; j <= i; ++j) {
        const auto a = static_cast<size_t>(i), b = static_cast<size_t>(j);
        values_.at<float>(i, j) = values_.at<float>(j, i) = static_cast<float>(
            std::exp(-static_cast<double>(distance_between(vectors[a], vectors[b], distance)) / scale));
      }
  }
  int getType() const override { return cv::ml::SVM::CUSTOM; }
  void calc(int count, int /*length*/, const float* numbers, const float* other, float* results) override {
    for (int i = 0; i < count; ++i)
      results[i] = values_.at<float>(static_cast<int>(numbers[i]), static_cast<int>(*other));
  }

 private:
  cv::Mat values_;
};

Machine train_against_rest(const LabelledVectors& data, size_t wanted, double c,
                           const cv::Ptr<KnownKernel>& kernel) {
  const int count = static_cast<int>(data.vectors.size());
  cv::Mat numbers(count, 1, CV_32F), labels(count, 1, CV_32S);
  for (int i = 0; i < count; ++i) {
    numbers.at<float>(i) = static_cast<float>(i);
    labels.at<int>(i) = data.labels[static_cast<size_t>(i)] == wanted ? 0 : 1;
  }
  const auto machine = cv::ml::SVM::create();
  machine->setType(cv::ml::SVM::C_SVC);
  machine->setC(c);
  machine->setCustomKernel(kernel);
  machine->setTermCriteria({cv::TermCriteria::MAX_ITER + cv::TermCriteria::EPS, 20000, 1e-4});
  machine->train(numbers, cv::ml::ROW_SAMPLE, labels);
  Machine trained;
  cv::Mat weights, support;
  trained.offset = -machine->getDecisionFunction(0, weights, support);
  const cv::Mat all = machine->getSupportVectors();
  weights.convertTo(weights, CV_64F);
  for (int i = 0; i < static_cast<int>(support.total()); ++i) {
    trained.support.push_back(static_cast<size_t>(all.at<float>(support.at<int>(i), 0)));
    trained.weights.push_back(weights.at<double>(i));
  }
  return trained;
}

}  // namespace

std::unique_ptr<Classifier> train_machine(const LabelledVectors& data, const ClassifierOptions& options) {
  if (data.classes < 2) throw Error("a support vector machine needs two classes");
  const FeatureDistance distance = feature_distance(options.distance);
  const double scale = mean_distance(data.vectors, distance);
  const auto kernel = cv::makePtr<KnownKernel>(data.vectors, distance, scale);
  std::vector<Machine> machines;
  for (size_t wanted = 0; wanted < data.classes; ++wanted)
    machines.push_back(train_against_rest(data, wanted, options.c, kernel));
  // Vectors that support nothing go.
  constexpr size_t kUnused = SIZE_MAX;
  std::vector<size_t> number(data.vectors.size(), kUnused);
  std::vector<FeatureVector> used;
  for (Machine& machine : machines)
    for (size_t& each : machine.support) {
      if (number[each] == kUnused) {
        number[each] = used.size();
        used.push_back(data.vectors[each]);
      }
      each = number[each];
    }
  return std::make_unique<SupportVectors>(std::move(used), std::move(machines), scale, distance);
}

std::unique_ptr<Classifier> machine_from_json(const Json& json) {
  std::vector<FeatureVector> vectors = vectors_from_json(json.at("vectors"));
  std::vector<Machine> machines;
  for (const Json& each : json.at("machines")) {
    machines.push_back({each.at("support"), each.at("weights"), each.at("offset")});
    if (machines.back().support.size() != machines.back().weights.size())
      throw Error("a support vector machine has not as many weights as vectors");
    for (const size_t number : machines.back().support)
      if (number >= vectors.size()) throw Error("a support vector machine lacks a vector");
  }
  return std::make_unique<SupportVectors>(std::move(vectors), std::move(machines), json.at("scale"),
                                          feature_distance(json.at("distance")));
}

}  // namespace loci::perception::classifier_kinds
