#include <gtest/gtest.h>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

std::string annotators_document() {
  return read_file(LOCI_SOURCE_DIR "/docs/annotators.md");
}

/// The part of docs/annotators.md that follows from the declarations.
std::string described() {
  const Json list = parse_json(run("loci-perceive list --json").out, "list");
  std::string text = "## Every annotator\n";
  for (const char* kind : {"readers", "multipliers", "annotators"})
    for (const Json& each : list[kind])
      text += "\n```\n" + run("loci-perceive describe " + each["name"].get<std::string>()).out + "```\n";
  return text;
}

TEST(AnnotatorsDocument, SaysWhatTheProgramDescribes) {
  const std::string document = annotators_document();
  const size_t begin = document.find("## Every annotator\n");
  ASSERT_NE(begin, std::string::npos);
  EXPECT_EQ(document.substr(begin), described()) << "put what is described there into docs/annotators.md";
}

TEST(AnnotatorsDocument, HoldsTheDefaultPipeline) {
  const std::string document = annotators_document();
  const std::string pipeline = run("loci-perceive describe pipeline").out;
  EXPECT_NE(document.find("```yaml\n" + pipeline + "```"), std::string::npos) << pipeline;
}

}  // namespace
}  // namespace loci::apps::test
