#include <gtest/gtest.h>

#include "mapping/base/files.h"
#include "perception/annotators/annotators.h"
#include "perception/pipeline/pipeline.h"

namespace loci::perception {
namespace {

TEST(PipelineDocument, ItsExampleOfAFlowIsAccepted) {
  const std::string document = read_file(LOCI_SOURCE_DIR "/docs/annotators.md");
  const size_t begin = document.find("engines:   ");
  ASSERT_NE(begin, std::string::npos);
  const std::string yaml = document.substr(begin, document.find("```", begin) - begin);
  AnnotatorRegistry registry;
  add_annotators(registry);
  const Json json = Pipeline::parse(yaml, "docs/annotators.md", registry).to_json();
  EXPECT_EQ(json["flow"].size(), 13U);
}

}  // namespace
}  // namespace loci::perception
