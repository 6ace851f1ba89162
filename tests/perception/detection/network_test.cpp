#include <gtest/gtest.h>

#include <array>
#include <opencv2/imgproc.hpp>

#include "mapping/base/error.h"
#include "perception/detection/image_encoder.h"
#include "perception/detection/network_detector.h"
#include "perception/detection/onnx_model.h"
#include "tests/perception/detection/onnx_file.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;

/// A folder of this test's own.
fs::path fresh_folder() {
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  const fs::path folder =
      fs::path(testing::TempDir()) / (std::string(info->test_suite_name()) + "_" + info->name());
  fs::remove_all(folder);
  make_folder(folder);
  return folder;
}

/// The one line of what a function throws.
template <class Function>
std::string error_of(const Function& function) {
  try {
    function();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
  return "no error";
}

Network::Output output(const std::string& name, const std::vector<int>& shape,
                       const std::vector<float>& values) {
  return {name, cv::Mat(shape, CV_32F, const_cast<float*>(values.data())).clone()};
}

/// Of an image of 200 x 100 in an input of 100 x 100: 25 rows of border above and below.
struct Decoding {
  DetectorDescription description;
  cv::Size image{200, 100};
  InputFit fit{{0.5, 0.5}, {0, 25}};

  explicit Decoding(DetectorLayout layout) {
    description.layout = layout;
    description.classes = {"cup", "box"};
    description.input.size = {100, 100};
  }
  std::vector<Detection2D> operator()(const std::vector<Network::Output>& outputs) const {
    return decode_detections(outputs, description, fit, image);
  }
};

TEST(NetworkOutputs, YoloV5BoxesLieInTheImageWithoutTheBorder) {
  const Decoding decode(DetectorLayout::yolov5);
  const auto found = decode({output("output0", {1, 3, 7}, {50, 50, 20, 10, 0.9F, 0.1F, 0.8F,      //
                                                           50, 50, 20, 10, 0.1F, 0.9F, 0.9F,      // no object
                                                           10, 30, 8,  6,  1.0F, 0.5F, 0.0F})});  //
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].classes[0].first, "box");
  EXPECT_NEAR(*found[0].score, 0.72, 1e-6);
  EXPECT_EQ(found[0].region.box, cv::Rect2d(80, 40, 40, 20));
  EXPECT_EQ(found[1].region.box, cv::Rect2d(12, 4, 16, 12));
}

TEST(NetworkOutputs, OverlapSuppressesOnlyInAClass) {
  const Decoding decode(DetectorLayout::yolov8);
  // Rows are x, y, width, height, cup, box; three candidates.
  const auto found = decode({output("output0", {1, 6, 3},
                                    {50, 51, 50, 50, 50, 50, 20, 20, 20, 10, 10, 10,  //
                                     0.9F, 0.8F, 0, 0, 0, 0.7F})});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].classes[0].first, "cup");
  EXPECT_EQ(found[1].classes[0].first, "box");
}

TEST(NetworkOutputs, SsdHasBackgroundFirstAndCornersInFractions) {
  Decoding decode(DetectorLayout::ssd);
  decode.fit = {{0.5, 1}, {0, 0}};
  const auto found = decode({output("scores", {1, 2, 3}, {0.9F, 0.05F, 0.05F, 0.1F, 0.2F, 0.7F}),
                             output("boxes", {1, 2, 4}, {0, 0, 1, 1, 0.1F, 0.2F, 0.3F, 0.4F})});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].classes[0].first, "box");
  EXPECT_NEAR(found[0].region.box.x, 20, 1e-4);
  EXPECT_NEAR(found[0].region.box.br().y, 40, 1e-4);
}

TEST(NetworkOutputs, MasksAreSumsOfPrototypes) {
  const Decoding decode(DetectorLayout::yolov5);
  // One prototype: positive in the left half of the input.
  std::vector<float> prototype(10 * 10);
  for (size_t i = 0; i < prototype.size(); ++i) prototype[i] = i % 10 < 5 ? 1.0F : -1.0F;
  const auto found = decode({output("output0", {1, 1, 8}, {50, 50, 40, 20, 1, 0.9F, 0, 1}),
                             output("output1", {1, 1, 10, 10}, prototype)});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].region.contains(80, 50));
  EXPECT_FALSE(found[0].region.contains(120, 50));
  EXPECT_FALSE(found[0].region.contains(50, 50));  // outside of the box
}

TEST(NetworkOutputs, ShapesThatDoNotFitTheClassesAreRefused) {
  const Decoding decode(DetectorLayout::yolov5);
  const std::string error = error_of([&] { decode({output("out", {1, 1, 85}, std::vector<float>(85))}); });
  EXPECT_NE(error.find("'out' (1, 1, 85), not (1, candidates, 5 + classes) for 2 classes"), std::string::npos)
      << error;
  EXPECT_NE(error_of([&] { decode({output("out", {1, 7}, std::vector<float>(7))}); }), "no error");
  EXPECT_NE(error_of([&] { decode({}); }), "no error");
  EXPECT_NE(error_of([&] {
              Decoding(DetectorLayout::ssd)({output("scores", {1, 1, 3}, {0, 0, 1})});
            }),
            "no error");
}

TEST(NetworkOutputs, ValuesThatAreNotFiniteAreNoObjects) {
  const Decoding decode(DetectorLayout::yolov5);
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const auto found =
      decode({output("output0", {1, 4, 7}, {nan, 50, 20, 10, 1,   1, 0, 50, 50, inf, nan, 1, 1,   0,  //
                                            50,  50, 20, 10, nan, 1, 0, 50, 50, 20,  10,  1, inf, 0})});
  EXPECT_TRUE(found.empty());
}

TEST(OnnxModel, WhatContradictsItselfIsRefused) {
  const fs::path file = fresh_folder() / "model.onnx";
  const auto error_with = [&](const auto& change) {
    onnx::Model model = test::mean_network();
    change(model);
    test::write_model(file, model);
    return error_of([&] { read_onnx_model(file); });
  };
  EXPECT_EQ(error_with([](onnx::Model&) {}), "no error");
  EXPECT_NE(error_with([](onnx::Model& model) { model.clear_graph(); }).find("no ONNX model"),
            std::string::npos);
  EXPECT_NE(error_with([](onnx::Model& model) {
              model.mutable_graph()->mutable_node(1)->set_input(0, "nothing");
            }).find("reads 'nothing', which no node before it makes"),
            std::string::npos);
  EXPECT_NE(error_with([](onnx::Model& model) {
              test::set_value(*model.mutable_graph()->add_input(), "second", {1});
            }).find("2 inputs instead of one"),
            std::string::npos);
  const auto error_with_tensor = [&](const auto& change) {
    return error_with([&](onnx::Model& model) {
      onnx::Tensor& tensor = *model.mutable_graph()->add_initializer();
      tensor.set_name("weights");
      tensor.set_data_type(1);
      change(tensor);
    });
  };
  EXPECT_NE(error_with_tensor([](onnx::Tensor& tensor) {
              tensor.add_dims(int64_t{1} << 40);
            }).find("impossible dimensions"),
            std::string::npos);
  EXPECT_NE(error_with_tensor([](onnx::Tensor& tensor) {
              tensor.add_dims(3);
              tensor.set_raw_data("12345678");
            }).find("as many values as its dimensions say"),
            std::string::npos);
  EXPECT_NE(
      error_with_tensor([](onnx::Tensor& tensor) { tensor.set_data_location(1); }).find("in another file"),
      std::string::npos);
}

TEST(Network, RunsWhatItRead) {
  const fs::path file = fresh_folder() / "model.onnx";
  test::write_model(file, test::mean_network());
  const Network network(file, {}, 100);
  const auto outputs = network.run(cv::Mat(16, 16, CV_8UC3, cv::Scalar(255, 51, 0)));
  ASSERT_EQ(outputs.size(), 1U);
  ASSERT_EQ(outputs[0].values.total(), 3U);
  EXPECT_NEAR(outputs[0].values.at<float>(0, 0), 0, 1e-5);  // red comes first
  EXPECT_NEAR(outputs[0].values.at<float>(0, 1), 0.2, 1e-5);
  EXPECT_NEAR(outputs[0].values.at<float>(0, 2), 1, 1e-5);
}

TEST(Network, NormalisesWithMeanAndDeviation) {
  const fs::path file = fresh_folder() / "model.onnx";
  test::write_model(file, test::mean_network());
  const NetworkInput input = NetworkInput::read(
      Config::parse("{channels: bgr, mean: [0.5, 0, 0], deviation: [0.5, 2, 1]}", "network.yaml"));
  const auto outputs = Network(file, input, 100).run(cv::Mat(8, 8, CV_8UC3, cv::Scalar(255, 255, 0)));
  EXPECT_NEAR(outputs[0].values.at<float>(0, 0), 1, 1e-5);
  EXPECT_NEAR(outputs[0].values.at<float>(0, 1), 0.5, 1e-5);
}

TEST(Network, AnOperatorThatOpenCvLacksIsNamed) {
  const fs::path file = fresh_folder() / "model.onnx";
  test::write_model(file,
                    test::small_network({1, 3, 8, 8}, {{"NonZero", "image", "found"}}, "found", {4, 1}));
  const std::string error = error_of([&] { Network(file, {}, 100); });
  EXPECT_NE(error.find("operator NonZero ('node_found')"), std::string::npos) << error;
  EXPECT_NE(error.find("opset 12"), std::string::npos) << error;
}

TEST(Network, SizesAreChecked) {
  const fs::path file = fresh_folder() / "model.onnx";
  test::write_model(file, test::mean_network());
  NetworkInput input;
  input.size = {32, 32};
  EXPECT_NE(error_of([&] {
              Network(file, input, 100);
            }).find("takes images of 8 x 8, the description says 32 x 32"),
            std::string::npos);
  test::write_model(file, test::mean_network({1, 3, 4000, 4000}));
  EXPECT_NE(error_of([&] { Network(file, {}, 100); }).find("MB of memory, 100 are allowed"),
            std::string::npos);
  test::write_model(file, test::mean_network({1, 3, 0, 0}));
  EXPECT_NE(error_of([&] { Network(file, {}, 100); }).find("images of any size"), std::string::npos);
  test::write_model(file, test::mean_network({1, 3, 100000, 8}));
  EXPECT_NE(error_of([&] { Network(file, {}, 100); }).find("at most 4096"), std::string::npos);
}

TEST(NetworkDescription, IsReadStrictly) {
  const fs::path folder = fresh_folder();
  write_file_atomically(folder / "names.txt", "cup\nbox\n");
  const auto error_of_text = [&](const std::string& text) {
    write_file_atomically(folder / "network.yaml", text);
    return error_of([&] { DetectorDescription::read(folder / "network.yaml"); });
  };
  const std::string head = "model: a.onnx\nclasses: names.txt\n";
  EXPECT_EQ(error_of_text(head + "layout: yolov8\n"), "no error");
  EXPECT_NE(error_of_text(head + "layout: yolov3\n").find("yolov5, yolov8, ssd"), std::string::npos);
  EXPECT_NE(error_of_text(head + "layout: ssd\nmin_scor: 0.5\n").find("did you mean 'min_score'"),
            std::string::npos);
  EXPECT_NE(error_of_text(head + "layout: ssd\ninput: {widht: 3}\n").find("did you mean 'width'"),
            std::string::npos);
  EXPECT_NE(error_of_text(head + "layout: ssd\ninput: {mean: [1, 2]}\n").find("three numbers"),
            std::string::npos);
  write_file_atomically(folder / "names.txt", "");
  EXPECT_NE(error_of_text(head + "layout: ssd\n").find("names.txt"), std::string::npos);
}

/// An encoder of mean colours with its description.
fs::path mean_encoder(const fs::path& folder, const test::Shape& input) {
  test::write_model(folder / "encoder.onnx", test::mean_network(input));
  write_file_atomically(folder / "encoder.yaml",
                        "model: encoder.onnx\nname: mean\ninput: {width: 8, height: 8}\n");
  return folder / "encoder.yaml";
}

TEST(ImageEncoder, GivesUnitVectorsAloneAndInBatches) {
  const cv::Mat red(10, 20, CV_8UC3, cv::Scalar(0, 0, 200)), yellow(9, 9, CV_8UC3, cv::Scalar(0, 90, 120)),
      black(9, 9, CV_8UC3, cv::Scalar(0, 0, 0));
  for (const int64_t batch : {1, 0}) {
    const ImageEncoder encoder(mean_encoder(fresh_folder(), {batch, 3, 8, 8}));
    EXPECT_EQ(encoder.name(), "mean");
    const auto vectors = encoder.encode({yellow, black, yellow});
    ASSERT_EQ(vectors.size(), 3U);
    ASSERT_EQ(vectors[0].size(), 3U);
    EXPECT_NEAR(vectors[0][0], 0.8, 1e-4);
    EXPECT_NEAR(vectors[0][1], 0.6, 1e-4);
    EXPECT_TRUE(vectors[1].empty());
    EXPECT_EQ(vectors[2], vectors[0]);
    EXPECT_GT(encoder.encode({red})[0][0], 0.8F);
  }
}

TEST(ImageEncoder, WhatDoesNotFitIsRefused) {
  const fs::path folder = fresh_folder();
  const fs::path description = mean_encoder(folder, {1, 3, 8, 8});
  write_file_atomically(description, "model: encoder.onnx\nname: mean\noutput: features\n");
  EXPECT_NE(error_of([&] { ImageEncoder encoder(description); }).find("no output 'features'"),
            std::string::npos);
  write_file_atomically(description, "model: encoder.onnx\nnam: mean\n");
  EXPECT_NE(error_of([&] { ImageEncoder encoder(description); }).find("did you mean 'name'"),
            std::string::npos);
}

/// Damaged copies of a real model: an error in one line or a model that runs, never a crash.
TEST(Network, DamagedModelsAreRefused) {
  const fs::path folder = fresh_folder(), data = fs::path(LOCI_SOURCE_DIR) / "tests/data/detector";
  const std::string whole = read_file(data / "household.onnx");
  fs::copy_file(data / "classes.txt", folder / "classes.txt");
  fs::copy_file(data / "household.yaml", folder / "household.yaml");
  int refused = 0;
  const auto try_model = [&](const std::string& bytes) {
    write_file_atomically(folder / "household.onnx", bytes);
    refused += error_of([&] { ObjectDetector detector(folder / "household.yaml"); }) != "no error";
  };
  for (const size_t length : {size_t{0}, size_t{10}, whole.size() / 2, whole.size() - 1})
    try_model(whole.substr(0, length));
  EXPECT_EQ(refused, 4);
  write_file_atomically(folder / "classes.txt", "cup\nbox\n");
  try_model(whole);
  EXPECT_EQ(refused, 5);
}

TEST(ObjectDetector, FindsNothingOnABlankImage) {
  const ObjectDetector detector(fs::path(LOCI_SOURCE_DIR) / "tests/data/detector/household.yaml");
  EXPECT_EQ(detector.description().classes.size(), 13U);
  EXPECT_TRUE(detector.detect(cv::Mat(480, 640, CV_8UC3, cv::Scalar(120, 130, 140))).empty());
}

}  // namespace
}  // namespace loci::perception
